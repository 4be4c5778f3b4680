// Frames of a deformation from mesh files.
#pragma once

#include <filesystem>
#include <vector>

#include "dartcast/deformation.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/scene.hpp"

namespace dartcast {

/// Makes a reader of frame k from file k. Each frame has the points of `mesh`, which is that of the scene, in the same
/// order; null: it is not known here, and all have as many as the first. Checks that all files exist, and reads the first one. Throws InvalidMesh, with the file's name, where one is
/// missing, or the first is refused or has another number of points. The reader throws Error with frame and file where
/// that holds for a later one. Several threads may call it at once. Precondition: at least one file.
FrameReader frame_reader(std::vector<std::filesystem::path> files, const MeshData* mesh,
                         const EnvironmentScene& environment, const ReadOptions& options);

}  // namespace dartcast
