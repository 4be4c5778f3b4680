// Spheres in an environment: particles with radii, with contacts where their surfaces touch walls.
//
// In the plane they are discs. The centre is a particle of the environment, which Environment::advance() alone moves,
// so the centre of a sphere never passes a wall.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "dartcast/dynamics.hpp"
#include "dartcast/environment.hpp"

namespace dartcast {

/// A wall that a sphere overlapped at the start of its step: the walls were moved or edited into it, or there is no
/// room.
struct SphereOverlap {
  std::uint32_t particle = 0;
  double depth = 0.0;  ///< radius - distance
  double left = 0.0;   ///< largest depth, in any wall, after the sphere was moved out; 0: none
  CellFace face;       ///< of the free cell
  Vec3 point;          ///< on the wall
  Vec3 normal;         ///< unit, from the point to the centre
};

/// The effects of one step of spheres.
struct SphereReport {
  /// Spheres and points, as from Environment::advance(). A sphere's contact has the point on the wall. The `normal` of
  /// each of its walls is the unit vector from the point touched there to the centre. At an edge or a vertex it is not
  /// the wall's own normal.
  StepReport step;
  std::vector<SphereOverlap> overlaps;  ///< by particle, then the deepest first
};

/// Advances spheres. It keeps its memory from call to call, so that steps do not allocate: use one for each set of
/// particles. Results depend on the arguments alone. A moved-from object can be used again.
class SphereStepper {
 public:
  SphereStepper();
  ~SphereStepper();
  SphereStepper(SphereStepper&&) noexcept;
  SphereStepper& operator=(SphereStepper&&) noexcept;

  /// Advances every particle towards its target, as Environment::advance(), each with its radius (is_radius(), one per
  /// particle). A radius of 0 is a point: the same result to the last bit, at no further cost.
  ///
  /// - Contacts. A contact is where the swept sphere first touches a wall. Its time is never late, and early by at most
  ///   sphere_time_bound of the way before it. The centre is then at the distance of the radius (touching_bound) from
  ///   the point. All places touched within the same bound of time are its walls, the first one touched first.
  /// - Moving walls. After a move() the way to the first contact is tested against the walls as they move, corners on
  ///   straight lines. The wall then carries the centre for the rest of the step. The rest of the way is relative to
  ///   that wall, and is tested against the walls as they stand at the end, as for points. The contact is where the
  ///   centre itself comes to a wall, if it does (its way relative to the cells is a chord).
  /// - Overlaps. A sphere may overlap walls at the start (after a move(): once the wall has carried it). It then
  ///   first moves out along the normals, as far as other walls allow, and never through one. If there is no room
  ///   it stays where its depths are balanced. It then makes its own motion. While it still overlaps it counts as a
  ///   sphere of the radius that there is room for. So it may go along and out, but not deeper.
  /// - options.max_contacts limits the contacts in a step, as for points.
  ///
  /// `clearances`: no wall is nearer to a particle's centre, as walls and particles stand; none, or one each. If a
  /// sphere's way is within its clearance no walls are searched for. After a move() they are ignored.
  ///
  /// Throws as Environment::advance(), and InvalidArgument if a radius is out of range or their number does not
  /// match; then nothing is changed. Cost: that of a point if the clearance suffices. Else 0.1 to 0.3 us for each
  /// cell that the sphere reaches (three of them at a radius of 0.2 cell sizes), and 0.1 to 0.4 us for each wall
  /// triangle there. A contact costs some us.
  SphereReport advance(Environment& environment, Particles& particles, std::span<const double> radii,
                       std::span<const Vec3> targets, const ContactCallback& respond = {},
                       const StepOptions& options = {}, std::span<const double> clearances = {});

  struct Buffers;

 private:
  std::unique_ptr<Buffers> buffers_;
};

/// The same for a single call.
SphereReport advance_spheres(Environment& environment, Particles& particles, std::span<const double> radii,
                             std::span<const Vec3> targets, const ContactCallback& respond = {},
                             const StepOptions& options = {});

/// Advances points while they and the walls move at the same time. It keeps its memory from call to call: use one for each
/// set of particles. Results depend on the arguments alone. A moved-from object can be used again.
///
/// Environment::advance() first lets the cells carry a particle along, and then walks among walls at rest. This is right
/// if no wall is in reach, and quick. If walls turn much in a step it can miss a contact, invent one, or give the
/// time of another (docs/method.md has measurements).
class SimultaneousStepper {
 public:
  SimultaneousStepper();
  ~SimultaneousStepper();
  SimultaneousStepper(SimultaneousStepper&&) noexcept;
  SimultaneousStepper& operator=(SimultaneousStepper&&) noexcept;

  /// Advances every particle towards its target after Environment::move(), as Environment::advance(). Without a move it
  /// is that function.
  ///
  /// - Motion. The particle goes straight from where it was before the move to its target, each vertex straight from its
  ///   previous position to its current one. Whether the particle touches a wall is decided exactly for that motion.
  /// - Contacts. The time of the first one is never late, and early by at most 2^-20 of the step. Walls that are touched
  ///   within share_together count together. The particle then is where it was before the touch: 2^-20 of its way, or up to
  ///   half of it if no nearer place is proved free. From there, and then, its new way is a straight motion of its own.
  ///   So a later contact may lie before the one that led to it; it gets that one's time. Times never fall.
  /// - Along walls. A way along a wall ends 2^-20 of the wall's longest side off it.
  /// - The particle may be carried along instead, as by Environment::advance(), in the rest of its step. This is so
  ///   if a cell in its reach becomes flat, and after options.max_contacts contacts. It is so, too, if the particle
  ///   starts on a wall, or as near as rounding, or was stopped at one in its last step.
  ///
  /// Throws as Environment::advance(). Cost: with it a whole step of a simulation takes 1.6 to three times the
  /// instructions. If points rest on walls that move, it takes nine times as many (docs/method.md).
  StepReport advance(Environment& environment, Particles& particles, std::span<const Vec3> targets,
                     const ContactCallback& respond = {}, const StepOptions& options = {});

  struct Buffers;

 private:
  std::unique_ptr<Buffers> buffers_;
};

}  // namespace dartcast
