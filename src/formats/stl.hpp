// Stereolithography's .stl (ASCII and binary).
#pragma once

#include <string_view>

#include "formats/parsed_surface.hpp"

namespace dartcast {

/// Corners of exactly equal coordinates (0 and -0 are equal) become one point, in the order of their first
/// appearance. Triangles with two equal corners are left out, which is a repair. Names of solids become regions.
/// Normals are ignored, because the order of the corners gives them. Throws InvalidMesh with the line, or the byte in
/// a binary file, if the content is not right. A binary file must be as long as its number of triangles says, and
/// may begin with "solid". Cost: n log n.
ParsedSurface parse_stl(std::string_view content);

}  // namespace dartcast
