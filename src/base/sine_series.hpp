// Constants of the sine and cosine: those of one number and those of four are computed by the same operations.
#pragma once

#include <array>

namespace dartcast::detail {

/// x + to_integer - to_integer is x rounded to an integer, ties to even; the last bits of x + to_integer are those of the
/// integer. For 0 <= x < 2^51.
inline constexpr double to_integer = 0x1.8p+52;

/// Above this turns lose their whole ones first.
inline constexpr double many_turns = 0x1p+40;
/// 2 pi: 26 bits, the rest, and the rest of that. Half of a number's 53 bits times the first is exact.
inline constexpr std::array turn_parts = {0x1.921fb5p+2, 0x1.110b4611a6263p-24, 0x1.8a2e03707344ap-79};
inline constexpr double radians_per_turn = 0x1.921fb54442d18p+2;
inline constexpr double splitter = 0x1p+27 + 1.0;

/// Angles below this are reduced by the parts of pi / 2: up to 2^10 times the first two, of 42 bits each, is exact.
inline constexpr double many_radians = 1024.0;
inline constexpr std::array half_pi_parts = {0x1.921fb544428p+0, 0x1.4611a62633p-42, 0x1.45c06e0e68948p-86};
inline constexpr double per_half_pi = 0x1.45f306dc9c883p-1;

/// The series of (x - sin x) / x^3 and of (cos x - 1 + x^2 / 2) / x^4 in x^2. They alternate: in [-pi / 4, pi / 4] the
/// first term that is left out bounds the error: 2^-62 and 2^-58.
inline constexpr std::array sine_terms = {
    1.0 / 6.0,        -1.0 / 120.0,        1.0 / 5040.0,          -1.0 / 362880.0,
    1.0 / 39916800.0, -1.0 / 6227020800.0, 1.0 / 1307674368000.0, -1.0 / 355687428096000.0};
inline constexpr std::array cosine_terms = {
    1.0 / 24.0,        -1.0 / 720.0,         1.0 / 40320.0,         -1.0 / 3628800.0,
    1.0 / 479001600.0, -1.0 / 87178291200.0, 1.0 / 20922789888000.0};

}  // namespace dartcast::detail
