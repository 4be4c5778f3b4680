// Random numbers that are the same on every machine, compiler and library.
#pragma once

#include <cstdint>

namespace dartcast {

/// A sequence of random numbers that depends on the seed alone: SplitMix64, after G. L. Steele, D. Lea, C. H. Flood,
/// "Fast splittable pseudorandom number generators", 2014. Every operation is an integer one or exact in doubles.
class Random {
 public:
  /// Streams of one seed are separate sequences, so that one use does not shift the numbers of another.
  explicit constexpr Random(std::uint64_t seed, std::uint64_t stream = 0) : state_(seed) {
    state_ = next() ^ (stream * 0xd1342543de82ef95U);
  }

  /// As after so many calls of next().
  constexpr void skip(std::uint64_t count) { state_ += count * 0x9e3779b97f4a7c15U; }

  /// 64 random bits.
  constexpr std::uint64_t next() {
    state_ += 0x9e3779b97f4a7c15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
  }

  /// A multiple of 2^-53 in [0, 1).
  constexpr double uniform() { return static_cast<double>(next() >> 11U) * 0x1p-53; }

  /// A number in [low, high); `high` itself if rounding leads there.
  constexpr double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// An integer in [0, n), n > 0; uniform to n / 2^32.
  constexpr std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(((next() >> 32U) * n) >> 32U); }

 private:
  std::uint64_t state_;
};

}  // namespace dartcast
