// Any mesh file: read, repaired and judged.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "dartcast/mesh_data.hpp"
#include "mesh/mesh_report.hpp"

namespace dartcast {

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

}  // namespace dartcast
