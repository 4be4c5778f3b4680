// The answer of `dartcast check`, as JSON and as text.
#pragma once

#include <string>

#include "dartcast/mesh_check.hpp"

namespace dartcast {

/// One JSON object with the report, `dimension`, `parts` and `verdict` besides; UTF-8, invalid bytes
/// replaced.
std::string report_json(const MeshReport& report);

/// The same for people, in a few lines that end with the verdict.
std::string report_text(const MeshReport& report);

}  // namespace dartcast
