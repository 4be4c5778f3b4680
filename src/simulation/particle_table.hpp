// The columns that a simulation keeps of its particles. Not installed.
#pragma once

#include <cstdint>

#include "base/table.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/response.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

/// What stands beside the states of particles in the environment. A new particle is alive, and has zeros.
struct ParticleTable : Table {
  /// `width`: numbers of user data.
  explicit ParticleTable(std::size_t width = 0) : user_data(add_column<double>(width)) {}

  Column<std::uint64_t> id = add_column<std::uint64_t>();
  Column<Vec3> velocity = add_column<Vec3>();
  Column<ParticleStatus> fate = add_column<ParticleStatus>();
  Column<std::uint32_t> contact_count = add_column<std::uint32_t>();
  Column<double> radius = add_column<double>();
  Column<std::uint8_t> held = add_column<std::uint8_t>();  ///< in the last step
  Column<double> user_data;
};
static_assert(ParticleStatus{} == ParticleStatus::alive);

/// The table of a checkpoint has the states, too. Cells are those of the whole environment.
struct SavedParticles : ParticleTable {
  explicit SavedParticles(const ParticleTable& table = ParticleTable())
      : ParticleTable(table), state(add_column<ParticleState>()), held_weights(add_column<Weights>()) {}

  Column<ParticleState> state;
  Column<Weights> held_weights;
};

}  // namespace dartcast
