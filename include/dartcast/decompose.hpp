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

/// How a drawing becomes cells.
struct DecomposeOptions {
  bool with_outside = true;          ///< whether the outside, up to a rectangle around the drawing, has cells too
  double margin = 0.1;               ///< how far that rectangle reaches beyond: share of the drawing's longer extent
  std::uint32_t max_corners = 1000;  ///< of a cell, 3 to 1000; with 3 all cells are triangles
};

/// A planar mesh of the inside of rings. A point is inside if a ray from it crosses the rings an odd number of times.
/// So rings within rings are holes, rings in holes are islands, and so on. Points are those of the rings, in order and
/// unchanged, then (with_outside) the four corners of the rectangle, counterclockwise from the lowest.
///
/// Cells are strictly convex, decided exactly, so that every three corners of one are a positive triangle. They
/// conform. Each edge of a ring is an edge of the mesh, and every other edge, except those of the rectangle, is shared
/// by two cells. Each cell starts with its point of the lowest number. Cells are ordered by that point, those inside
/// first. Cells inside are free and of region 1, "inside". The others are blocked and of region 2, "outside". Edges of
/// named rings are patch faces, in the ring's direction. Rings of one name share a patch. The same rings scaled by a
/// power of two give the same cells.
///
/// Throws InvalidMesh for a ring of fewer than three points, and for edges that cross, overlap, or run through
/// another point. It names ring and point. So does a point that is not finite, outside the exact range, off the plane
/// z = 0, or given before in any ring. Rings may not touch themselves or each other. Throws InvalidArgument for no
/// rings, 2^28 points or more, and an option out of range. So does a margin that is so small that the rectangle
/// coincides with the drawing, or so large that it leaves the exact range.
///
/// Cost: n log n for usual drawings, 5 to 10 us and about 350 bytes a point. In addition, each edge costs the edges
/// between points on either side of it that it has to break.
///
/// This work is based on a constrained Delaunay triangulation (mesh/planar_triangulation.hpp). Its edges are then
/// removed as long as cells stay convex (mesh/merge_convex.hpp).
MeshData decompose(std::span<const Ring> rings, const DecomposeOptions& options = {});

}  // namespace dartcast
