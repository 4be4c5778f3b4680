// Geomview's .off (ASCII).
#pragma once

#include <string_view>

#include "formats/parsed_surface.hpp"

namespace dartcast {

/// The word OFF, also as COFF, NOFF, STOFF and so on, may be missing, and so may the number of edges. One vertex or
/// face a line: what follows its numbers there (colours, normals) is passed over. Throws InvalidMesh with the line
/// where the content is not right.
ParsedSurface parse_off(std::string_view content);

}  // namespace dartcast
