// The motion of an environment's walls together with what has edges among them: sets of solids, catheters.
#pragma once

#include <memory>
#include <span>

#include "dartcast/environment.hpp"
#include "dartcast/solids.hpp"
#include "dynamics/near_walls.hpp"

namespace dartcast {

/// A partner moves at the same time as the walls, and stops them where it has no room. The calls come in this order; up to
/// after_move() nothing that the caller can see changes.
class MovePartner {
 public:
  virtual ~MovePartner() = default;

  /// Plans a way for the time in which the walls make theirs. Returns the share of both up to which they are free of
  /// contact, before rounding; 1: the whole way is, and is proved.
  virtual double plan(const VertexMotion& walls) = 0;
  /// Shortens the planned way to this share of it, at most 1, for walls that make the same share of theirs. Returns whether
  /// that way is proved free. With a share of 0 it always is.
  virtual bool shorten(double share, const VertexMotion& walls) = 0;
  /// The environment has moved: goes the way.
  virtual void after_move() = 0;

 protected:
  MovePartner() = default;
  MovePartner(const MovePartner&) = default;
  MovePartner& operator=(const MovePartner&) = default;
};

/// Moves the environment straight to these positions of all the mesh's points, and its partners with it, as far as all of
/// them have room. Returns the share of the ways that were made. Throws as Environment::move(), nothing changed.
double move_together(Environment& environment, std::span<MovePartner* const> partners, std::span<const Vec3> positions);

/// Sets of solids as partners of a joint move.
struct JointMoves {
  /// Checks as SolidSet::move_with() does, and throws as it does. The set is a partner of the next joint move.
  static MovePartner& prepare(SolidSet& solids, std::span<const Vec3> targets, const SolidStepOptions& options);
  /// The report of the set's last step.
  static const SolidStep& last_step(const SolidSet& solids);
  /// A copy in the same environment.
  static std::unique_ptr<SolidSet> copy(const SolidSet& solids);
};

/// After the move: takes the particles straight to these places, on ways that are proved free. Throws InternalError where no
/// cell on a particle's way holds its place.
void follow_move(Environment& environment, Particles& particles, std::span<const Vec3> to);

/// Where its simplex carries a particle while the walls move: it keeps its weights there, so that it meets no wall.
Vec3 carried_by_cell(const CellComplex& complex, const ParticleState& state, const VertexMotion& walls);

/// A share of a straight way, rounded.
Vec3 on_way(const Vec3& from, const Vec3& to, double share);

/// A share of the way to the first touch: the next step must not start with one.
inline constexpr double cut_share = 15.0 / 16.0;
/// A smaller share of a way is none.
inline constexpr double least_share = 0x1p-30;

}  // namespace dartcast
