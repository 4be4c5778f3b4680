// The first look at a mesh: array sizes, ids, corners; and unused points.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// Sizes of arrays that must agree, offsets that must ascend, cells of one dimension, and limits of 2^29 cells and
/// 2^32 - 2 points. Defects: structure, too_large, empty. The functions below may be called only if there are none.
void check_arrays(const MeshData& mesh, MeshReport& report);

/// Numbers of corners, ids in range, corners that repeat, limits of polyhedra. Defects: structure, polyhedron,
/// id_out_of_range, repeated_corner.
void check_structure(const MeshData& mesh, MeshReport& report);

/// The same with repairs. Cells and patch faces whose only defect is a repeated corner get the type that they have
/// without it, if there is one. Repairs: collapsed.
void check_and_repair_structure(MeshData& mesh, MeshReport& report);

/// Drops points that no cell uses, with patch faces that name them and the values of point_data. Returns the index that
/// each point that is left had before. Precondition: the two checks above found no defect.
std::vector<std::uint32_t> drop_unused_points(MeshData& mesh, MeshReport& report);

/// Calls visit(patch face, cell) for each cell that has a patch face among its faces.
void for_each_patch_face_of_cells(const MeshData& mesh,
                                  const std::function<void(std::size_t face, std::size_t cell)>& visit);

/// Drops patch faces that are no face of any cell.
void drop_stray_patch_faces(MeshData& mesh, MeshReport& report);

}  // namespace dartcast
