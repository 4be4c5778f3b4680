// The answer of `dartcast check`, as JSON and as text.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

#include "dartcast/mesh_check.hpp"

namespace dartcast {

/// One JSON object with the report, `dimension`, `parts` and `verdict` besides; UTF-8, invalid bytes
/// replaced.
std::string report_json(const MeshReport& report);

/// The same for people, in a few lines that end with the verdict.
std::string report_text(const MeshReport& report);

/// A line about a periodic pair: its patches, its faces unless there are none, and its motion.
std::string pair_text(const PeriodicPair& pair, std::size_t faces = 0);
nlohmann::ordered_json pair_json(const PeriodicPair& pair);

}  // namespace dartcast
