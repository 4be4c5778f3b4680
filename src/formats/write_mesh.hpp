// Writing meshes.
#pragma once

#include <filesystem>
#include <string_view>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// Writes a mesh in the format of the path's ending: .vtu, .vtk (legacy), .msh or .msh2 (Gmsh 2.2 ASCII), .msh4
/// (Gmsh 4.1 ASCII), .mesh (Medit). read_mesh() reads the same cells, points bit by bit, regions and patches back. What
/// a format has no place for is left out: arrays and `free` outside VTK's formats; names of regions and patches in .vtk
/// and .mesh. The bytes go to a file beside the path, with ".part" in its name, which takes the path's place when it is
/// whole: on failure what was at the path is as it was. Preconditions: a mesh that check_and_repair() found valid.
/// Throws InvalidArgument where the ending is none of these, or where .msh or .mesh should hold polyhedra, or polygons
/// or faces of more than four corners; Error where the file cannot be written.
void write_mesh(const MeshData& mesh, const std::filesystem::path& path);

/// Writes bytes to a file. Throws Error where that fails.
void write_bytes(const std::filesystem::path& path, std::string_view bytes);

}  // namespace dartcast
