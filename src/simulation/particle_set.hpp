// The particles of a simulation: their states in the environment, and the table beside them. Not installed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "dartcast/environment.hpp"
#include "environment/addition.hpp"
#include "simulation/particle_table.hpp"

namespace dartcast {

/// Whether a particle leaves the scene at the end of the step. Until then it stays where it is.
inline bool leaves(ParticleStatus status) {
  return status == ParticleStatus::absorbed || status == ParticleStatus::escaped;
}

/// The motion that a particle starts with, and its user's numbers; none of these: zeros.
struct NewParticle {
  Vec3 velocity;
  double radius = 0.0;
  std::span<const double> user_data;
};

/// Row i of the table is that of state i, but while particles are added.
struct ParticleSet {
  explicit ParticleSet(std::size_t width) : table(width) {}

  Particles states;
  ParticleTable table;
  std::uint64_t next_id = 0;
  std::size_t spheres = 0;  ///< of a radius above 0

  [[nodiscard]] std::span<Vec3> velocities() { return table[table.velocity]; }
  [[nodiscard]] std::span<ParticleStatus> fates() { return table[table.fate]; }
  [[nodiscard]] std::span<std::uint32_t> contact_counts() { return table[table.contact_count]; }
  [[nodiscard]] std::span<std::uint8_t> held() { return table[table.held]; }

  /// Adds the row of the next state that has none.
  void complete(std::uint64_t id, const NewParticle& particle);
  /// Removes the particles marked with 1.
  void remove(std::span<const std::uint8_t> marks);
  /// The same where the states are removed already.
  void remove_rows(std::span<const std::uint8_t> marks);
  void count_spheres();
  void put_in_order_of_ids();
};

/// Undoes an addition to a set where an exception ends it.
class SetAddition {
 public:
  explicit SetAddition(ParticleSet& set)
      : set_(set), states_(set.states), before_(set.table.rows()), next_id_(set.next_id), spheres_(set.spheres) {}
  SetAddition(const SetAddition&) = delete;
  SetAddition& operator=(const SetAddition&) = delete;
  ~SetAddition() {
    if (kept_) return;
    set_.table.truncate(before_);
    set_.next_id = next_id_;
    set_.spheres = spheres_;
  }
  /// The addition is done.
  void keep() {
    states_.keep();
    kept_ = true;
  }

 private:
  ParticleSet& set_;
  Addition states_;
  std::size_t before_;
  std::uint64_t next_id_;
  std::size_t spheres_;
  bool kept_ = false;
};

}  // namespace dartcast
