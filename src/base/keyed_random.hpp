// Random numbers that are a function of what they are for, not of what was drawn before.
#pragma once

#include <array>
#include <cstdint>

#include "base/wide_integer.hpp"

namespace dartcast {

/// Philox4x32-10, after J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, "Parallel random numbers: as easy as 1, 2,
/// 3", 2011: 128 random bits for each counter and key. It passes all of TestU01's BigCrush.
constexpr std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = std::uint64_t{0xd2511f53U} * counter[0];
    const std::uint64_t b = std::uint64_t{0xcd9e8d57U} * counter[2];
    counter = {static_cast<std::uint32_t>(b >> 32U) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(b),
               static_cast<std::uint32_t>(a >> 32U) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(a)};
    key[0] += 0x9e3779b9U;
    key[1] += 0xbb67ae85U;
  }
  return counter;
}

/// Uses of random numbers: those of one never shift or repeat those of another. The values are part of every result.
/// They are below 2^8.
enum class RandomPurpose : std::uint32_t {
  place = 1,
  direction = 8,
  diffusion = 16,
  brownian = 17,
  eddy = 18,
  size = 19,
  bridge = 20
};

/// Random bits for items at a moment, which is a number below 2^53. Draws 0 to 7 of an item have others, and so has a
/// KeyedRandom of another purpose.
struct RandomMoment {
  std::uint64_t seed = 0;
  RandomPurpose purpose{};
  std::uint64_t moment = 0;

  [[nodiscard]] constexpr std::array<std::uint32_t, 2> key() const {
    return {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U)};
  }
  /// The half of the counter that is the same for all items.
  [[nodiscard]] constexpr std::array<std::uint32_t, 2> counter(std::uint32_t draw) const {
    const auto later = static_cast<std::uint32_t>(moment >> 32U);
    return {static_cast<std::uint32_t>(moment), static_cast<std::uint32_t>(purpose) | draw << 8U | later << 11U};
  }
  [[nodiscard]] constexpr std::array<std::uint32_t, 4> bits(std::uint64_t id, std::uint32_t draw = 0) const {
    const std::array<std::uint32_t, 2> common = counter(draw);
    return philox({common[0], common[1], static_cast<std::uint32_t>(id), static_cast<std::uint32_t>(id >> 32U)}, key());
  }
};

/// The numbers drawn for one item: a function of the seed, the purpose, the item's id and the number of the draw. The
/// item with id k gets the same ones from every caller, and whatever was drawn for others.
class KeyedRandom {
 public:
  constexpr KeyedRandom(std::uint64_t seed, RandomPurpose purpose, std::uint64_t id)
      : key_{low_half(seed), high_half(seed)},
        counter_{0, static_cast<std::uint32_t>(purpose), low_half(id), high_half(id)} {}

  /// 64 random bits. An item has 2^33 of them.
  constexpr std::uint64_t next() {
    if (second_) {
      second_ = false;
      return std::uint64_t{block_[3]} << 32U | block_[2];
    }
    block_ = philox(counter_, key_);
    ++counter_[0];
    second_ = true;
    return std::uint64_t{block_[1]} << 32U | block_[0];
  }

  /// A multiple of 2^-53 in [0, 1).
  constexpr double uniform() { return static_cast<double>(next() >> 11U) * 0x1p-53; }

  /// An integer in [0, n), n > 0; uniform to n / 2^64.
  constexpr std::uint64_t below(std::uint64_t n) { return scaled_below(next(), n); }

 private:
  static constexpr std::uint32_t low_half(std::uint64_t x) { return static_cast<std::uint32_t>(x); }
  static constexpr std::uint32_t high_half(std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32U); }

  std::array<std::uint32_t, 2> key_;
  std::array<std::uint32_t, 4> counter_;
  std::array<std::uint32_t, 4> block_{};
  bool second_ = false;
};

}  // namespace dartcast
