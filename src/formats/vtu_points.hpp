// The points of a .vtu file alone, for a series of files with the same cells.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "dartcast/vec3.hpp"

namespace dartcast {

struct VtuPoints {
  std::vector<Vec3> points;  ///< all of the file, as it has them
  std::uint64_t cells;       ///< a hash of the arrays of its cells
};

/// Checks a file as check_vtu() does, and decodes its points without VTK: the same bits. None where the file has
/// several pieces, or its points are ASCII or no reals. Throws as check_vtu().
std::optional<VtuPoints> read_vtu_points(std::string_view content, std::uint64_t max_memory);

}  // namespace dartcast
