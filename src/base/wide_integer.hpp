// The whole product of two 64-bit integers.
#pragma once

#include <cstdint>

namespace dartcast {

struct WideProduct {
  std::uint64_t high, low;
};

constexpr WideProduct wide_product(std::uint64_t a, std::uint64_t b) {
  __extension__ using Wide = unsigned __int128;
  const Wide product = static_cast<Wide>(a) * b;
  return {static_cast<std::uint64_t>(product >> 64U), static_cast<std::uint64_t>(product)};
}

/// An integer in [0, n) for 64 random bits; uniform to n / 2^64.
constexpr std::uint64_t scaled_below(std::uint64_t bits, std::uint64_t n) { return wide_product(bits, n).high; }

}  // namespace dartcast
