// One step of a particle within a surface: straight lines that unfold across edges.
//
// Straight at vertices, too: K. Polthier, M. Schmies, "Straightest geodesics on polyhedral surfaces", 1998: the path
// leaves a vertex so that the angles on its left and on its right are equal.
#pragma once

#include <cstdint>
#include <vector>

#include "dartcast/surface.hpp"
#include "surface/surface_contact.hpp"

namespace dartcast {

struct SurfaceOptions {
  /// Contacts allowed to a particle in one step, at least 1; at the last one it stops.
  unsigned max_contacts = 16;
  /// Edges and vertices passed in one step, at most. A straight path passes an edge once in a while: around a vertex it
  /// turns by less than pi, so that only the number of triangles along it counts. This bounds the time of a step
  /// whatever rounding does, and steps that are longer than meant.
  std::uint32_t max_crossings = 1U << 20U;
};

enum class SurfaceEnd : std::uint8_t {
  arrived,  ///< the whole way is done
  stopped,  ///< at a contact
  limit,    ///< after max_crossings
  held      ///< its face is blocked
};

struct SurfaceStep {
  SurfaceEnd end = SurfaceEnd::arrived;
  std::uint32_t contacts = 0;
  std::uint32_t crossings = 0;  ///< edges (those within polygons, too) and vertices passed
  double length = 0.0;          ///< of the way done
  /// Unit, in the plane of the place's triangle: the direction that it moved in last, to move on in; zero where it has
  /// not moved. On an edge or at a vertex it may point out of the triangle: a step along it goes straight on.
  Vec3 direction;
  Vec3 remaining;  ///< displacement left, likewise
};

/// An edge or a vertex passed.
struct SurfaceCrossing {
  double time = 0.0;  ///< fraction of the step, in [0, 1]
  Vec3 point;
  Kind kind = Kind::edge;
  Dart dart;           ///< of that edge or from that vertex, in the face left behind; invalid within a polygon
  SurfacePlace place;  ///< in the triangle left behind
};

/// Where to note what a step meets; null: nowhere.
struct SurfaceTrace {
  std::vector<SurfaceContact>* contacts = nullptr;
  std::vector<SurfaceCrossing>* crossings = nullptr;
};

/// Moves a place by a displacement in the plane of its triangle; what is normal to that plane is left out. From an edge
/// it may point to either side, as if the triangle across were unfolded into that plane; from a vertex it is an angle
/// around it: straight through the vertex where it points away from the triangle, else counted from the triangle's
/// corner around the vertex on the shorter side. It goes as far as it says, around corners and over edges, unless walls
/// stop it. Errors of the way: some units in the last place for each triangle passed.
///
/// The place ends on the surface in a free face whatever happens: a ray leaves a triangle by one of its edges or
/// corners, by construction (surface/unfold.hpp). A step of zero length meets nothing; one that ends exactly on a wall
/// meets it at time 1. Throws InvalidArgument, the place unchanged, where the place is none of this surface,
/// max_contacts is 0, or the displacement (or a response's) is not finite or above 2^300.
SurfaceStep step(const Surface& surface, SurfacePlace& place, const Vec3& displacement,
                 const SurfaceContactCallback& respond = {}, const SurfaceOptions& options = {},
                 const SurfaceTrace& trace = {}, std::uint32_t particle = 0);

/// The tangent of a length at an angle, counterclockwise from the edge that starts at a corner of the triangle.
Vec3 tangent(const Surface& surface, SimplexId triangle, unsigned corner, double angle, double length = 1.0);

}  // namespace dartcast
