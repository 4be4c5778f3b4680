// Exact answers about points and segments in a mesh: slow, independent of the library's predicates, map and walk (signs
// by CGAL's exact kernel, times as exact fractions). For tests only.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "complex/simplex.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/vec3.hpp"
#include "oracle/box_grid.hpp"
#include "oracle/triangulation.hpp"

namespace dartcast::oracle {

/// A wall triangle that a closed segment touches.
struct Touch {
  std::uint32_t wall = 0;  ///< index into triangulation().walls()
  double time = 0.0;       ///< where the segment first touches it, in [0, 1]: the exact fraction, rounded
  int rank = 0;            ///< touches at exactly equal times have equal ranks; 0 is the first
  int dimension = 0;  ///< of the mesh's cell that holds the point touched: 0 vertex, 1 edge, 2 face (fan diagonals too)
  int from = 0;       ///< where p lies: -1 on the wall's free side, 0 in its plane, 1 beyond
  int to = 0;         ///< where q lies

  [[nodiscard]] bool passes_out() const { return from < 0 && to > 0; }
  [[nodiscard]] bool ends_on() const { return from < 0 && to == 0; }
  [[nodiscard]] bool starts_outward() const { return from == 0 && to > 0; }
  [[nodiscard]] bool lies_in_plane() const { return from == 0 && to == 0; }
};

/// The walls that a segment from p to q meets.
struct Trace {
  std::vector<Touch> touches;  ///< by time
  bool leaves = false;         ///< whether it leaves the union of the closed free cells
  double exit_time = 1.0;      ///< if so, the last time until which it does not
  int exit_rank = 0;           ///< touches of a rank up to this happen until then; meaningful where it leaves
};

class Oracle {
 public:
  /// `points`: the mesh's points, then interior vertices.
  Oracle(const MeshData& mesh, std::vector<Vec3> points, const InteriorVertices& interior = {});
  explicit Oracle(const MeshData& mesh) : Oracle(mesh, mesh.points) {}

  [[nodiscard]] const Triangulation& triangulation() const { return triangulation_; }
  [[nodiscard]] const std::vector<Vec3>& points() const { return points_; }

  /// Sign of a simplex's volume.
  [[nodiscard]] int volume_sign(std::uint32_t simplex) const;
  /// Whether all simplices are positive (of free cells, or of all).
  [[nodiscard]] bool all_positive(bool free_only = false) const;

  /// Whether q lies in the closed simplex, which is positive.
  [[nodiscard]] bool contains(std::uint32_t simplex, const Vec3& q) const;
  /// Every closed simplex that contains q, of free cells or of all.
  [[nodiscard]] std::vector<std::uint32_t> all_containing(const Vec3& q, bool free_only = true) const;
  /// Dimension of the mesh's cell whose inside holds q, a point of the closed simplex: 0 vertex, 1 edge, 2 face, 3
  /// cell.
  [[nodiscard]] int dimension_at(std::uint32_t simplex, const Vec3& q) const;

  /// Where the segment from p to q is in the closed simplex: from and to which fraction of it, rounded once each; the same
  /// twice where it is not. `inside`: it does not lie in one of the facets.
  struct Passed {
    double first = 0.0;
    double last = 0.0;
    bool inside = false;
  };
  [[nodiscard]] Passed passed(std::uint32_t simplex, const Vec3& p, const Vec3& q) const;

  /// Wall triangles that contain q.
  [[nodiscard]] std::vector<std::uint32_t> walls_at(const Vec3& q) const;

  /// The walls that the closed segment touches, and whether it leaves the free cells. Precondition: p lies in a closed
  /// free cell.
  [[nodiscard]] Trace trace(const Vec3& p, const Vec3& q) const;

  /// Whether a particle at p in the closed free simplex can start towards q: in that simplex, or in one reached from it
  /// through facets that contain p and are no walls, no facet that contains p has q strictly beyond it.
  [[nodiscard]] bool can_start(std::uint32_t simplex, const Vec3& p, const Vec3& q) const;

 private:
  [[nodiscard]] int facet_sign(const Simplex& s, std::size_t opposite, const Vec3& q) const;

  Triangulation triangulation_;
  std::vector<Vec3> points_;
  BoxGrid simplex_grid_;
  BoxGrid wall_grid_;
};

}  // namespace dartcast::oracle
