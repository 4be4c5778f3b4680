// TetGen's .node and .ele (and .face), and Triangle's.
#pragma once

#include <filesystem>
#include <string_view>

#include "dartcast/mesh_files.hpp"
#include "formats/parsed_mesh.hpp"

namespace dartcast {

/// The mesh of BASE.node and BASE.ele, whichever of them `path` names; `content` is that of the one that it names. Points
/// count from 0 or from 1, as the first one in .node does. The last attribute of a tetrahedron is its region, if it is
/// a whole number. If there is BASE.face, its markers are patches (0: none). Throws InvalidMesh with file and line.
ParsedMesh parse_tetgen(const std::filesystem::path& path, std::string_view content, const ReadOptions& options);

}  // namespace dartcast
