// A surface in space: a map of polygons with positions. Particles move within it.
//
// A polygon is fanned from its lowest-numbered corner (dartcast/cell_shape.hpp); the triangles of the fans are the
// surface, so that it has no gaps however it is bent. Where a particle is is told within a triangle, by weights: there
// is no point beside the surface to fall off it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/parallel.hpp"
#include "complex/simplex.hpp"
#include "dartcast/combinatorial_map.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

/// A place on a surface: a triangle of a face's fan, and barycentric coordinates in it, none negative. On an edge one
/// of them is exactly 0, at a vertex two. It needs no update when the surface bends: what is on it rides along.
struct SurfacePlace {
  SimplexId triangle;
  std::array<double, 3> weights = {1.0, 0.0, 0.0};

  /// Inside of the triangle, on an edge, or at a vertex.
  [[nodiscard]] Kind kind() const {
    const int zeros = (weights[0] == 0.0 ? 1 : 0) + (weights[1] == 0.0 ? 1 : 0) + (weights[2] == 0.0 ? 1 : 0);
    return zeros == 0 ? Kind::face : zeros == 1 ? Kind::edge : Kind::vertex;
  }
  bool operator==(const SurfacePlace&) const = default;
};

/// What lies across an edge of a triangle; edge i is opposite to corner i.
struct AcrossEdge {
  CellFace face;       ///< the map's edge, of the cell left behind; invalid within a polygon
  SimplexId triangle;  ///< invalid at an open border
  unsigned edge = 0;   ///< of that triangle
  bool wall = false;   ///< an open border, or one face is free and the other is blocked
};

class Surface {
 public:
  /// Takes the mesh as check_and_repair_surface() repairs it. Throws InvalidMesh where that finds a defect, with the
  /// first faces. Cost: n log n.
  explicit Surface(MeshData mesh);

  [[nodiscard]] const CombinatorialMap& map() const { return map_; }
  /// Positions of all points of the mesh, in its order, then of those that edits made (surface/surface_edit.hpp).
  [[nodiscard]] std::span<const Vec3> positions() const { return positions_; }

  /// New positions of all points (numbers that edits gave up can have any); particles ride along. Throws
  /// InvalidArgument, nothing changed, where their number does not match or one is not finite or out of the exact
  /// range, and InvalidMesh, nothing changed, with the faces (numbers in the mesh) that would have a triangle without
  /// area. Cost: linear.
  void move(std::span<const Vec3> positions, Threads threads = {});

  /// Frees or blocks a face, at once: particles in a blocked one are held, its edges to free ones are walls. Throws
  /// InvalidArgument where there is no such face.
  void set_free(Cell face, bool free);

  /// All triangles, face by face.
  [[nodiscard]] std::vector<SimplexId> triangles() const;
  /// Corners counterclockwise, seen from the side that normals point to.
  [[nodiscard]] std::array<Vertex, 3> vertices(SimplexId t) const;
  [[nodiscard]] std::array<Vec3, 3> corners(SimplexId t) const;
  [[nodiscard]] AcrossEdge across(SimplexId t, unsigned edge) const;
  /// Unit normal of a triangle.
  [[nodiscard]] Vec3 normal(SimplexId t) const;

  /// Whether a place can be one here: the triangle is there, weights are in [0, 1] and sum to 1 up to rounding.
  [[nodiscard]] bool contains(const SurfacePlace& place) const;
  /// The point in space, to rounding. One place of an edge is the same point from both sides; a vertex its position.
  [[nodiscard]] Vec3 point(const SurfacePlace& place) const;
  /// A place by any weights that are finite, not negative and not all 0, which are scaled to sum to 1. Throws
  /// InvalidArgument where they are not, or where there is no such triangle.
  [[nodiscard]] SurfacePlace place(SimplexId triangle, const std::array<double, 3>& weights) const;

 private:
  friend class SurfaceEdit;

  [[nodiscard]] bool has_flat_triangle(Cell c, std::span<const Vec3> positions) const;

  CombinatorialMap map_;
  std::vector<Vec3> positions_;
};

}  // namespace dartcast
