// A rank's part of a mesh, as its environment and its files need it. Not installed.
#pragma once

#include <cstdint>

#include "dartcast/mesh_part.hpp"
#include "parts/part_cells.hpp"

namespace dartcast {

/// The part without its ghosts; points are those of the part.
MeshData own_mesh(const MeshPart& part);

/// The mesh of a part that is the whole: without the unknown patch. Precondition: it has no unknown faces.
MeshData whole_mesh(MeshPart part);

/// The cells of a part by their handles.
PartCells part_cells(const MeshPart& part);

}  // namespace dartcast
