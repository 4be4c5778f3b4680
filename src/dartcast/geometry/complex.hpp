// The cell complex: a map with positions. It is all that a walk reads.
//
// Every cell is a union of implicit simplices with vertices as corners (map/shape.hpp), so that the complex is
// watertight for any positions (guarantee G2). A cell whose pulling triangulation is not positive takes interior
// points: extra vertices, affine combinations of its corners with stored weights, computed again at each move.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "dartcast/base/aligned.hpp"
#include "dartcast/base/parallel.hpp"
#include "dartcast/exact/vec3.hpp"
#include "dartcast/geometry/simplex.hpp"
#include "dartcast/map/map.hpp"
#include "dartcast/mesh/mesh_data.hpp"

namespace dartcast {

/// A cell with a simplex that is flat, inverted or not representable, and why.
struct InvalidCell {
  Cell cell;
  std::uint16_t simplex = 0;
  std::string message;
};

/// Vertices that are combinations of others.
struct InteriorWeights {
  std::vector<std::size_t> offsets = {0};  ///< one more than there are interior vertices
  std::vector<std::uint32_t> corner;
  std::vector<double> weight;  ///< of that corner; those of one interior vertex sum to 1

  [[nodiscard]] std::size_t count() const { return offsets.size() - 1; }
  [[nodiscard]] std::size_t bytes() const {
    return offsets.size() * sizeof(std::size_t) + corner.size() * (sizeof(std::uint32_t) + sizeof(double));
  }
};

class Complex {
 public:
  /// Builds the map, finds interior points where they are needed, and checks every simplex. Cells for which no interior
  /// point makes all simplices positive are listed in invalid_cells(); the complex can be used, particles there are
  /// held. Preconditions and errors as for Map. Cost: linear.
  explicit Complex(const MeshData& mesh, Threads threads = {});

  [[nodiscard]] const Map& map() const { return map_; }
  [[nodiscard]] Map& map() { return map_; }
  [[nodiscard]] const std::vector<InvalidCell>& invalid_cells() const { return invalid_; }

  /// Positions of the mesh's points (in the mesh's order), then of interior points.
  [[nodiscard]] std::span<const Vec3> positions() const { return front_; }
  /// Positions before the last commit_positions(); equal to positions() before the first.
  [[nodiscard]] std::span<const Vec3> previous_positions() const {
    return back_.empty() ? positions() : std::span<const Vec3>(back_);
  }
  [[nodiscard]] const InteriorWeights& interior() const { return interior_; }
  /// Number of the mesh's own points: the first entries of positions().
  [[nodiscard]] std::size_t point_count() const { return front_.size() - interior_.count(); }

  /// Where the next positions of the mesh's points are to be written, all of them; the content is what it was two moves
  /// ago. Ends the validity of previous_positions().
  [[nodiscard]] std::span<Vec3> next_positions();
  /// Makes the positions written current. Cost: a swap, and the interior points. No vertex is checked: one that is not
  /// finite, or outside the exact range, is found by the walk that meets it, and by check_validity().
  void commit_positions();

  [[nodiscard]] std::array<Vertex, 4> vertices(SimplexId s) const {
    const CellView c = map_.view(s.cell);
    const auto& local = c.shape().simplices()[s.simplex].vertex;
    return {c.vertex(local[0]), c.vertex(local[1]), c.vertex(local[2]), c.vertex(local[3])};
  }
  [[nodiscard]] Corners corners(SimplexId s) const {
    const auto v = vertices(s);
    return {front_[v[0].value], front_[v[1].value], front_[v[2].value], front_[v[3].value]};
  }

  [[nodiscard]] std::uint64_t simplex_count() const { return simplex_count_; }
  [[nodiscard]] std::size_t interior_point_count() const { return interior_.count(); }
  /// All arrays, positions counted once.
  [[nodiscard]] std::size_t bytes() const;

 private:
  Map map_;
  InteriorWeights interior_;
  AlignedVector<Vec3> front_;
  AlignedVector<Vec3> back_;  // empty until the first move
  std::vector<InvalidCell> invalid_;
  std::uint64_t simplex_count_ = 0;
};

}  // namespace dartcast
