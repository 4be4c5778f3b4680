// The one reflection law: the velocity after all walls at a face, edge or vertex act at once. Particles, spheres and
// the particles of bodies share it.
//
// T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision detection in
// deformable environments", SPM 2009, section 7.4: "edge or vertex: the normals of all incident walls".
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "dartcast/contact.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

/// The walls of one impact: those of a contact, and others that join them. Results depend on the set of walls alone:
/// their order, and how often one is listed, change no bit.
class JointWalls {
 public:
  // A list of walls is what it stands for: NOLINTBEGIN(google-explicit-constructor)
  JointWalls(std::span<const WallHit> walls, std::span<const WallHit> joined = {}) : walls_(walls), joined_(joined) {}
  JointWalls(const std::vector<WallHit>& walls) : walls_(walls) {}
  // NOLINTEND(google-explicit-constructor)

  [[nodiscard]] std::size_t size() const { return walls_.size() + joined_.size(); }
  const WallHit& operator[](std::size_t i) const { return i < walls_.size() ? walls_[i] : joined_[i - walls_.size()]; }

 private:
  std::span<const WallHit> walls_;
  std::span<const WallHit> joined_;
};

/// The walls were given a vector. Another one counts as pointing into no wall if it does so by at most this share of
/// the length of the first. A projection meets the walls that it was made on up to some ten roundings of 2^-53.
/// (Normals are of length 1 up to four of them, and creases are made orthogonal twice.) 2^-46 is 128 of them. A vector
/// that exceeds it is never returned, so that the share bounds every result. No decision of a walk depends on it.
inline constexpr double rounding_share = 0x1p-46;

/// Whether v points into a wall by more than `limit`.
bool points_into(const Vec3& v, const JointWalls& walls, double limit);

/// A velocity that its walls hold back, and what they need for it: at most three of them, along their normals.
struct HeldBack {
  Vec3 velocity;
  std::array<const WallHit*, 3> wall{};
  std::array<double, 3> impulse{};  ///< per mass, >= 0
  unsigned count = 0;
};

/// The velocity nearest to v that points into none of the walls, up to rounding_share of v: v's projection onto the
/// cone of such velocities. If rounding finds none it is 0. Precondition: normals are of length 1. Cost: linear in
/// the number of walls, most often once or twice.
HeldBack held_back(const Vec3& v, const JointWalls& walls);

/// How a wall answers.
struct WallSurface {
  double restitution = 0.0;  ///< in [0, 1]
  double friction = 0.0;     ///< >= 0
};

/// `velocity`, or less of it: shortened so that |velocity + lead|^2 - |lead|^2 is at most `limit`, as it is computed;
/// to the least value on the line if that is still more. Without a lead its square is never more than `limit`.
Vec3 shortened(const Vec3& velocity, double limit, const Vec3& lead);

namespace detail {

/// The part b of a rebound with the speed y >= 0. With it the energy of the moment is the energy before, less the part
/// that restitution took. This means y^2 / 2 + y l = b^2 / 2 + lead . blocked.
inline Vec3 rebound_of_moment(const Vec3& b, const Vec3& blocked, const Vec3& lead) {
  const double speed = norm(b);
  if (!(speed > 0.0)) return b;
  const Vec3 direction = b * (1.0 / speed);
  const double l = dot(lead, direction);
  const double square = speed * speed + l * l + 2.0 * dot(lead, blocked);
  return square > 0.0 ? direction * std::max(0.0, std::sqrt(square) - l) : Vec3{};
}

}  // namespace detail

/// The velocity after one impact on all walls that hold v back. These impulses are enlarged by 1 + restitution (J. J.
/// Moreau, "Unilateral contact and dry friction in finite freedom dynamics", 1988), and the rest along the walls loses
/// the part that Coulomb's law takes. It may point into a wall that v did not point into. `surface_of(wall, into)`:
/// `into` is the speed at which v points into it.
///
/// Let v be the velocity at the end of the step, and v + lead that of the moment of the contact. With a constant
/// acceleration a and the contact at a share t of the step dt, the lead is (t - 1/2) dt a, otherwise 0. The kinetic
/// energy of the moment, |v + lead|^2 / 2, never grows (docs/method.md, "Reflection"). Proof: P = held_back(v) is
/// orthogonal to the impulses L = P - v (each wall that holds it is met exactly), so that |v|^2 = |P|^2 + |L|^2. The
/// rebound B is a sum of the same impulses, each times its restitution <= 1. It is not longer than L: by itself with
/// one restitution, else shortened. Friction shortens P. So |P + B|^2 = |P|^2 + |B|^2 <= |v|^2, up to rounding. Then
/// shortened() takes the rounding away: as computed, dot(result, result) <= dot(v, v). With a lead, the same holds for
/// the energy of the moment, but for the energy that a particle at rest keeps. This is |lead|^2 / 2 at most.
template <class SurfaceOf>
Vec3 after_impact(const Vec3& v, const JointWalls& walls, const SurfaceOf& surface_of, const Vec3& lead = {}) {
  const HeldBack held = held_back(v, walls);
  Vec3 back;
  double lost = 0.0;
  for (unsigned i = 0; i < held.count; ++i) {
    const Vec3& normal = held.wall[i]->normal;
    const WallSurface surface = surface_of(*held.wall[i], -dot(v, normal));
    back += normal * (surface.restitution * held.impulse[i]);
    lost += surface.friction * (1.0 + surface.restitution) * held.impulse[i];
  }
  // If walls with different responses face each other, some may give more than all of them took together.
  if (held.count > 1) {
    const double limit = norm(held.velocity - v);
    const double given = norm(back);
    if (given > limit) back *= limit / given;
  }
  if (lead != Vec3{}) back = detail::rebound_of_moment(back, v - held.velocity, lead);
  const double speed = norm(held.velocity);
  const Vec3 after = held.velocity * (speed > lost ? 1.0 - lost / speed : 0.0) + back;
  return shortened(after, dot(v, v) + 2.0 * dot(lead, v), lead);
}

/// The velocity after impacts on all walls at once, one after the other until v points into none: one may point it into
/// another wall. If they do not end soon, v is held back. The result points into no wall by more than rounding_share
/// of v, and its energy is not above that of v, as for after_impact().
template <class SurfaceOf>
Vec3 rebounded(const Vec3& v, const JointWalls& walls, const SurfaceOf& surface_of, const Vec3& lead = {}) {
  constexpr unsigned max_impacts = 32;  // between two walls at 5.7 degrees or more there are no more
  if (!points_into(v, walls, 0.0)) return v;
  const double limit = rounding_share * norm(v);
  Vec3 result = v;
  for (unsigned impact = 0; impact < max_impacts; ++impact) {
    result = after_impact(result, walls, surface_of, lead);
    if (!points_into(result, walls, limit)) return result;
  }
  return shortened(held_back(result, walls).velocity, dot(result, result) + 2.0 * dot(lead, result), lead);
}

}  // namespace dartcast
