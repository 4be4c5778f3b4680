// Checks of a .vtu or .vtp file before VTK reads it.
#pragma once

#include <cstdint>
#include <string_view>

namespace dartcast {

/// Checks tags, sections and names as read_vtk_xml() does, and the length of each array. The length follows from the
/// counts of points and cells, and from the last offset. The data must announce and hold it, in ASCII, base64 or raw,
/// inline or appended, compressed or not. A compressed block may not grow more than 1100 times. `kind`:
/// "UnstructuredGrid" or "PolyData". Throws InvalidMesh with the line or array where something is wrong, or where the
/// file is of another kind. Point numbers are not checked. `max_memory`: as of ReadOptions; the memory for the
/// announced sizes is checked before any data are decoded.
void check_vtu(std::string_view content, std::string_view kind, std::uint64_t max_memory = 0);

}  // namespace dartcast
