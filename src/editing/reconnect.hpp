// Sewing the ends of a vessel together.
#pragma once

#include <span>
#include <vector>

#include "dartcast/complex_edit.hpp"

namespace dartcast {

struct ReconnectOptions {
  /// Ends are sewn where each corner lies within this share of its shortest edge in the end from its counterpart.
  double tolerance = 0.1;
  Patch side;  ///< of the new faces between the rims of two ends; none by default
};

enum class Reconnection : std::uint8_t {
  sewn,    ///< faces matched and lay together: they are inner faces now
  paired,  ///< faces matched but lay apart: a cell is between each two of them
  bridged  ///< faces did not match: one cell has all of them
};

struct Reconnected {
  Reconnection how = Reconnection::sewn;
  std::vector<Cell> cells;  ///< sewn: cells whose faces or corners changed; else: the new cells
  double shift = 0.0;       ///< sewn: the farthest that a corner of b went to its counterpart in a (m)
};

/// Joins two ends: sets of open faces, of which each is named once. Ends match where their faces have the same degrees
/// and meet in the same way, seen from opposite sides; of several ways to match them the one with the least sum of
/// squared distances is taken. Where they match and lie together they are sewn: corners of a keep their places and
/// numbers. Where they match and are apart the gap is filled with a cell for each pair of faces. Otherwise it is filled
/// with a single cell, with a strip of triangles between the two rims, each of which must then be one simple loop; it
/// must be star-shaped, or commit() refuses it. A new cell is free where the cells that it joins are; one between a
/// free and a blocked cell is blocked.
///
/// Throws InvalidArgument where an end has no faces, a face is not there or is named twice, the tolerance is negative
/// or there is no such patch; EditRefused where a face is not open, ends in need of a filling have a corner in common,
/// a single cell would join free and blocked cells, or a rim is no simple loop; everything is then as it was. Cost:
/// that of the cells at the ends, times the ways to begin a match that look better than the best (few, where ends face
/// each other).
Reconnected reconnect(ComplexEdit& edit, std::span<const CellFace> a, std::span<const CellFace> b,
                      const ReconnectOptions& options = {});

}  // namespace dartcast
