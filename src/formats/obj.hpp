// Wavefront's .obj.
#pragma once

#include <string_view>

#include "formats/parsed_surface.hpp"

namespace dartcast {

/// Vertices (v) and faces (f) of corners v, v/vt, v/vt/vn or v//vn, which count from 1, or from -1 backwards. Names
/// of groups and objects (g, o), whichever came last, become regions. All other lines are ignored, and so are weights
/// and colours of vertices. Throws InvalidMesh with the line if the content is not right.
ParsedSurface parse_obj(std::string_view content);

}  // namespace dartcast
