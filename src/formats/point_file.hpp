// Points from files: particles' first positions, and recorded frames.
#pragma once

#include <filesystem>
#include <vector>

#include "dartcast/mesh_data.hpp"
#include "dartcast/mesh_files.hpp"

namespace dartcast {

struct PointFile {
  std::vector<Vec3> points;
  std::vector<DataArray> arrays;  ///< the points' numeric arrays; none from .csv
};

/// Reads .vtp (its points and their arrays) or .pvtp (those of all its pieces, which are in its folder). Or reads .csv:
/// the columns x, y, z by name in the first line; others are ignored. The option `max_memory` counts, the other does
/// not. Throws Error with file and, for .csv, line.
PointFile read_points(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace dartcast
