// Frames of a run in one file of VTKHDF. Not installed.
#pragma once

#include <filesystem>

#include "output/run_frames.hpp"

namespace dartcast {

/// Writes PolyData in time, version 2.0: in each frame the walls as polygons (in the plane as lines) and the particles as
/// vertices, with the point arrays velocity, radius, id and is_particle (0 at points of walls). Throws Error where the
/// file cannot be written, or the library was built without HDF5.
void write_vtkhdf(const RunFrames& frames, const std::filesystem::path& path);

}  // namespace dartcast
