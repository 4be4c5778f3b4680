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
#include <vector>

#include "base/aligned.hpp"
#include "base/parallel.hpp"
#include "complex/simplex.hpp"
#include "complex/steiner_weights.hpp"
#include "dartcast/combinatorial_map.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

/// A cell with a simplex that is flat, inverted or not representable, and why.
struct InvalidCell {
  Cell cell;
  std::uint16_t simplex = 0;
  std::string message;
};

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

}  // namespace dartcast
