// VTK's formats: unstructured grids in .vtu and legacy .vtk, points and faces in .vtp. formats/vtk has the readers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dartcast/mesh_files.hpp"
#include "dartcast/vec3.hpp"
#include "formats/parsed_mesh.hpp"
#include "formats/point_file.hpp"

namespace dartcast {

/// Cells of three dimensions become cells: voxels as hexahedra, prisms from VTK's order of corners, which is the mirror
/// of MeshData's. All their arrays of numbers are kept. The first array of whole numbers among `region`,
/// `gmsh:physical` and `medit:ref` gives the regions. Triangles, quadrangles and polygons become patch faces by the
/// cell array options.patch_array. If that is empty, the array `patch` counts, else the array of the regions
/// (ReadOptions). Names come from arrays of texts, or from the field arrays `region_names` and `patch_names` of
/// write_vtu(). In a file without cells of three dimensions those of two are the cells. Lines of two points (poly-lines
/// piece by piece) are then the faces that patches are made of. Points, and otherwise lines, are left out. The cell
/// array `free` says which cells are free if the field array free_writer of write_vtu() stands in the file. `content`
/// is the content of the file, and the path is not used. Throws InvalidMesh.
ParsedMesh parse_vtu(const std::filesystem::path& path, std::string_view content, const ReadOptions& options = {});
/// The same of files that are pieces of one mesh, and of a file of several pieces. Their points are joined if they have
/// one place. Cells are left out if their array `vtkGhostType` is not 0.
ParsedMesh parse_vtu_pieces(std::span<const std::filesystem::path> pieces, const ReadOptions& options);
ParsedMesh parse_legacy_vtk(const std::filesystem::path& path, std::string_view content,
                            const ReadOptions& options = {});

/// Writes legacy .vtk (5.1, binary) so that parse_legacy_vtk() finds the same bits. Cell arrays and texts as write_vtu()
/// writes them. Throws Error if the file cannot be written.
void write_legacy_vtk(const MeshData& mesh, const std::filesystem::path& path);

/// The points of a .vtu file alone, for a series of files with the same cells.
struct VtuPoints {
  std::vector<Vec3> points;  ///< all of the file, as it has them
  std::uint64_t cells;       ///< a hash of its cells
};

/// Decodes no arrays at points and cells. Throws InvalidMesh.
VtuPoints read_vtu_points(std::string_view content, std::uint64_t max_memory);

/// The points of a .vtp file and their numeric arrays. Throws InvalidMesh.
PointFile read_vtp_points(std::string_view content, std::uint64_t max_memory);

/// A surface in a .vtp file.
struct VtpFaces {
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
  std::vector<std::string> groups;  ///< per face: its value of the array patch, region or ModelFaceID; or empty
  std::vector<double> ids;          ///< per point: GlobalNodeID; or empty
};

/// Throws InvalidMesh.
VtpFaces read_vtp_faces(std::string_view content, std::uint64_t max_memory);

}  // namespace dartcast
