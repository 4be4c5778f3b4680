// Geomview's .off (ASCII).
#pragma once

#include <string_view>

#include "formats/parsed_surface.hpp"

namespace dartcast {

/// The word OFF, also as COFF, NOFF, STOFF and so on, may be missing, and so may the number of edges. A line has one
/// vertex or face. The rest of it (colours, normals) is ignored. Throws InvalidMesh with the line if the content
/// is not right.
ParsedSurface parse_off(std::string_view content);

}  // namespace dartcast
