// Integers of 256 bits in units of 2^-170: the amounts of a tally.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "dartcast/cell_tally.hpp"

namespace dartcast::detail {

inline constexpr int tally_amount_digits = 170;  // behind the point

/// Adds carries from part to part, modulo 2^256.
inline void add_to(TallyAmount& sum, const TallyAmount& more) {
  std::uint64_t carry = 0;
  for (std::size_t i = 0; i < sum.part.size(); ++i) {
    const std::uint64_t with_carry = more.part[i] + carry;
    carry = with_carry < carry ? 1 : 0;
    sum.part[i] += with_carry;
    if (sum.part[i] < with_carry) ++carry;
  }
}

inline TallyAmount operator-(TallyAmount a) {
  for (std::uint64_t& part : a.part) part = ~part;
  add_to(a, {{1}});
  return a;
}
inline TallyAmount operator-(TallyAmount a, const TallyAmount& b) {
  add_to(a, -b);
  return a;
}

/// x, rounded towards 0; the nearest of -2^84 and 2^84 beyond them. Precondition: x is a number.
inline TallyAmount tally_amount(double x) {
  const double size = std::min(std::abs(x), 0x1p+84);
  const auto bits = std::bit_cast<std::uint64_t>(size);
  const int exponent = static_cast<int>(bits >> 52U);
  const int shift = exponent - 1075 + tally_amount_digits;  // of the digits 1.f
  TallyAmount a;
  if (exponent == 0 || shift <= -53) return a;
  const std::uint64_t digits = (bits & 0xfffffffffffffU) | std::uint64_t{1} << 52U;
  if (shift < 0) {
    a.part[0] = digits >> static_cast<unsigned>(-shift);
  } else {
    const auto at = static_cast<std::size_t>(shift) / 64;
    const unsigned left = static_cast<unsigned>(shift) % 64;
    a.part[at] = digits << left;
    if (left > 11) a.part[at + 1] = digits >> (64 - left);
  }
  return x < 0.0 ? -a : a;
}

}  // namespace dartcast::detail
