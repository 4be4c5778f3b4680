// What VTK does for us, as one table of functions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "dartcast/mesh_files.hpp"
#include "dartcast/vec3.hpp"
#include "formats/parsed_mesh.hpp"
#include "formats/point_file.hpp"

namespace dartcast {

/// The points of a .vtu file alone, for a series of files with the same cells.
struct VtuPoints {
  std::vector<Vec3> points;  ///< all of the file, as it has them
  std::uint64_t cells;       ///< a hash of the arrays of its cells
};

struct VtkFunctions {
  ParsedMesh (*read_vtu)(const std::filesystem::path& path, std::string_view content, const ReadOptions& options);
  ParsedMesh (*read_legacy)(const std::filesystem::path& path, std::string_view content, const ReadOptions& options);
  void (*write_legacy)(const MeshData& mesh, const std::filesystem::path& file);
  PointFile (*read_vtp)(const std::filesystem::path& path, const ReadOptions& options);
  std::optional<VtuPoints> (*read_vtu_points)(std::string_view content, std::uint64_t max_memory);
};

extern const VtkFunctions vtk_functions;

}  // namespace dartcast
