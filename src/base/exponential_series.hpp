// Constants of the exponential and the logarithm: those of one number and those of four are computed by the same
// operations.
#pragma once

#include <array>
#include <cstdint>

namespace dartcast::detail {

/// ln 2: 32 bits, and the rest.
inline constexpr std::array ln2_parts = {0x1.62e42feep-1, 0x1.a39ef35793c76p-33};
inline constexpr double per_ln2 = 0x1.71547652b82fep+0;

/// The series of (exp(x) - 1 - x) / x^2. In [-ln 2 / 2, ln 2 / 2] the rest is below 2^-61.
inline constexpr std::array exponential_terms = {
    1.0 / 2.0,         1.0 / 6.0,          1.0 / 24.0,         1.0 / 120.0,     1.0 / 720.0,
    1.0 / 5040.0,      1.0 / 40320.0,      1.0 / 362880.0,     1.0 / 3628800.0, 1.0 / 39916800.0,
    1.0 / 479001600.0, 1.0 / 6227020800.0, 1.0 / 87178291200.0};

/// Below this exp(x) - 1 rounds to -1.
inline constexpr double lowest_exponent = -50.0;

/// The series of (ln((1 + s) / (1 - s)) - 2 s) / s in s^2. With the argument between sqrt(1/2) and sqrt(2), s^2 is below
/// 0.0295, and the rest is below 2^-61.
inline constexpr std::array logarithm_terms = {2.0 / 3.0,  2.0 / 5.0,  2.0 / 7.0,  2.0 / 9.0,  2.0 / 11.0,
                                               2.0 / 13.0, 2.0 / 15.0, 2.0 / 17.0, 2.0 / 19.0, 2.0 / 21.0};

/// The bits of sqrt(1/2). A double's bits less these, shifted, are the power of 2 that leaves [sqrt(1/2), sqrt(2)).
inline constexpr std::uint64_t root_of_half_bits = 0x3fe6a09e667f3bcdU;

}  // namespace dartcast::detail
