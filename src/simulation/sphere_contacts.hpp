// The collisions of spheres with each other, with bodies and with walls among others. Not installed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/simulation.hpp"
#include "dynamics/collider.hpp"
#include "dynamics/near_walls.hpp"
#include "simulation/moving_vertices.hpp"
#include "simulation/particle_set.hpp"
#include "simulation/simulation_state.hpp"
#include "simulation/sphere_bodies.hpp"

namespace dartcast {

/// Precondition of mass() and collide(): there are collisions.
class SphereContacts {
 public:
  /// All outlive it.
  SphereContacts(const Environment& environment, Followers& followers, const MovingVertices& motion,
                 const SimulationOptions& options, const WallResponses& responses)
      : environment_(environment), motion_(motion), options_(options), responses_(responses) {
    followers.add([this](const ComplexEditReport& /*edit*/, OrphanPolicy /*orphaned*/) { forget_walls(); });
  }

  /// Bodies that the spheres meet; they step after each step of the particles.
  void set_bodies(Bodies& bodies) { bodies_ = &bodies; }
  [[nodiscard]] double mass(double radius) const;
  /// Changes the velocities and targets of a segment with impulses. `acceleration`: that of all spheres.
  CollisionCounts collide(ParticleSet& set, std::span<Vec3> targets, double dt, bool moving, const Vec3& acceleration);
  /// For SphereStepper::advance().
  [[nodiscard]] std::span<const double> clearances() const { return clearances_; }
  /// Whether impulses have changed the way of this particle.
  [[nodiscard]] bool pushed(std::uint32_t particle) const { return pushed_[particle] != 0; }
  /// Puts the contacts with walls whose impulses were solved before those of the spheres' own steps, with times that do not
  /// fall.
  void add_to(StepReport& report);
  /// Where particles have other indices.
  void forget_walls() { clear_.clear(); }
  void save(ParticleSystemState& state) const;
  void restore(const ParticleSystemState& state);
  [[nodiscard]] const Collider& collider() const { return collider_; }

 private:
  [[nodiscard]] bool meets_bodies() const { return bodies_ != nullptr && bodies_->size() > 0; }
  void weigh(ParticleSet& set);
  void find_walls(ParticleSet& set, double dt, bool moving);
  [[nodiscard]] double clearance(const ParticleSet& set, std::size_t i) const;
  void walls_of(ParticleSet& set, std::size_t i, double dt, bool moving, NearWalls& near,
                std::vector<WallContact>& found);
  void note_contacts(const ParticleSet& set, std::span<const Vec3> targets, std::span<const WallContact> walls,
                     double dt);
  void take_targets(ParticleSet& set, std::span<Vec3> targets);

  struct Clear {  // no wall is nearer to this place
    Vec3 centre;
    double distance = 0.0;
  };

  const Environment& environment_;
  const MovingVertices& motion_;
  const SimulationOptions& options_;
  const WallResponses& responses_;
  Bodies* bodies_ = nullptr;
  Collider collider_;
  SphereBodyCollider body_collider_;  // in place of the other one while there are bodies
  std::vector<double> met_radii_;     // 0 for those without contacts
  std::vector<double> inverse_masses_;
  std::vector<Clear> clear_;  // by particle; until walls move or are edited
  std::vector<double> clearances_;
  std::vector<Vec3> displacements_;
  std::vector<NearWalls> near_;  // by chunk
  std::vector<std::vector<WallContact>> near_contacts_;
  std::vector<WallContact> walls_;
  ContactList solved_;  // of this segment, with walls whose impulses the solver gave
  std::vector<std::uint8_t> pushed_;
};

}  // namespace dartcast
