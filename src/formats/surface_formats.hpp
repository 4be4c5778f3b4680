// Readers of surfaces: Wavefront's .obj, Geomview's .off (ASCII), Stanford's .ply (ASCII, or binary of either byte
// order) and stereolithography's .stl (ASCII or binary).
#pragma once

#include <string_view>

#include "formats/parsed_surface.hpp"

namespace dartcast {

/// Vertices (v) and faces (f) of corners v, v/vt, v/vt/vn or v//vn, which count from 1, or from -1 backwards. Names
/// of groups and objects (g, o), whichever came last, become regions. All other lines are ignored, and so are weights
/// and colours of vertices. Throws InvalidMesh with the line if the content is not right.
ParsedSurface parse_obj(std::string_view content);

/// The word OFF, also as COFF, NOFF, STOFF and so on, may be missing, and so may the number of edges. A line has one
/// vertex or face. The rest of it (colours, normals) is ignored. Throws InvalidMesh with the line if the content
/// is not right.
ParsedSurface parse_off(std::string_view content);

/// Elements vertex (x, y, z of any type) and face (a list vertex_indices or vertex_index of any type of whole
/// numbers). Other elements and properties are ignored. Throws InvalidMesh with the line, or the byte in binary
/// parts, if the content is not right.
ParsedSurface parse_ply(std::string_view content);

/// Corners of exactly equal coordinates (0 and -0 are equal) become one point, in the order of their first
/// appearance. Triangles with two equal corners are left out as a repair. Names of solids become regions.
/// Normals are ignored, because the order of the corners gives them. Throws InvalidMesh with the line, or the byte in
/// a binary file, if the content is not right. A binary file must be as long as its number of triangles says, and
/// may begin with "solid". Cost: n log n.
ParsedSurface parse_stl(std::string_view content);

}  // namespace dartcast
