// VTK's unstructured grids: .vtu and legacy .vtk.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "dartcast/mesh_files.hpp"
#include "formats/parsed_mesh.hpp"

namespace dartcast {

/// Cells of three dimensions become cells: voxels as hexahedra, prisms from VTK's order of corners, which is the
/// mirror of MeshData's. All their arrays of numbers are kept. The first array of whole numbers among `region`,
/// `gmsh:physical` and `medit:ref` gives the regions. Triangles, quadrangles and polygons become patch faces by the
/// cell array options.patch_array. Where that is empty, the array `patch` counts, else the array of the regions
/// (ReadOptions). Names come from arrays of texts, or from the field arrays `region_names` and `patch_names` of
/// write_vtu(). In a file without cells of three dimensions those of two are the cells, and lines of two points
/// (poly-lines piece by piece) the faces that patches are made of; points, and otherwise lines, are left out.
/// `content` is the content of the file. It is checked first, then VTK reads the file. Throws InvalidMesh.
ParsedMesh parse_vtu(const std::filesystem::path& path, std::string_view content, const ReadOptions& options = {});
ParsedMesh parse_legacy_vtk(const std::filesystem::path& path, std::string_view content,
                            const ReadOptions& options = {});

/// Writes legacy .vtk (binary) so that parse_legacy_vtk() finds the same bits, without the names of regions and patches.
/// Cell arrays as write_vtu() writes them. Throws Error where the file cannot be written.
void write_legacy_vtk(const MeshData& mesh, const std::filesystem::path& path);

}  // namespace dartcast
