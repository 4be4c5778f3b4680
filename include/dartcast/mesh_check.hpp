// Judging a mesh before anything is built from it.
#pragma once

#include "dartcast/mesh_data.hpp"
#include "mesh/mesh_report.hpp"

namespace dartcast {

/// Repairs in place what can be repaired without a guess, and says so:
///   orientation (cells inside out), polyhedron_faces (faces that disagree with their neighbours), unused_points
///   (dropped), plane (points of a planar mesh with one z that is not 0).
/// Warns of what can be used with care:
///   repeated_points, non_conforming (cells against each other without matching faces: particles meet a wall there),
///   boundary_edges and boundary_points (pinched), patch_faces (that are no cell's face; dropped), unfinished.
/// Refuses:
///   empty, structure (array sizes, cells of two dimensions), polyhedron (faces not closed, more than 1000, fewer than
///   three corners), id_out_of_range, repeated_corner, not_finite, out_of_range (coordinates), flat, inverted,
///   face_shared (by three cells or more), same_side (two cells on one side of a face), face_order (one set of corners
///   in two orders), no_volume (a surface in space), too_large.
/// Places are indices in the input: of cells (MeshData::source), of patch faces (MeshData::patch_source), or of points
/// for findings about points.
///
/// Of a mesh of the plane (report.dimension = 2) faces are edges, and cells that are not weakly convex are inverted;
/// non_conforming are edges with a point of another inside, or that lie against others; boundary_edges there are none.
/// Never throws for any content of the arrays. Cost: n log n, about 2 us a hexahedron; 40 bytes a face.
MeshReport check_and_repair(MeshData& mesh);

}  // namespace dartcast
