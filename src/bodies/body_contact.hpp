// The answers of a body's particles to walls, in both passes of a step.
//
// T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision detection in
// deformable environments", SPM 2009, section 7.4.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "bodies/body_motion.hpp"
#include "dartcast/bodies.hpp"
#include "dartcast/response.hpp"

namespace dartcast {

/// A particle from one contact to the next (or to an end of the step).
struct Leg {
  Vec3 from;             ///< its start
  Vec3 before;           ///< velocity there
  Vec3 after;            ///< velocity at the end of the step, if no wall is met
  Vec3 early;            ///< acceleration at the start of the step
  Vec3 late;             ///< at its end, as predicted
  double kinetic = 0.0;  ///< limit of the energy per mass in `from`, if targets are limited
  double begin = 0.0;    ///< time of `from`, as a share of the step
  bool pushed = false;   ///< it met a moving wall, or was held
};

/// The potential that a particle moves in while the fits are fixed. Its energy per mass, stiffness |x - goal|^2 / 2 -
/// gravity . x, is convex.
struct PotentialEnergy {
  double stiffness = 0.0;
  Vec3 goal;
  Vec3 gravity;

  [[nodiscard]] Vec3 acceleration(const Vec3& x) const { return (goal - x) * stiffness + gravity; }
  /// Energy at x + d less that at x.
  [[nodiscard]] double rise(const Vec3& x, const Vec3& d) const {
    return 0.5 * stiffness * dot(d, d) - dot(acceleration(x), d);
  }
  /// The largest share of the way d from x, in [0, 1], over which the energy rises by at most `kinetic`. (It rises by
  /// no more before the end than at the end, because it is convex.)
  [[nodiscard]] double affordable_share(const Vec3& x, const Vec3& d, double kinetic) const;
};

/// The properties of a body that its contacts need.
struct PassBody {
  double stiffness = 0.0;
  bool limited = false;  ///< first pass: targets are limited to those that the energy covers
  bool slides = false;   ///< second pass: particles lose the rest of their way at walls
};

/// Data of one pass; the spans have an entry per particle, `bodies` one per body.
struct Pass {
  const WallResponses* responses = nullptr;
  Vec3 gravity;
  double dt = 0.0;
  std::span<const PassBody> bodies;
  std::span<const std::uint32_t> body_of;
  std::span<const Vec3> goals;       ///< at the start of the pass
  std::span<const Vec3> forces;      ///< from other bodies, per mass: in the first pass
  std::span<const TouchedFaces> on;  ///< at the end of the last step
  std::span<TouchedFaces> next_on;
  std::span<ParticleStatus> statuses;
  std::span<Leg> legs;
};

/// Answers a contact in the first pass. The particle's leg becomes the one after the contact.
AfterContact answer_motion(const Pass& pass, const Contact& contact, std::span<const WallHit> walls,
                           std::span<const WallHit> earlier);
/// Answers a contact in the second pass.
AfterContact answer_pull(const Pass& pass, const Contact& contact, std::span<const WallHit> walls,
                         std::span<const WallHit> earlier);

}  // namespace dartcast
