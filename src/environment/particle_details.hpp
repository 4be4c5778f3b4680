// The data that a set of particles has beside the states.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "dartcast/environment.hpp"
#include "environment/cell_particle_index.hpp"
#include "tracking/batch/particle_cache.hpp"

namespace dartcast {

struct Particles::Details {
  std::vector<Weights> weights;
  detail::ParticleCache cache;
  std::optional<detail::CellParticleIndex> index;  ///< of these states; none if they have changed since
  std::uint64_t environment = 0;                   ///< its number; 0: of none yet
  std::uint64_t moves = 0;                         ///< of the environment, that these states have followed
  std::uint64_t edits = 0;
};

}  // namespace dartcast
