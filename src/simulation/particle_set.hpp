// The particles of a simulation: their states in the environment, and the table beside them. Not installed.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/table.hpp"
#include "dartcast/simulation.hpp"

namespace dartcast {

/// Whether a particle leaves the scene at the end of the step. Until then it stays where it is.
inline bool leaves(ParticleStatus status) {
  return status == ParticleStatus::absorbed || status == ParticleStatus::escaped;
}

/// The columns beside the states of particles. A new particle is alive, and has zeros.
struct ParticleTable : Table {
  /// `width`: numbers of user data.
  explicit ParticleTable(std::size_t width = 0) : user_data(add_column<double>(width)) {}

  Column<std::uint64_t> id = add_column<std::uint64_t>();
  Column<Vec3> velocity = add_column<Vec3>();
  Column<ParticleStatus> fate = add_column<ParticleStatus>();
  Column<std::uint32_t> contact_count = add_column<std::uint32_t>();
  Column<double> radius = add_column<double>();
  Column<std::uint8_t> held = add_column<std::uint8_t>();  ///< in the last step
  Column<double> diameter = add_column<double>();          ///< as Material has it; so are the next two
  Column<double> density = add_column<double>();
  Column<double> charge_per_mass = add_column<double>();
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

class SizeSampler;

/// The motion that a particle starts with, and its user's numbers; none of these: zeros.
struct NewParticle {
  Vec3 velocity;
  double radius = 0.0;
  std::span<const double> user_data;
  Material material = {};
  const SizeSampler* sizes = nullptr;  ///< none: the material's diameter and the radius above
  bool interception = false;           ///< with sizes
};

/// Row i of the table is that of state i, but while particles are added.
struct ParticleSet {
  explicit ParticleSet(std::size_t width) : table(width) {}

  Particles states;
  ParticleTable table;
  std::uint64_t next_id = 0;
  std::size_t spheres = 0;  ///< of a radius above 0

  [[nodiscard]] std::span<const std::uint64_t> ids() const { return table[table.id]; }
  [[nodiscard]] std::span<Vec3> velocities() { return table[table.velocity]; }
  [[nodiscard]] std::span<const Vec3> velocities() const { return table[table.velocity]; }
  [[nodiscard]] std::span<ParticleStatus> statuses() { return table[table.fate]; }
  [[nodiscard]] std::span<const ParticleStatus> statuses() const { return table[table.fate]; }
  [[nodiscard]] std::span<const std::uint32_t> contact_counts() const { return table[table.contact_count]; }
  [[nodiscard]] std::span<const double> radii() const { return table[table.radius]; }
  [[nodiscard]] std::span<const std::uint8_t> held() const { return table[table.held]; }
  [[nodiscard]] std::span<double> user_data(std::size_t i) { return table.row(table.user_data, i); }
  [[nodiscard]] std::span<const double> user_data(std::size_t i) const { return table.row(table.user_data, i); }

  /// Adds the row of the next state that has none.
  void complete(std::uint64_t id, const NewParticle& particle);
  /// Removes the particles marked with 1.
  void remove(std::span<const std::uint8_t> marks);
  /// The same if the states are removed already.
  void remove_rows(std::span<const std::uint8_t> marks);
  void count_spheres();
  void put_in_order_of_ids();
  /// Calls add(), and undoes all that it has added if it throws.
  template <class Add>
  void enlarge(Add&& add) {
    const std::size_t rows = table.rows();
    const std::uint64_t next = next_id;
    try {
      add();
    } catch (...) {
      states.truncate(rows);
      table.truncate(rows);
      next_id = next;
      count_spheres();
      throw;
    }
  }
};

/// Whether this holds for the response of any wall.
template <class Holds>
bool any_response(const SimulationOptions& options, const Holds& holds) {
  return holds(options.response) || std::any_of(options.patch_responses.begin(), options.patch_responses.end(),
                                                [&](const auto& patch) { return holds(patch.second); });
}
/// Whether walls take particles as drops.
inline bool knows_drops(const SimulationOptions& options) {
  return any_response(options, [](const WallResponse& r) { return r.stick_below_weber > 0.0; });
}

/// Throws InvalidArgument where a particle cannot start so. `whose`: "particle {}'s", with this number.
void check(const NewParticle& particle, const Environment& environment, const SimulationOptions& options,
           const char* whose, std::size_t number = 0);

}  // namespace dartcast
