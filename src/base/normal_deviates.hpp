// Deviates of the normal distribution, from random bits that are a function of what they are for.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "base/elementary.hpp"
#include "base/keyed_random.hpp"

namespace dartcast {

/// Four independent deviates of mean 0 and variance 1, after G. E. P. Box, M. E. Muller, 1958. Two words of bits make a
/// pair. They choose u and t, the middles of two of 2^32 equal pieces of [0, 1]. The pair is sqrt(-2 ln u) times the
/// cosine and the sine of t turns.
///
/// Each differs from that value by less than 3 2^-52 of it. Logarithm and sine are off by 1 ulp each, the root halves
/// the first and adds 1/2, and the product adds 1/2. The pieces make the variance smaller than 1 by less than 2^-33,
/// and no deviate is above 6.7.
inline std::array<double, 4> normal_deviates(const std::array<std::uint32_t, 4>& bits) {
  const auto middle = [](std::uint32_t piece) { return (static_cast<double>(piece) + 0.5) * 0x1p-32; };
  std::array<double, 4> deviates{};
  for (std::size_t k = 0; k < 4; k += 2) {
    const double size = std::sqrt(-2.0 * logarithm(middle(bits[k])));
    const SineCosine direction = sine_cosine_of_turns(middle(bits[k + 1]));
    deviates[k] = size * direction.cosine;
    deviates[k + 1] = size * direction.sine;
  }
  return deviates;
}

}  // namespace dartcast
