// Convex cells from a drawing: rings in the plane, with an inside and an outside.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// A closed polyline in the plane z = 0, in either direction; the first point is not repeated at the end.
struct Ring {
  std::vector<Vec3> points;
  std::string name;  ///< the patch of its edges; empty: none
};

struct DecomposeOptions {
  bool with_outside = true;          ///< whether the outside, up to a rectangle around the drawing, has cells too
  double margin = 0.1;               ///< how far that rectangle reaches beyond: share of the drawing's longer extent
  std::uint32_t max_corners = 1000;  ///< of a cell, 3 to 1000; with 3 all cells are triangles
};

/// A planar mesh of the inside of rings: of all points from which a ray crosses them an odd number of times, so that
/// rings within rings are holes, islands in holes, and so on. Points are those of the rings, in order and unchanged,
/// then (with_outside) the four corners of the rectangle, counterclockwise from the lowest.
///
/// Cells are strictly convex, decided exactly, so that every three corners of one are a positive triangle. They
/// conform: each edge of a ring is an edge of the mesh, and every other edge, but for those of the rectangle, is shared
/// by two cells. Each begins with its point of the lowest number; they are ordered by it, those inside first. Those
/// inside are free and of region 1, "inside"; the others blocked and of region 2, "outside". Edges of named rings are
/// patch faces, in the ring's direction; rings of one name share a patch. The same rings scaled by a power of two give
/// the same cells.
///
/// Throws InvalidMesh, naming ring and point: fewer than three points, one that is not finite, outside the exact range,
/// off the plane z = 0, or given before in any ring; edges that cross, overlap, or run through another point: rings may
/// not touch themselves or each other. Throws InvalidArgument: no rings, 2^28 points or more, an option out of range, a
/// margin so small or so large that the rectangle cannot be told from the drawing, or leaves the exact range.
///
/// Cost: n log n for usual drawings, 5 to 10 us and about 350 bytes a point; each edge costs, besides, the edges
/// between points on either side of it that it has to break.
///
/// This work is based on a constrained Delaunay triangulation (mesh/planar_triangulation.hpp), whose edges are then
/// taken out as long as cells stay convex (mesh/merge_convex.hpp).
MeshData decompose(std::span<const Ring> rings, const DecomposeOptions& options = {});

}  // namespace dartcast
