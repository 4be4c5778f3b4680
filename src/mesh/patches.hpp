// Which groups of wall faces are told apart.
#pragma once

#include <span>
#include <string>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

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
