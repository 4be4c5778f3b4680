// What a particle of a body does at walls, in both passes of a step.
//
// T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision detection in
// deformable environments", SPM 2009, section 7.4.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "bodies/body_motion.hpp"
#include "dartcast/response.hpp"

namespace dartcast {

/// Wall faces that a particle met last in a step.
struct TouchedFaces {
  std::array<CellFace, 3> face{};
  std::uint8_t count = 0;

  [[nodiscard]] bool has(CellFace f) const;
  /// Those of a contact; past the third none is kept.
  void set(std::span<const WallHit> walls);
};

/// A particle from one contact to the next (or to an end of the step).
struct Leg {
  Vec3 from;             ///< where it begins
  Vec3 before;           ///< velocity there
  Vec3 after;            ///< velocity at the end of the step, if no wall is met
  Vec3 early;            ///< acceleration at the begin of the step
  Vec3 late;             ///< at its end, as foreseen
  double kinetic = 0.0;  ///< per mass, what it may have in `from`: where targets are limited
  double begin = 0.0;    ///< share of the step
  bool pushed = false;   ///< it has met a wall that moves, or been held
};

/// The well that a particle moves in while the fits are fixed: per mass its energy is stiffness |x - goal|^2 / 2 -
/// gravity . x, convex.
struct PotentialEnergy {
  double stiffness = 0.0;
  Vec3 goal;
  Vec3 gravity;

  [[nodiscard]] Vec3 acceleration(const Vec3& x) const { return (goal - x) * stiffness + gravity; }
  /// Energy at x + d less that at x.
  [[nodiscard]] double rise(const Vec3& x, const Vec3& d) const {
    return 0.5 * stiffness * dot(d, d) - dot(acceleration(x), d);
  }
  /// The largest share of the way d from x, in [0, 1], at whose end (and so, the well being convex, before which) the
  /// energy has not risen by more than `kinetic`.
  [[nodiscard]] double affordable_share(const Vec3& x, const Vec3& d, double kinetic) const;
};

/// What a body's contacts need of it.
struct PassBody {
  double stiffness = 0.0;
  bool limited = false;  ///< first pass: no particle aims where it cannot pay to be
  bool slides = false;   ///< second pass: what the walls leave of the way is gone, too
};

/// Data of one pass; the spans have an entry per particle, `bodies` one per body.
struct Pass {
  const WallResponses* responses = nullptr;
  Vec3 gravity;
  double dt = 0.0;
  std::span<const PassBody> bodies;
  std::span<const std::uint32_t> body_of;
  std::span<const Vec3> goals;       ///< at the begin of the pass
  std::span<const Vec3> forces;      ///< per mass, of other bodies: in the first pass
  std::span<const TouchedFaces> on;  ///< at the end of the last step
  std::span<TouchedFaces> next_on;
  std::span<ParticleStatus> fates;
  std::span<Leg> legs;
};

/// The answer to a contact in the first pass; the leg becomes that after the contact.
AfterContact answer_motion(const Pass& pass, const Contact& contact, std::span<const WallHit> walls,
                           std::span<const WallHit> earlier);
/// The answer to a contact in the second pass.
AfterContact answer_pull(const Pass& pass, const Contact& contact, std::span<const WallHit> walls,
                         std::span<const WallHit> earlier);

}  // namespace dartcast
