// The cell complex: a map with positions. It is all that a walk reads.
//
// Every cell is a union of implicit simplices with vertices as corners (dartcast/cell_shape.hpp), so that the complex
// is watertight for any positions (guarantee G2). A cell whose pulling triangulation is not positive takes interior
// points: extra vertices, affine combinations of its corners with stored weights, computed again at each move.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/ids.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/storage.hpp"
#include "dartcast/threads.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

// Interior points: vertices that are combinations of others.

class SteinerWeights {
 public:
  [[nodiscard]] std::size_t count() const { return vertex_.size() - removed_; }
  [[nodiscard]] std::size_t bytes() const;

  /// A further vertex. `weights`: one per corner; they sum to 1. Corners are no interior points.
  void add(Vertex v, std::span<const std::uint32_t> corners, std::span<const double> weights);
  /// Adds all of another's.
  void add(const SteinerWeights& other);
  /// Forgets a vertex; nothing happens where it is no interior point. The first call lists the vertices, once; after
  /// that the cost is constant on average.
  void remove(Vertex v);
  /// Writes where the vertices are, in a fixed order of operations. `positions`: of all vertices.
  void compute(std::span<Vec3> positions) const;

 private:
  void close_gaps();

  std::vector<Vertex> vertex_;              // invalid: removed
  std::vector<std::size_t> offsets_ = {0};  // one more than vertices
  std::vector<std::uint32_t> corner_;
  std::vector<double> weight_;
  std::size_t removed_ = 0;
  std::unordered_map<std::uint32_t, std::size_t> place_;  // of a vertex; empty until one is removed
};

/// A cell with a simplex that is flat, inverted or not representable, and why.
struct InvalidCell {
  Cell cell;
  std::uint16_t simplex = 0;
  std::string message;
};

/// A triangle of the plane as a tetrahedron: the fourth corner is one above the first. Its volume is a third of the
/// triangle's area, and what is asked of a point of the plane, and of the first three facets, has the same answer.
inline Corners raised(const Corners& v) {
  const auto flat = [](const Vec3& p) { return Vec3{p.x, p.y, 0.0}; };
  return {flat(v[0]), flat(v[1]), flat(v[2]), Vec3{v[0].x, v[0].y, 1.0}};
}

class CellComplex {
 public:
  /// Builds the map, finds interior points where they are needed, and checks every simplex. Cells for which no interior
  /// point makes all simplices positive are listed in invalid_cells(); the complex can be used, particles there are
  /// held. Preconditions and errors as for Map. Cost: linear.
  explicit CellComplex(const MeshData& mesh, Threads threads = {});

  [[nodiscard]] const CombinatorialMap& map() const { return map_; }
  [[nodiscard]] CombinatorialMap& map() { return map_; }
  [[nodiscard]] const std::vector<InvalidCell>& invalid_cells() const { return invalid_; }

  /// Positions of all vertices: the mesh's points (in the mesh's order), then interior points, then what edits made
  /// (their numbers, too, may be those of vertices that are gone).
  [[nodiscard]] std::span<const Vec3> positions() const { return front_; }
  /// Positions before the last commit_positions(); equal to positions() before the first.
  [[nodiscard]] std::span<const Vec3> previous_positions() const {
    return back_.empty() ? positions() : std::span<const Vec3>(back_);
  }
  [[nodiscard]] const SteinerWeights& steiner_weights() const { return steiner_; }
  /// Number of the first entries of positions() that a move gives: the mesh's own points, and once edits have made
  /// vertices, everything up to the last of these. What lies between, interior points and numbers not in use, can be
  /// given any value.
  [[nodiscard]] std::size_t point_count() const { return point_count_; }

  /// Where the next positions of these points are to be written, all of them; the content is what it was two moves
  /// ago. Ends the validity of previous_positions().
  [[nodiscard]] std::span<Vec3> next_positions();
  /// Makes the positions written current. Cost: a swap, and the interior points. No vertex is checked: one that is not
  /// finite, or above 2^300 in magnitude, is found by the walk that meets it, and by check_validity().
  void commit_positions();
  /// A copy with previous_positions() as its positions: with edits made since, but as if it had not moved. Cost:
  /// linear.
  [[nodiscard]] CellComplex before_move() const;

  /// In the plane the fourth is the third again, and the fourth corner is one above the first (raised()).
  [[nodiscard]] std::array<Vertex, 4> vertices(SimplexId s) const {
    const CellView c = map_.view(s.cell);
    const auto& local = c.shape().simplices()[s.simplex].vertex;
    return {c.vertex(local[0]), c.vertex(local[1]), c.vertex(local[2]), c.vertex(local[3])};
  }
  [[nodiscard]] Corners corners(SimplexId s) const { return corners(s, front_); }
  [[nodiscard]] Corners previous_corners(SimplexId s) const { return corners(s, previous_positions()); }

  [[nodiscard]] std::uint64_t simplex_count() const { return simplex_count_; }
  [[nodiscard]] std::size_t steiner_point_count() const { return steiner_.count(); }
  /// All arrays, positions counted once.
  [[nodiscard]] std::size_t bytes() const;

 private:
  friend class ComplexEdit;

  [[nodiscard]] Corners corners(SimplexId s, std::span<const Vec3> positions) const {
    const auto v = vertices(s);
    const Corners corners = {positions[v[0].value], positions[v[1].value], positions[v[2].value],
                             positions[v[3].value]};
    return map_.dimension() == 2 ? raised(corners) : corners;
  }

  CombinatorialMap map_;
  SteinerWeights steiner_;
  std::size_t point_count_ = 0;
  AlignedVector<Vec3> front_;
  AlignedVector<Vec3> back_;  // empty until the first move
  std::vector<InvalidCell> invalid_;
  std::uint64_t simplex_count_ = 0;
};

// A complex as a mesh again: for output, and to go on with elsewhere.

/// The cells as they are now, pool by pool, with their free marks and `source` as in the map; points: the vertices that
/// they use, at their positions, without interior points. No regions, patches or data. `vertices`: unless null, takes
/// the vertex of each point. Cost: linear.
MeshData to_mesh(const CellComplex& complex, std::vector<Vertex>* vertices = nullptr);

}  // namespace dartcast
