// Medit's .mesh (ASCII) and .meshb (binary, GMF).
#pragma once

#include <string>
#include <string_view>

#include "formats/parsed_mesh.hpp"

namespace dartcast {

/// References of volume cells become regions, those of triangles and quadrilaterals patches (0: none). In a file
/// without volume cells, those of triangles and quadrilaterals become regions, those of edges patches. Throws
/// InvalidMesh with the line if the content is not right, or with the name of another format.
ParsedMesh parse_medit(std::string_view content, bool linearise = false);

/// As parse_medit(), for versions 1 to 4 of either byte order. Throws InvalidMesh with the byte.
ParsedMesh parse_meshb(std::string_view content, bool linearise = false);

/// The mesh in Medit's format, of dimension 2 in the plane. Every coordinate has the digits that it needs to be read
/// back exactly. Regions and patches become references. Precondition: no polyhedra, and no polygons or faces of more
/// than four corners.
std::string format_medit(const MeshData& mesh);

}  // namespace dartcast
