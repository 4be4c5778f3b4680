// How large a mesh and its cells are. Not installed.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "base/exact_sum.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/threads.hpp"

namespace dartcast {

/// The places of all corners of cells, and the lengths of all edges: an edge counts once for each of its cells. Those of the
/// parts of a mesh add up, in any order, to those of the whole, to the last bit.
struct MeshScale {
  static constexpr double none = std::numeric_limits<double>::infinity();
  Vec3 low = {none, none, none};
  Vec3 high = {-none, -none, -none};
  double smallest_edge = none;
  ExactSum edges;
  std::uint64_t edge_count = 0;

  MeshScale& operator+=(const MeshScale& other);
  [[nodiscard]] double mean_edge() const {
    return edge_count == 0 ? 0.0 : edges.value() / static_cast<double>(edge_count);
  }
  /// The longest side of the box around it; 0 if there is no cell.
  [[nodiscard]] double size() const;
};

/// Measures the cells that `parts` gives the number `part`; all if it is empty. Precondition: well-formed connectivity.
MeshScale mesh_scale(const MeshData& mesh, Threads threads = {}, std::span<const std::uint32_t> parts = {},
                     std::uint32_t part = 0);

/// Multiplies all lengths of a mesh: its points, and the ways of its periodic pairs.
void scale_mesh(MeshData& mesh, double factor);

}  // namespace dartcast
