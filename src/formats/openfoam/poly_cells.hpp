// OpenFOAM's cells, which are sets of faces, as cells with corners.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "formats/openfoam/poly_mesh.hpp"
#include "formats/parsed_mesh.hpp"

namespace dartcast {

/// The faces of each cell, in the order of their labels.
FoamLists faces_of_cells(const PolyMesh& mesh);

/// Whether the mesh is a plane for OpenFOAM: it has faces in a patch of the type `empty`.
bool has_empty_faces(const PolyMesh& mesh);

/// The mesh in space: tetrahedra, hexahedra, prisms and pyramids if the faces are those of one, else polyhedra.
/// Takes the points.
ParsedMesh mesh_in_space(PolyMesh mesh);

/// The mesh in the plane, of one layer between faces in patches of the type `empty`. Each cell has the corners of its
/// lower face, with z = 0. `kept`: the labels of its points. Throws InvalidMesh if there is more than one layer, or the
/// layer is not across z.
ParsedMesh mesh_in_plane(const PolyMesh& mesh, std::vector<std::uint32_t>& kept);

/// The corners that a face has in the new mesh, none if it is no face of it. Valid until the next call.
using CornersOfFace = std::function<std::span<const std::uint32_t>(std::uint32_t face)>;

/// Regions from zones of cells; patches from patches and, if a face is in none, from zones of faces. A cell, or face,
/// in several zones has the first one. A warning says so, and also names patches that particles could pass in OpenFOAM.
void add_zones_and_patches(const PolyMesh& mesh, const CornersOfFace& corners, ParsedMesh& parsed);

/// Adds the mesh's pairs of cyclic patches, and that of two wedges. A warning names the patches of these types that are in
/// none. The mesh has its points.
void add_cyclic_pairs(const PolyMesh& mesh, const CornersOfFace& corners, ParsedMesh& parsed);

}  // namespace dartcast
