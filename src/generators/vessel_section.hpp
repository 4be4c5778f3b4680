// One half of a vessel's cross-section, as a flat mesh of quads: its topology, and where the points inside go.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace dartcast {

using Point2 = std::array<double, 2>;
using QuadCorners = std::array<std::uint32_t, 4>;  ///< counterclockwise

/// The lumen of one half is a square of core x core quads in `rings` rings of quads. Its boundary has 4 core places.
/// Places 0 to `arc` lie on the vessel's outer wall, and arc to 4 core (which is 0 again) on the side that faces the
/// other half. In the trunk this is the flat side of a half disc, in a branch its inner wall. Tissue lies in `layers`
/// layers over the arc, and in `layers` columns over a line. The line runs along the flat side and, at both its ends,
/// on through the tissue of the arc. The columns lie between the halves; in the trunk they have no thickness.
class VesselSection {
 public:
  VesselSection(std::uint32_t core, std::uint32_t rings, std::uint32_t layers);

  std::uint32_t around;  ///< places on the lumen's boundary
  std::uint32_t flat;    ///< quads along the flat side
  std::uint32_t arc;     ///< quads along the outer wall
  std::uint32_t layers;
  std::uint32_t lumen_count;   ///< vertices of the lumen; they have the lowest numbers
  std::uint32_t vertex_count;  ///< all vertices

  std::vector<QuadCorners> lumen, tissue_arc, tissue_columns;
  std::vector<std::uint32_t> line;  ///< the line's vertices, from the outside over the flat side to the outside

  [[nodiscard]] std::uint32_t wall(std::uint32_t place) const { return lumen_count - around + place % around; }
  [[nodiscard]] std::uint32_t over_arc(std::uint32_t layer, std::uint32_t place) const {
    return layer == 0 ? wall(place) : lumen_count + (layer - 1) * (arc + 1) + place;
  }
  [[nodiscard]] std::uint32_t in_column(std::uint32_t column, std::uint32_t along) const {
    if (column == 0) return line[along];
    const auto length = static_cast<std::uint32_t>(line.size());
    return lumen_count + layers * (arc + 1) + (column - 1) * length + along;
  }

  /// Places of all lumen vertices for places of the boundary on a convex curve. Each inner vertex is a fixed positive
  /// average of its neighbours, so all quads come out convex, whatever the curve (W. T. Tutte, "How to draw a graph",
  /// 1963).
  [[nodiscard]] std::vector<Point2> spread(const std::vector<Point2>& boundary) const;

 private:
  void add_lumen(std::uint32_t core, std::uint32_t rings);
  void add_tissue();
  void solve_weights();

  std::vector<double> weights_;  // of the boundary places in each inner vertex, `around` per vertex
};

}  // namespace dartcast
