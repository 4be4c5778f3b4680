// A look at a .vtu file before VTK reads it.
#pragma once

#include <string_view>

namespace dartcast {

/// Checks tags and their nesting, and for each array that the numbers it must have (by the counts of points and cells,
/// and the last of the offsets) are the numbers that its data announce and hold: ASCII, base64 or raw, inline or
/// appended, compressed or not. A compressed block may not grow more than 1100 times. Throws InvalidMesh with the line
/// where something is wrong, or where the file is another kind of VTK's XML files. Point numbers are not checked.
void check_vtu(std::string_view content);

}  // namespace dartcast
