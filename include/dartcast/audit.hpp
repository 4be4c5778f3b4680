// The audit: whether every particle is where its state says, by slow exact arithmetic that shares no code with the
// walk.
#pragma once

#include <cstdint>
#include <string>

#include "base/parallel.hpp"
#include "dartcast/environment.hpp"

namespace dartcast {

struct Audit {
  std::uint64_t checked = 0;
  std::uint64_t failed = 0;
  std::string first;  ///< what is wrong with the first particle that failed; empty: nothing

  Audit& operator+=(const Audit& other);
};

/// Checks guarantee G3 for each particle, in integers of any length: its cell exists and is free; the simplex that its
/// state names is positive and holds its position, border included. A held particle: its cell exists, its coordinates
/// are finite and none is negative. Precondition: the particles have followed the environment's last move. Cost: about
/// 5 us per particle, parallel.
Audit audit(const CellComplex& complex, const Particles& particles, Threads threads = {});

}  // namespace dartcast
