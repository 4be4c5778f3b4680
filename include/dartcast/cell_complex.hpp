// The cell complex: a map with positions. A walk reads nothing else.
//
// Every cell is a union of implicit simplices with vertices as corners (dartcast/cell_shape.hpp). So the complex is
// watertight for any positions (guarantee G2). A cell without a positive pulling triangulation gets Steiner points:
// extra vertices that are affine combinations of its corners with stored weights. Each move computes them again.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/ids.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/storage.hpp"
#include "dartcast/threads.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

namespace detail {
class PeriodicFaces;
}

// Steiner points: vertices that are combinations of others.

/// The vertices of a complex that are combinations of others, with their weights.
class SteinerWeights {
 public:
  [[nodiscard]] std::size_t count() const { return vertex_.size() - removed_; }
  [[nodiscard]] std::size_t bytes() const;

  /// Adds a vertex. `weights`: one per corner; they sum to 1. Corners are not Steiner points themselves.
  void add(Vertex v, std::span<const std::uint32_t> corners, std::span<const double> weights);
  /// Adds all of another's.
  void add(const SteinerWeights& other);
  /// Removes a vertex; nothing happens if it is not a Steiner point. The first call lists the vertices, once. After
  /// that the cost is constant on average.
  void remove(Vertex v);
  /// The corners of a Steiner point, and their weights. Empty if the vertex is none. The first call lists the
  /// vertices, once. After that the cost is constant on average. The spans are valid until a vertex is added.
  [[nodiscard]] std::pair<std::span<const std::uint32_t>, std::span<const double>> of(Vertex v);
  /// Writes the positions of the vertices, in a fixed order of operations. `positions`: of all vertices.
  void compute(std::span<Vec3> positions) const;

 private:
  void close_gaps();
  void list_places();

  std::vector<Vertex> vertex_;              // invalid: removed
  std::vector<std::size_t> offsets_ = {0};  // one more than vertices
  std::vector<std::uint32_t> corner_;
  std::vector<double> weight_;
  std::size_t removed_ = 0;
  std::unordered_map<std::uint32_t, std::size_t> place_;  // of a vertex; empty until one is asked for
};

/// A cell with a simplex that is flat, inverted or not representable, and why.
struct InvalidCell {
  Cell cell;
  std::uint16_t simplex = 0;
  std::string message;
};

/// A triangle of the plane as a tetrahedron: the fourth corner is one above the first. Its volume is a third of the
/// triangle's area. Signs of a point of the plane against the first three facets are the same as in the plane.
inline Corners raised(const Corners& v) {
  const auto flat = [](const Vec3& p) { return Vec3{p.x, p.y, 0.0}; };
  return {flat(v[0]), flat(v[1]), flat(v[2]), Vec3{v[0].x, v[0].y, 1.0}};
}

/// A combinatorial map with the positions of its vertices, now and at the start of the current move.
class CellComplex {
 public:
  /// Builds the map, finds Steiner points if cells need them, and checks every simplex. Cells that no Steiner point
  /// makes positive are listed in invalid_cells(). The complex can still be used; particles in these cells are held.
  /// Preconditions and errors as for CombinatorialMap. Throws InvalidMesh if a face of a periodic pair has no partner;
  /// it says where the face is. Cost: linear.
  explicit CellComplex(const MeshData& mesh, Threads threads = {});

  [[nodiscard]] const CombinatorialMap& map() const { return map_; }
  [[nodiscard]] CombinatorialMap& map() { return map_; }
  [[nodiscard]] const std::vector<InvalidCell>& invalid_cells() const { return invalid_; }
  /// The faces of the mesh's periodic pairs, and their partners; null if there are none.
  [[nodiscard]] const detail::PeriodicFaces* periodic() const { return periodic_.get(); }

  /// Positions of all vertices: the mesh's points (in the mesh's order), then Steiner points, then vertices that edits
  /// made. Edits may also use the numbers of removed vertices again.
  [[nodiscard]] std::span<const Vec3> positions() const { return front_; }
  /// Positions before the last commit_positions(); equal to positions() before the first.
  [[nodiscard]] std::span<const Vec3> previous_positions() const {
    return back_.empty() ? positions() : std::span<const Vec3>(back_);
  }
  [[nodiscard]] const SteinerWeights& steiner_weights() const { return steiner_; }
  /// How many first entries of positions() a move gives: the mesh's own points, and after edits everything up to the
  /// last vertex made. Steiner points and unused numbers among them can be given any value.
  [[nodiscard]] std::size_t point_count() const { return point_count_; }

  /// The array for the next positions of these points. The caller must write all of them; the content is that of two
  /// moves ago. Ends the validity of previous_positions().
  [[nodiscard]] std::span<Vec3> next_positions();
  /// Makes the written positions current. Cost: a swap, and the Steiner points. No vertex is checked. A vertex that is
  /// not finite, or above 2^300 in magnitude, is found by the walk that meets it, and by check_validity().
  void commit_positions();
  /// A copy with previous_positions() as its positions: with all edits, but without the last move. Cost: linear.
  [[nodiscard]] CellComplex before_move() const;

  /// The vertices of a simplex. In the plane the fourth vertex repeats the third, and the fourth corner is one above
  /// the first (raised()).
  [[nodiscard]] std::array<Vertex, 4> vertices(SimplexId s) const {
    const CellView c = map_.view(s.cell);
    const auto& local = c.shape().simplices()[s.simplex].vertex;
    return {c.vertex(local[0]), c.vertex(local[1]), c.vertex(local[2]), c.vertex(local[3])};
  }
  [[nodiscard]] Corners corners(SimplexId s) const { return corners(s, front_); }
  [[nodiscard]] Corners previous_corners(SimplexId s) const { return corners(s, previous_positions()); }

  [[nodiscard]] std::uint64_t simplex_count() const { return simplex_count_; }
  [[nodiscard]] std::size_t steiner_point_count() const { return steiner_.count(); }
  /// Size of all arrays, with positions counted once.
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
  std::shared_ptr<const detail::PeriodicFaces> periodic_;
};

// A complex as a mesh again: for output, and to continue elsewhere.

/// The current cells, pool by pool, with their free marks and their `source` as in the map. Points: the vertices that
/// they use, at their positions, without Steiner points. There are no regions, patches or data. `vertices`: unless
/// null, it receives the vertex of each point. Cost: linear.
MeshData to_mesh(const CellComplex& complex, std::vector<Vertex>* vertices = nullptr);

}  // namespace dartcast
