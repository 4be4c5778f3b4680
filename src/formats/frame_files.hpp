// Frames of a deformation from mesh files.
#pragma once

#include <filesystem>
#include <vector>

#include "dartcast/deformation.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/mesh_files.hpp"
#include "formats/cells_of_scene.hpp"

namespace dartcast {

/// Makes a reader of frame k from file k, its points multiplied by `scale`. Each frame has the points of `mesh`, which is that
/// of the scene, in the same order. Null: it is not known here, and all have as many as the first. Checks that all files
/// exist, and reads the first one. Throws InvalidMesh, with the file's name, if one is missing, or the first is refused or has
/// another number of points. The reader throws Error with frame and file if that holds for a later one. Several threads may
/// call it at once. Precondition: at least one file.
FrameReader frame_reader(std::vector<std::filesystem::path> files, const MeshData* mesh, const CellsOfScene& cells,
                         double scale, const ReadOptions& options);

}  // namespace dartcast
