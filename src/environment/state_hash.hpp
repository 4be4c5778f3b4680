// One number for the exact state of a set of particles, whatever their order.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "dartcast/particle_state.hpp"

namespace dartcast {

/// A sum of 128-bit hashes, one per particle, over the bits of its state: equal sets give equal sums in any order, and
/// two sets that differ in one bit are told apart as surely as 128 bits can. 0 and -0 differ.
class StateHash {
 public:
  using Words = std::array<std::uint64_t, 2>;

  StateHash() = default;
  /// To save a hash and to go on with it.
  explicit StateHash(const Words& words) : low_(words[0]), high_(words[1]) {}
  [[nodiscard]] Words words() const { return {low_, high_}; }

  /// Adds a particle. `fate`: what has become of it, as a number that the caller chooses.
  void add(std::uint64_t id, const ParticleState& state, const Vec3& velocity, std::uint64_t fate = 0);
  StateHash& operator+=(const StateHash& other);
  bool operator==(const StateHash&) const = default;

  /// 32 hexadecimal digits.
  [[nodiscard]] std::string hex() const;

 private:
  std::uint64_t low_ = 0;
  std::uint64_t high_ = 0;
};

}  // namespace dartcast
