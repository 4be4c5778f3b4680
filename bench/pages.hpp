// Measurements as pages in the style of reports (docs/report.md): charts, and the tables as text.
#pragma once

#include <span>
#include <string>

#include "bench/comparison.hpp"
#include "bench/latency.hpp"

namespace dartcast::bench {

/// Time against the size of the scene (the paper's figure 23), the length of a step and the faces of a cell.
std::string comparison_page(std::span<const Row> rows);
/// The time of each step.
std::string latency_page(const Latency& latency);

}  // namespace dartcast::bench
