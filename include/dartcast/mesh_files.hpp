// Meshes and surfaces from and to files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/threads.hpp"

namespace dartcast {

// Any mesh file: read, repaired and judged.

struct ReadOptions {
  /// Of .vtu and .vtk: the cell array that gives the boundary cells (triangles, quadrilaterals, polygons; in the plane
  /// lines) their patches: whole numbers, where 0 is none, or texts, where an empty one is none. Empty: the array
  /// `patch`, else the one that gives the regions. Other formats have groups of their own, and refuse a name here.
  std::string patch_array;
  /// Bytes that this process may take while it reads one file and builds the map from it; 0: half of the machine's
  /// memory. What a file needs is counted from above, from the sizes that it announces, before the memory is taken
  /// (formats/read_memory.hpp); a file that may need more is refused with kind "file".
  std::uint64_t max_memory = 0;
};

struct MeshFile {
  MeshData mesh;  ///< to be used only where report.valid()
  MeshReport report;
};

/// Reads .vtu, .vtk (legacy), .msh, .msh2, .msh4 (Gmsh 1, 2 and 4) or .mesh (Medit), by ending and content, and
/// inspects it. Nothing in the file makes this throw: what cannot be read is a defect of kind "file" in the report,
/// with line or byte. Cost: a few times the file's size in memory.
MeshFile read_mesh(const std::filesystem::path& path, const ReadOptions& options = {});

/// The same, but throws InvalidMesh, with the file's name and the first defect, where the mesh is refused.
MeshFile read_valid_mesh(const std::filesystem::path& path, const ReadOptions& options = {});

// Any file of a surface in space: read, repaired and judged.

/// Whether the ending is one of those that check_surface() reads.
bool is_surface_file(const std::filesystem::path& path);

/// Reads .stl (ASCII, binary), .obj, .ply (ASCII, binary) or .off, by ending and content, and inspects it as
/// check_and_repair_surface() does. Nothing in the file makes this throw: what cannot be read is a defect of kind
/// "file" in the report, with line or byte. Points keep their order and those that no face uses are kept, so that the
/// positions of another file of the same faces can be handed to Surface::move(); of .stl see formats/stl.hpp. Of the
/// options `max_memory` counts. Cost: n log n; a few times the file's size in memory.
MeshFile check_surface(const std::filesystem::path& path, const ReadOptions& options = {});

/// The same, but throws InvalidMesh, with the file's name, the first defect and its first faces, where the surface is
/// refused: `Surface(read_surface(path).mesh)`.
MeshFile read_surface(const std::filesystem::path& path, const ReadOptions& options = {});

// Writing meshes.

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

// The whole verdict on a mesh file: `dartcast check`.

/// Reads and inspects a file; one of a surface in space as check_surface() does. Of a mesh without a defect also
/// divides every cell into simplices: a cell that has no division into positive ones, not even around a point of its
/// own, is a defect of kind "not_star_shaped". With `without_bad_cells` these, and cells that are flat or inverted, are
/// left out, and are a warning (see complex/skip_bad_cells.hpp). Throws nothing for a file's content.
MeshFile check_mesh(const std::filesystem::path& path, Threads threads = {}, const ReadOptions& options = {},
                    bool without_bad_cells = false);

}  // namespace dartcast
