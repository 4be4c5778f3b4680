// What all walls at a face, edge or vertex leave of a velocity, at once.
//
// T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision detection in
// deformable environments", SPM 2009, section 7.4: "edge or vertex: the normals of all incident walls".
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "dartcast/exact/vec3.hpp"
#include "dartcast/walk/contact.hpp"

namespace dartcast {

/// A velocity that its walls hold back, and what they need for it: at most three of them, along their normals.
struct HeldBack {
  Vec3 velocity;
  std::array<const WallHit*, 3> wall{};
  std::array<double, 3> impulse{};  ///< per mass, >= 0
  unsigned count = 0;
};

/// The velocity nearest to v that points into none of the walls, up to rounding: v's projection onto the cone of such
/// velocities. It is one, whatever the order of the walls (those whose normals differ by less than some 2^-23 may count
/// as one wall). Precondition: normals are of length 1. Cost: some ns per wall where one of them is enough; the cube of
/// their number at edges and vertices.
HeldBack held_back(const Vec3& v, std::span<const WallHit> walls);

/// How a wall answers.
struct WallSurface {
  double restitution = 0.0;
  double friction = 0.0;
};

/// The velocity after an impact on all walls that hold v back: these impulses enlarged by 1 + restitution (J. J.
/// Moreau, "Unilateral contact and dry friction in finite freedom dynamics", 1988), and what is left along the walls
/// less what Coulomb's law takes. It may point into a wall that v did not point into. Its length is not above that of
/// v, up to rounding. `surface_of(wall, into)`: `into` is the speed at which v points into it.
template <class SurfaceOf>
Vec3 after_impact(const Vec3& v, std::span<const WallHit> walls, const SurfaceOf& surface_of) {
  const HeldBack held = held_back(v, walls);
  Vec3 back;
  double lost = 0.0;
  for (unsigned i = 0; i < held.count; ++i) {
    const Vec3& normal = held.wall[i]->normal;
    const WallSurface surface = surface_of(*held.wall[i], -dot(v, normal));
    back += normal * (surface.restitution * held.impulse[i]);
    lost += surface.friction * (1.0 + surface.restitution) * held.impulse[i];
  }
  // Of walls that answer differently and face each other some may give more than all of them took together.
  if (held.count > 1) {
    const double most = norm(held.velocity - v);
    const double given = norm(back);
    if (given > most) back *= most / given;
  }
  const double speed = norm(held.velocity);
  return held.velocity * (speed > lost ? 1.0 - lost / speed : 0.0) + back;
}

}  // namespace dartcast
