// The points of a .vtu file, decoded without VTK.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "formats/vtk_functions.hpp"

namespace dartcast {

/// Checks a file as check_vtu() does, and decodes its points without VTK: the same bits. None where the file has
/// several pieces, or its points are ASCII or no reals. Throws as check_vtu().
std::optional<VtuPoints> read_vtu_points(std::string_view content, std::uint64_t max_memory);

}  // namespace dartcast
