// The public types that spheres, bodies and catheters share: limits of numbers, bounds of contacts, and records of
// rigid bodies.
#pragma once

#include <cstdint>

#include "dartcast/vec3.hpp"

namespace dartcast {

/// The largest radius of a sphere, in the unit of the positions. Volumes and masses then do not overflow. A point has
/// the radius 0.
inline constexpr double largest_radius = 0x1p+100;
/// Whether r is in [0, largest_radius].
inline bool is_radius(double r) { return r >= 0.0 && r <= largest_radius; }

/// The limits of a mass. Its inverse, and sums and products with it, then neither overflow nor vanish.
inline constexpr double smallest_mass = 0x1p-300;
inline constexpr double largest_mass = 0x1p+300;
/// Whether m is in [smallest_mass, largest_mass].
inline bool is_mass(double m) { return m >= smallest_mass && m <= largest_mass; }

/// The time of impact of a sphere is never after the first touch, and before it by at most this share of the motion.
inline constexpr double sphere_time_bound = 0x1p-30;

/// A sphere touches a wall if its radius and its distance from the wall differ by no more than this share of
/// (radius + the largest coordinate of the centre). This is the rounding of a centre at that distance. Two points that
/// are no farther apart count as one.
inline constexpr double touching_bound = 0x1p-46;

/// Collisions of spheres, with each other and with walls, in one step.
struct CollisionCounts {
  std::uint64_t pairs_tested = 0;    ///< pairs whose swept boxes met
  std::uint64_t pairs_near = 0;      ///< pairs given to the solver
  std::uint64_t pairs_touching = 0;  ///< pairs given an impulse
  std::uint64_t walls_touching = 0;  ///< contacts with walls that got an impulse; those of lone spheres need none
  std::uint64_t overlaps = 0;        ///< pairs closer than the sum of their radii at the start of the step
  double deepest = 0.0;              ///< the deepest of these overlaps

  CollisionCounts& operator+=(const CollisionCounts& other);
};

/// An impulse that the next step's solver starts from.
struct CachedImpulse {
  std::uint64_t a = 0;  ///< ids of the two spheres; at a wall: the id of the sphere, and `wall`
  std::uint64_t b = 0;
  Vec3 normal;
  double normal_impulse = 0.0;  ///< along the normal
  Vec3 tangent_impulse;

  static constexpr std::uint64_t wall = ~std::uint64_t{0};
  bool operator==(const CachedImpulse&) const = default;
};

/// A matrix by columns: the images of the unit vectors.
struct Mat3 {
  Vec3 x = {1.0, 0.0, 0.0};
  Vec3 y = {0.0, 1.0, 0.0};
  Vec3 z = {0.0, 0.0, 1.0};

  constexpr bool operator==(const Mat3&) const = default;
};

/// w + v; a rotation if its length is 1.
struct Quaternion {
  double w = 1.0;
  Vec3 v;

  constexpr bool operator==(const Quaternion&) const = default;
};

/// A rigid body as a solver of contacts sees it. A sphere is a body that does not turn.
struct RigidMover {
  double inverse_mass = 0.0;  ///< 0: nothing can push or turn it
  bool turns = false;
  Mat3 inverse_inertia = {{}, {}, {}};  ///< about the centre; symmetric, no eigenvalue below 0
  Vec3 centre;
  Vec3 velocity;  ///< of the centre; in: after all other forces; out: after the impulses, with rebounds
  Vec3 angular_velocity;
  Vec3 position_delta;  ///< out: displacement in the step, without rebounds, with the correction of overlaps
  Vec3 rotation_delta;  ///< out: the rotation in the step likewise, rad

  /// The velocity of the point of the body that is at x.
  [[nodiscard]] Vec3 velocity_at(const Vec3& x) const {
    return turns ? velocity + cross(angular_velocity, x - centre) : velocity;
  }
};

}  // namespace dartcast
