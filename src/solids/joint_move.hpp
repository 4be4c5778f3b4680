// The motion of an environment's walls together with what has edges among them: sets of solids, catheters.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "dartcast/environment.hpp"
#include "dartcast/solids.hpp"
#include "dynamics/near_walls.hpp"

namespace dartcast {

/// A partner moves at the same time as the walls, and stops them if it has no room. The calls come in this order; up to
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

/// How far a solid's way is from its chords.
struct SolidArc {
  /// No point is ever farther from the chord of the whole way. Chords of n equal parts of the way: this / n^2.
  double bend = 0.0;
  /// The step leaves this between the solid and the walls, so that the way itself is free; 0: chords alone are looked at. A
  /// solid that is nearer at the start keeps that distance, and its slices are as fine as it needs.
  double separation = 0.0;
};

/// The way of a set of solids in a step: straight, or cut into slices of equal length, each of which is straight.
struct SolidWay {
  std::vector<Vec3> targets;  ///< of all vertices: the end of the way
  unsigned slices = 1;        ///< > 0; arcs may need more
  /// Writes where the vertices of a solid are at a share of its way, in (0, 1). None: the way is straight.
  std::function<void(std::uint32_t solid, double share, std::span<Vec3> vertices)> place = {};
  std::vector<SolidArc> arcs = {};  ///< of each solid; empty: no solid has one
};

/// The slices in which a way leaves its chords by at most half of a distance. Precondition: distance > 0 if bend is.
inline double slices_of(double bend, double distance) {
  return bend > 0.0 ? std::max(1.0, std::ceil(std::sqrt(2.0 * bend / distance))) : 1.0;
}
/// The most slices of a step.
inline constexpr double max_slices = 0x1p16;

/// Sets of solids as partners of a joint move.
struct JointMoves {
  /// Checks as SolidSet::move_with() does, and throws as it does. The set is a partner of the next joint move.
  static MovePartner& prepare(SolidSet& solids, SolidWay way, const SolidStepOptions& options);
  /// As SolidSet::advance(), on this way. A solid that stops in a slice stays there to the end of the step. Precondition,
  /// also of prepare(): options.rounds is 0 if the way is not straight.
  static const SolidStep& advance(SolidSet& solids, SolidWay way, const SolidStepOptions& options);
  /// The separation of a solid from walls if the options give none, but for walls with shorter sides; 0: it has no side.
  static double separation(const SolidSet& solids, std::size_t solid);
  static constexpr double default_separation = 0x1p-10;  ///< of a side
  /// The report of the set's last step.
  static const SolidStep& last_step(const SolidSet& solids);
  /// A copy in the same environment.
  static std::unique_ptr<SolidSet> copy(const SolidSet& solids);
};

/// A simplex that holds the end of a particle's straight way, border included, after the walls made theirs. `cell` holds
/// its start. Throws InternalError if no cell on the way does. Precondition: the way is free, and cells stay positive.
SimplexId simplex_after(const CellComplex& complex, Cell cell, const Vec3& from, const Vec3& to,
                        const VertexMotion& walls, NearWalls& near);

/// After the move: takes the particles to these places, on ways that are proved free. `simplices` hold the places; if
/// there are none, the ways are straight. Throws as simplex_after().
void follow_move(Environment& environment, Particles& particles, std::span<const Vec3> to,
                 std::span<const SimplexId> simplices = {});

/// Where its simplex carries a particle while the walls move: it keeps its weights there, so that it meets no wall. Its own
/// place if that is out of the exact range.
Vec3 carried_by_cell(const CellComplex& complex, const ParticleState& state, const VertexMotion& walls);

/// A share of a straight way, rounded.
Vec3 on_way(const Vec3& from, const Vec3& to, double share);

/// A share of the way to the first touch: the next step must not start with one.
inline constexpr double cut_share = 15.0 / 16.0;
/// This share of a distance at the start of a step is kept: rounding takes less than the rest.
inline constexpr double kept_share = 1.0 - 0x1p-30;
/// A smaller share of a way is none.
inline constexpr double least_share = 0x1p-30;

}  // namespace dartcast
