// Spheres in an environment: particles with radii, advanced with contacts where their surfaces touch walls.
//
// In the plane they are discs. The centre is a particle of the environment, moved by Environment::advance() alone:
// whatever happens to the sphere, its centre never passes a wall.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "dartcast/environment.hpp"
#include "dynamics/near_walls.hpp"
#include "dynamics/sphere_touch.hpp"

namespace dartcast {

/// A wall that a sphere overlapped where its step began: the walls were moved or edited into it, or there is no room.
struct SphereOverlap {
  std::uint32_t particle = 0;
  double depth = 0.0;  ///< radius - distance
  double left = 0.0;   ///< the largest depth, in any wall, at the place that it was moved out to; 0: none
  CellFace face;       ///< of the free cell
  Vec3 point;          ///< on the wall
  Vec3 normal;         ///< unit, from the point to the centre
};

struct SphereReport {
  /// Of spheres and points, as from Environment::advance(). A sphere's contact has the point on the wall; the `normal`
  /// of each of its walls is the unit vector from the point touched there to the centre, which at an edge or a vertex
  /// is no wall's own normal.
  StepReport step;
  std::vector<SphereOverlap> overlaps;  ///< by particle, then the deepest first
};

/// Advances spheres. It keeps what it needs from call to call, so that steps do not allocate: one for each set of
/// particles pays. Results depend on the arguments alone; one that was moved from is as a new one.
class SphereStepper {
 public:
  SphereStepper();
  ~SphereStepper();
  SphereStepper(SphereStepper&&) noexcept;
  SphereStepper& operator=(SphereStepper&&) noexcept;

  /// Advances every particle towards its target, as Environment::advance(), each with its radius (is_radius(), one per
  /// particle). With a radius of 0 it is a point: the same to the last bit, at no further cost.
  ///
  /// - A contact is where the swept sphere first touches a wall: no later than in truth, and within sphere_time_bound
  /// of
  ///   the way it had before it. The centre is then at the distance of the radius (touching_bound) from the point. All
  ///   places touched within the same bound of time are its walls, the first one touched first.
  /// - After a move() the spheres' way to the first contact is judged against the walls as they move, corners on
  ///   straight lines. The centre then goes on with the wall for the rest of the step, and what follows is relative to
  ///   it and judged against the walls as they stand at the end, as for points. Where the centre itself comes to a wall
  ///   (its way relative to the cells is a chord), that is the contact.
  /// - A sphere that overlaps walls where its step begins (after a move(): once it has gone along with the wall) is
  ///   first moved out along the normals, as far as other walls allow: never through one. Where there is no room it is
  ///   left where its depths are balanced. It then makes its own motion from there; while it still overlaps, as a
  ///   sphere of the radius that there is room for: so that it may go along and out, but not deeper.
  /// - Contacts in a step are limited by options.max_contacts, as for points.
  ///
  /// `clearances`: no wall is nearer to a particle's centre, as walls and particles stand; none, or one each. Where
  /// they hold a sphere's way no walls are looked for. After a move() they count for nothing.
  ///
  /// Throws as Environment::advance(), and InvalidArgument where a radius is out of range or their number
  /// does not match; then nothing is changed. Cost: that of a point; where clearances do not tell, 0.1 to 0.3 us for
  /// each cell that the sphere reaches (three of them at a radius of 0.2 cell sizes), 0.1 to 0.4 us for each wall
  /// triangle there, and some us for each contact.
  SphereReport advance(Environment& environment, Particles& particles, std::span<const double> radii,
                       std::span<const Vec3> targets, const ContactCallback& respond = {},
                       const StepOptions& options = {}, std::span<const double> clearances = {});

  struct Buffers;  ///< of its own

 private:
  std::unique_ptr<Buffers> buffers_;
};

/// The same, for once.
SphereReport advance_spheres(Environment& environment, Particles& particles, std::span<const double> radii,
                             std::span<const Vec3> targets, const ContactCallback& respond = {},
                             const StepOptions& options = {});

}  // namespace dartcast
