// Regions and patches of a VTK grid, from its arrays at cells.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dartcast/mesh_data.hpp"
#include "formats/vtk/vtk_grid.hpp"

namespace dartcast {

/// The new places of the file's cells.
struct Places {
  std::vector<std::uint32_t> cells;  ///< per cell here: its index in the file; so for faces and edges
  std::vector<std::uint32_t> faces;
  std::vector<std::uint32_t> edges;
};

/// Sets the regions of the cells and the tags of the patch faces, with their names. `patch_array`: see
/// ReadOptions::patch_array. Returns whether the cell array `patch` is one that write_vtu() adds, so that it has no
/// data of the cells. Throws InvalidMesh, which names the arrays of the file, if the requested one cannot be used.
bool copy_tags(const VtkGrid& grid, const Places& places, const std::string& patch_array, MeshData& mesh);

}  // namespace dartcast
