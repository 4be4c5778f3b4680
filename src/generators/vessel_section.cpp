// Half of a vessel's cross-section: its quads, and the places of its inner points.
#include "generators/vessel_section.hpp"

#include <cmath>

namespace dartcast {

VesselSection::VesselSection(std::uint32_t core, std::uint32_t rings, std::uint32_t tissue_layers)
    : around(4 * core), layers(tissue_layers) {
  // A half disc's flat side is 39% of its boundary. As many more than core, and even, so that both sides of the square
  // are alike.
  flat = core + 2 * static_cast<std::uint32_t>(std::lround(0.28 * core));
  arc = around - flat;
  lumen_count = (core + 1) * (core + 1) + rings * around;
  vertex_count = lumen_count + layers * (arc + 1) + layers * (flat + 2 * layers + 1);
  add_lumen(core, rings);
  add_tissue();
  solve_weights();
}

void VesselSection::add_lumen(std::uint32_t core, std::uint32_t rings) {
  const auto in_core = [&](std::uint32_t i, std::uint32_t j) { return j * (core + 1) + i; };
  for (std::uint32_t j = 0; j < core; ++j) {
    for (std::uint32_t i = 0; i < core; ++i) {
      lumen.push_back({in_core(i, j), in_core(i + 1, j), in_core(i + 1, j + 1), in_core(i, j + 1)});
    }
  }
  std::vector<std::uint32_t> perimeter;
  for (std::uint32_t i = 0; i < core; ++i) perimeter.push_back(in_core(i, 0));
  for (std::uint32_t i = 0; i < core; ++i) perimeter.push_back(in_core(core, i));
  for (std::uint32_t i = 0; i < core; ++i) perimeter.push_back(in_core(core - i, core));
  for (std::uint32_t i = 0; i < core; ++i) perimeter.push_back(in_core(0, core - i));

  // Turned so that the middle of the flat side looks at the middle of the square's left side.
  const std::uint32_t turn = (flat - core) / 2;
  const auto in_ring = [&](std::uint32_t ring, std::uint32_t place) {
    if (ring == 0) return perimeter[(place + turn) % around];
    return (core + 1) * (core + 1) + (ring - 1) * around + place % around;
  };
  for (std::uint32_t r = 0; r < rings; ++r) {
    for (std::uint32_t b = 0; b < around; ++b) {
      lumen.push_back({in_ring(r, b), in_ring(r + 1, b), in_ring(r + 1, b + 1), in_ring(r, b + 1)});
    }
  }
}

void VesselSection::add_tissue() {
  for (std::uint32_t l = layers; l > 0; --l) line.push_back(over_arc(l, arc));
  for (std::uint32_t b = arc; b <= around; ++b) line.push_back(wall(b));
  for (std::uint32_t l = 1; l <= layers; ++l) line.push_back(over_arc(l, 0));

  for (std::uint32_t l = 0; l < layers; ++l) {
    for (std::uint32_t k = 0; k < arc; ++k) {
      tissue_arc.push_back({over_arc(l, k), over_arc(l + 1, k), over_arc(l + 1, k + 1), over_arc(l, k + 1)});
    }
    for (std::uint32_t j = 0; j + 1 < line.size(); ++j) {
      tissue_columns.push_back({in_column(l, j), in_column(l + 1, j), in_column(l + 1, j + 1), in_column(l, j + 1)});
    }
  }
}

void VesselSection::solve_weights() {
  const std::uint32_t inner = lumen_count - around;
  std::vector<std::vector<std::uint32_t>> neighbours(inner);
  for (const QuadCorners& q : lumen) {
    // Each inner edge is met once in each direction, by the quads on its two sides.
    for (std::size_t i = 0; i < 4; ++i) {
      if (q[i] < inner) neighbours[q[i]].push_back(q[(i + 1) % 4]);
    }
  }
  weights_.assign(std::size_t{lumen_count} * around, 0.0);
  for (std::uint32_t b = 0; b < around; ++b) weights_[std::size_t{wall(b)} * around + b] = 1.0;
  for (std::uint32_t sweep = 0; sweep < 40 * around;
       ++sweep) {  // Gauss-Seidel, far past the last digit that a mesh needs
    for (std::uint32_t v = 0; v < inner; ++v) {
      for (std::uint32_t b = 0; b < around; ++b) {
        double sum = 0.0;
        for (const std::uint32_t n : neighbours[v]) sum += weights_[std::size_t{n} * around + b];
        weights_[std::size_t{v} * around + b] = sum / static_cast<double>(neighbours[v].size());
      }
    }
  }
}

std::vector<Point2> VesselSection::spread(const std::vector<Point2>& boundary) const {
  std::vector<Point2> places(lumen_count, Point2{0.0, 0.0});
  for (std::uint32_t v = 0; v < lumen_count; ++v) {
    for (std::uint32_t b = 0; b < around; ++b) {
      const double w = weights_[std::size_t{v} * around + b];
      places[v][0] += w * boundary[b][0];
      places[v][1] += w * boundary[b][1];
    }
  }
  return places;
}

}  // namespace dartcast
