// Checks of a run: an exact audit of every particle, and a hash of every bit of state.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "dartcast/environment.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/threads.hpp"

namespace dartcast {

class CellComplex;  // dartcast/cell_complex.hpp

// The audit: whether every particle is where its state says, with slow exact arithmetic that shares no code with the
// walk.

/// The outcome of an audit. Sums of audits are audits.
struct Audit {
  std::uint64_t checked = 0;
  std::uint64_t failed = 0;
  std::string first;  ///< the failure of the first particle that failed; empty: none failed

  Audit& operator+=(const Audit& other);
};

/// Checks guarantee G3 for each particle, in integers of any length. Its cell exists and is free, and the simplex that
/// its state names is positive and holds its position, border included. For a held particle: its cell exists, its
/// coordinates are finite, and none is negative. Precondition: the particles have taken part in the environment's last
/// move. Cost: about 5 us per particle, parallel.
Audit audit(const CellComplex& complex, const Particles& particles, Threads threads = {});

// One number for the exact state of a set of particles, whatever their order.

/// A sum of 128-bit hashes, one per particle, over the bits of its state. Equal sets give equal sums in any order. Sets
/// that differ in one bit give different sums, up to a collision of 128 bits. 0 and -0 differ.
class StateHash {
 public:
  using Words = std::array<std::uint64_t, 2>;

  StateHash() = default;
  /// For a hash that was saved with words().
  explicit StateHash(const Words& words) : low_(words[0]), high_(words[1]) {}
  [[nodiscard]] Words words() const { return {low_, high_}; }

  /// Adds a particle. `fate`: its status, as a number that the caller chooses.
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
