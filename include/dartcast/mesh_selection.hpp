// Selection of the free cells, and of the groups of wall faces to distinguish.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

// Which cells particles may enter: by region or by an array of the file.

/// Sets mesh.free to 1 in the cells of the named regions, 0 elsewhere. A region is named by its name or by its tag in
/// digits. Throws InvalidMesh, which lists the regions that exist, if a name is none of them. Then mesh.free is
/// unchanged.
void select_free_regions(MeshData& mesh, std::span<const std::string> regions);

/// The cells of a region, by their numbers in the mesh. Throws as select_free_regions().
std::vector<std::uint32_t> cells_of_region(const MeshData& mesh, const std::string& region);

/// As select_free_regions(), by a cell array of one component: a cell is free if its value is one of `values`.
/// Throws InvalidMesh, which lists the arrays that exist, if there is no such array or it has several components. It
/// also throws if no cell has one of the values.
void select_free_values(MeshData& mesh, const std::string& array, std::span<const double> values);

// Selection of the groups of wall faces to distinguish.

/// Keeps the patch faces of the named patches and of periodic pairs, and drops the others. A patch is named by its name
/// or, if it has none, by its tag in digits. Throws InvalidMesh, which lists the patches that exist, if a name is none of
/// them. Then the mesh is unchanged.
void select_patches(MeshData& mesh, std::span<const std::string> names);

/// Makes walls of the faces of the named patches, also of those between two free cells (MeshData::baffle_tags) and of
/// those of a periodic pair, which ends. Patches are named, and errors thrown, as by select_patches().
void select_walls(MeshData& mesh, std::span<const std::string> names);

/// Divides the walls into patches at sharp edges. They replace the patches of the mesh, and its periodic pairs end. Walls
/// are the faces of free cells without a free cell behind them: those on the boundary, and those between free and blocked cells. Two walls
/// with an edge in common (in the plane: with an end) may be in one patch. For that, their normals differ by at most
/// `degrees`, and the edge belongs to these two alone. A patch is all walls that are connected in this way. The normal
/// of a warped face is that of its projected area.
///
/// Patches are named patch1, patch2, ... in the order of the first cell, by its number in the file, with a face in
/// them. If that is the same cell, the corners of the first such face decide. Precondition: check_and_repair() found
/// the mesh valid. Angles are rounded. Cost: n log n in the faces of free cells.
void divide_walls(MeshData& mesh, double degrees);

}  // namespace dartcast
