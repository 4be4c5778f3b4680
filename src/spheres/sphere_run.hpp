// One sphere's step: a sequence of stretches, each of which ends with a contact, an overlap or the target.
#pragma once

#include <optional>
#include <vector>

#include "dartcast/spheres.hpp"
#include "dynamics/near_walls.hpp"
#include "spheres/sphere_way.hpp"

namespace dartcast::detail {

/// Data that all spheres of a call share.
struct SphereScene {
  const CellComplex* complex = nullptr;
  bool moved = false;  ///< the vertices, in this step
  const ContactCallback* respond = nullptr;
  const StepOptions* options = nullptr;
};

/// The environment's report of a centre that came to a wall.
struct CentreContact {
  const Contact* contact = nullptr;  ///< null: it came to none
  const ContactList* list = nullptr;
};

/// The step of a sphere whose first stretch does not end at its target. It is kept from step to step for its memory.
class SphereRun {
 public:
  /// Starts with a stretch that has been planned for `sphere`. `moving`: among moving walls.
  void start(std::uint32_t particle, const MovingSphere& sphere, const SphereWay& way, bool moving);

  /// Plans the next stretch. Returns the centre's target.
  const Vec3& plan(const SphereScene& scene, const ParticleState& state, NearWalls& near);
  /// To be called when the centre has been advanced to the planned target. Records the contact and calls the
  /// response. Returns whether another stretch follows.
  bool land(const SphereScene& scene, const ParticleState& state, CentreContact centre, NearWalls& near);
  void hold(Cell invalid) { held_ = HeldParticle{particle_, invalid}; }

  [[nodiscard]] std::uint32_t particle() const { return particle_; }
  [[nodiscard]] std::vector<SphereOverlap>& overlaps() { return overlaps_; }
  /// Adds contacts, overlaps and counts.
  void report(SphereReport& report) const;

 private:
  bool touched(const SphereScene& scene, const ParticleState& state, NearWalls& near);
  bool touched_by_centre(const SphereScene& scene, const ParticleState& state, CentreContact centre);
  bool follow(const SphereScene& scene, const ParticleState& state, Contact& contact);
  bool stop(const ParticleState& state, const Vec3& unused, bool unfinished);
  bool moved_out(const SphereScene& scene, const ParticleState& state, NearWalls& near);
  void lift(const Vec3& position, Vec3& q) const;
  [[nodiscard]] double slack(const Vec3& centre) const { return touching_slack(centre, radius_); }

  std::uint32_t particle_ = 0;
  double radius_ = 0.0;
  Vec3 begin_;  // of the stretch
  Vec3 aim_;
  double time_ = 0.0;             // at the start of the stretch
  std::uint32_t first_here_ = 0;  // first of the walls met at the place of the last contact
  bool moving_ = false;
  unsigned corrections_ = 0;
  SphereWay way_;
  std::vector<Contact> contacts_;
  std::vector<WallHit> walls_;
  std::vector<SphereOverlap> overlaps_;
  std::optional<StoppedParticle> stopped_;
  std::optional<HeldParticle> held_;
  bool unfinished_ = false;
};

/// Adds the walls that overlap a sphere, deepest first.
void list_overlaps(const CellComplex& complex, const ParticleState& state, std::uint32_t particle, double radius,
                   NearWalls& near, std::vector<SphereOverlap>& overlaps);

}  // namespace dartcast::detail
