// Medit's binary .meshb (GMF).
#pragma once

#include <string_view>

#include "formats/parsed_mesh.hpp"

namespace dartcast {

/// As parse_medit(), for versions 1 to 4 of either byte order. Throws InvalidMesh with the byte.
ParsedMesh parse_meshb(std::string_view content, bool linearise = false);

}  // namespace dartcast
