// Which cells are free, and which groups of wall faces are told apart.
#pragma once

#include <span>
#include <string>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

// Which cells particles may enter: by region or by an array of the file.

/// Sets mesh.free to 1 in the cells of the regions named, 0 elsewhere. A region goes by its name or by its tag in
/// digits. Throws InvalidMesh, naming the regions there are, where a name is none of them; mesh.free is unchanged then.
void select_free_regions(MeshData& mesh, std::span<const std::string> regions);

/// The same by a cell array of one component: free where its value is one of `values`.
/// Throws InvalidMesh, naming the arrays there are, where there is no such array or it has several components, or where
/// no cell has one of the values.
void select_free_values(MeshData& mesh, const std::string& array, std::span<const double> values);

// Which groups of wall faces are told apart.

/// Keeps the patch faces of the patches named, and drops the others. A patch goes by its name or, where it has none, by
/// its tag in digits. Throws InvalidMesh, naming the patches there are, where a name is none of them; the mesh is
/// unchanged then.
void select_patches(MeshData& mesh, std::span<const std::string> names);

/// Divides the walls into patches at sharp edges, in place of the patches that the mesh has. Walls are the faces of
/// free cells without a free cell behind them: those on the boundary, and those between free and blocked cells. Two
/// walls with an edge in common (in the plane: with an end) are in one patch where their normals differ by at most
/// `degrees`, and the edge belongs to these two walls alone; a patch is all walls that are connected in this way. The
/// normal of a warped face is that of its projected area. Patches are named patch1, patch2, ... in the order of the
/// first cell, by its number in the file, with a face in them, and where that is one cell by the corners of the first
/// such face. Precondition: a mesh that check_and_repair() found valid. Angles are rounded. Cost: n log n in the faces
/// of free cells.
void divide_walls(MeshData& mesh, double degrees);

}  // namespace dartcast
