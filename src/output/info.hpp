// Counts, bounds, shapes and memory of a mesh in use: `dartcast info`.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/parallel.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// A point or cell array of a mesh. Ranges are of its finite values, per component; empty if there is none.
struct ArrayInfo {
  std::string name;
  std::size_t components = 1;
  std::vector<std::array<double, 2>> ranges;
  std::size_t not_finite = 0;  ///< values that are no finite numbers
};

/// Where a patch lies.
struct PatchPlace {
  double size = 0.0;  ///< area of its wall faces; in the plane their length
  Vec3 centre;        ///< of that area
};

/// A periodic pair, and how many pairs of faces lead from one to the other.
struct PeriodicInfo {
  PeriodicPair pair;
  std::size_t faces = 0;
};

struct MeshInfo {
  std::string name;
  unsigned dimension = 3;
  std::size_t points = 0;
  std::map<std::string, std::size_t> cells;    ///< by type
  std::map<std::string, std::size_t> regions;  ///< by name, or tag
  std::map<std::string, std::size_t> patches;  ///< wall faces by patch, if there is one; in the plane all edges
  std::map<std::string, PatchPlace> patch_places;
  std::size_t free_cells = 0;
  std::size_t wall_faces = 0;
  std::vector<PeriodicInfo> periodic;
  std::size_t inner_walls = 0;  ///< of these, pairs with a cell on both sides (inner_walls())
  std::size_t shapes = 0;       ///< kinds of cell that the map distinguishes
  std::uint64_t simplices = 0;
  std::size_t steiner_points = 0;  ///< added if a cell needs one
  Vec3 low, high;                  ///< of the points
  double smallest_edge = 0.0;      ///< of the cells
  double mean_edge = 0.0;          ///< an edge counts once for each of its cells
  std::size_t bytes = 0;           ///< of the map, its positions and tables
  std::vector<ArrayInfo> point_arrays;
  std::vector<ArrayInfo> cell_arrays;
  std::vector<Finding> warnings;  ///< LoadedScene::warnings

  [[nodiscard]] std::size_t cell_count() const;
};

/// Precondition: check_and_repair() found the mesh valid. Builds the complex of a mesh of space. Throws InvalidMesh
/// if that is not possible.
MeshInfo mesh_info(const MeshData& mesh, std::string name, Threads threads = {});

std::string info_json(const MeshInfo& info);
std::string info_text(const MeshInfo& info);

}  // namespace dartcast
