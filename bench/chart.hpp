// A picture like the paper's figure 23: time against the size of the scene.
#pragma once

#include <span>
#include <string>

#include "bench/comparison.hpp"

namespace dartcast::bench {

/// W1 (solid) and W2 (dashed) with 1,000 particles, a line per competitor, both axes logarithmic, as SVG. Without such
/// rows: the empty axes.
std::string chart_svg(std::span<const Row> rows);
/// The same of W6: standing still (solid) and moving (dashed).
std::string plane_chart_svg(std::span<const Row> rows);

}  // namespace dartcast::bench
