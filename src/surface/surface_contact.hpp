// What a particle meets on a surface, and what it may do then.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "dartcast/cell_shape.hpp"
#include "dartcast/ids.hpp"
#include "dartcast/surface.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

/// A wall on a surface: an open border, or the border of a blocked face. Vectors are in the plane of the triangle that
/// the place names, that of the particle.
struct SurfaceContact {
  std::uint32_t particle = 0;
  Kind kind = Kind::edge;       ///< edge or vertex
  Dart dart;                    ///< of the wall's edge, or from that vertex; in the free face
  Patch patch;                  ///< of the edge; at a vertex none
  double time_of_impact = 0.0;  ///< fraction of the step, in [0, 1]
  SurfacePlace place;
  Vec3 point;
  /// Unit, within the surface, into the free side; at a vertex it halves the angle between the two walls that meet
  /// there.
  Vec3 normal;
  std::array<Vec3, 2>
      sides;          ///< unit, along the wall, away from the point: to the right as seen along the normal, left
  Vec3 displacement;  ///< the motion that led here, from the place where it began in this step
  Vec3 unused;        ///< what is left of it
};

/// What a particle does after a contact, in the rest of the step.
struct AfterSurfaceContact {
  Vec3 displacement;   ///< in the plane of the contact's triangle; what is normal to it is left out
  bool along = false;  ///< where it points into the wall, or off it by rounding alone, it runs along it exactly
};

/// Decides what follows a contact. Called from several threads at once for different particles; an empty function stops
/// the particle at the wall until the end of the step.
using SurfaceContactCallback = std::function<AfterSurfaceContact(const SurfaceContact&)>;

// For a caller's own responses: what becomes of a vector at the wall. They do nothing where it points off the wall.

/// Rebound, with the share `restitution` of what is normal to the wall.
Vec3 reflected(const SurfaceContact& contact, const Vec3& v, double restitution = 1.0);

/// What of it runs along the wall; in a corner that closes both ways, nothing.
Vec3 slid(const SurfaceContact& contact, const Vec3& v);

}  // namespace dartcast
