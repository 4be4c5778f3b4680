// Frames of a run in one file of VTKHDF. Not installed.
#pragma once

#include <filesystem>

#include "output/run_frames.hpp"

namespace dartcast {

/// Writes PolyData in time, version 2.0. In each frame the walls are polygons (in the plane lines), and the particles
/// are vertices. The point arrays are velocity, radius, id and is_particle (0 at points of walls). Throws Error if the
/// file cannot be written, or the library was built without HDF5.
void write_vtkhdf(const RunFrames& frames, const std::filesystem::path& path);

}  // namespace dartcast
