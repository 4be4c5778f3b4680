// Stanford's .ply (ASCII, binary of either byte order).
#pragma once

#include <string_view>

#include "formats/parsed_surface.hpp"

namespace dartcast {

/// Elements vertex (x, y, z of any type) and face (a list vertex_indices or vertex_index of any type of whole
/// numbers). Other elements and properties are ignored. Throws InvalidMesh with the line, or the byte in binary
/// parts, if the content is not right.
ParsedSurface parse_ply(std::string_view content);

}  // namespace dartcast
