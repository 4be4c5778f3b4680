// A field from files.
#pragma once

#include "dartcast/mesh_files.hpp"
#include "dartcast/scene.hpp"
#include "formats/cells_of_scene.hpp"

namespace dartcast {

/// Makes samples of the field's files, and reads the first one. The others are read when they are needed; that they
/// exist is checked here. `mesh`: of the scene, read. Throws Error and its kinds, naming the file.
void read_field_files(FieldScene& field, const MeshData& mesh, const CellsOfScene& cells, const ReadOptions& options);

}  // namespace dartcast
