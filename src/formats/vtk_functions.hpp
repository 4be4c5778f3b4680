// The functions that VTK gives us, as one table.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
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

/// A surface in a .vtp file.
struct VtpFaces {
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
  std::vector<std::size_t> rows;    ///< per face: its number among all cells of the file
  std::vector<std::string> groups;  ///< per face: its value of the array patch, region or ModelFaceID; or empty
  std::vector<double> ids;          ///< per point: GlobalNodeID; or empty
};

/// In a build without VTK all are null. formats/vtk has the functions, and says what they do.
struct VtkFunctions {
  ParsedMesh (*read_vtu)(const std::filesystem::path& path, std::string_view content, const ReadOptions& options);
  ParsedMesh (*read_legacy)(const std::filesystem::path& path, std::string_view content, const ReadOptions& options);
  void (*write_legacy)(const MeshData& mesh, const std::filesystem::path& file);
  PointFile (*read_vtp)(const std::filesystem::path& path, const ReadOptions& options);
  std::optional<VtuPoints> (*read_vtu_points)(std::string_view content, std::uint64_t max_memory);
  VtpFaces (*read_vtp_faces)(std::string_view content, std::uint64_t max_memory);
};

extern const VtkFunctions vtk_functions;

/// Why a build without VTK cannot do a task, as "read .vtu files", and what else helps.
std::string needs_vtk(std::string_view task, std::string_view remedy);

}  // namespace dartcast
