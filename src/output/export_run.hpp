// A whole run in the formats of other programs: particles with velocities, and the walls, frame by frame.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace dartcast {

/// Endings of what export_run() writes. With HDF5 `.vtkhdf`, too.
std::vector<std::string> export_endings();

/// Writes the frames of a run's folder in the format of the path's ending, and returns their number. A .vtkhdf (VTKHDF
/// 2.0, PolyData in time) or .usda (time samples) file holds all of them. Files .ply and .obj are series, with the
/// number of the step before the ending, and walls in files of their own. Throws InvalidArgument for another ending,
/// and if the folder has no frames; Error if a file cannot be read or written.
std::size_t export_run(const std::filesystem::path& run_folder, const std::filesystem::path& path);

}  // namespace dartcast
