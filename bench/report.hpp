// Rows in words and numbers: a table for people, JSON, CSV.
#pragma once

#include <span>
#include <string>

#include "bench/comparison.hpp"

namespace dartcast::bench {

/// The properties that distinguish a row from others of its name: "10^5 cells, deforming, 1,000 particles".
std::string title(const WorkloadOptions& workload);

/// ns per particle-step and how many times dartcast's each competitor takes; then the longest steps, disagreements and
/// orientation tests; then growth with the scene and what the rows say of each other.
std::string report_text(std::span<const Row> rows);

/// One object with "rows", an object per row. Values that a row does not have are left out.
std::string report_json(std::span<const Row> rows);

/// A line per row and competitor.
std::string report_csv(std::span<const Row> rows);

}  // namespace dartcast::bench
