// Gmsh's .msh: versions 1, 2.0 to 2.2, 4.0 and 4.1 (with sizes of 8 or 4 bytes), ASCII and binary of either byte order.
#pragma once

#include <string>
#include <string_view>

#include "formats/parsed_mesh.hpp"

namespace dartcast {

/// Physical groups of volumes become regions, those of surfaces patches, with their names; in a file without volumes
/// those of surfaces and curves. An element in several groups goes to the first; points are left out. Throws
/// InvalidMesh with the line (or byte) if the content is not right, or with the name of another format.
ParsedMesh parse_gmsh(std::string_view content, bool linearise = false);

/// The mesh in version 2.2 or 4.1, ASCII, every coordinate with the digits it needs to be read back exactly. Regions
/// and patches become physical groups. Precondition: no polyhedra, and no polygons or faces of more than four corners.
std::string format_gmsh_2(const MeshData& mesh);
std::string format_gmsh_4(const MeshData& mesh);

}  // namespace dartcast
