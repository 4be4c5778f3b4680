// Cutting and carving: what lies in a tool becomes free, or is taken away.
#pragma once

#include <span>
#include <vector>

#include "editing/tool.hpp"

namespace dartcast {

enum class Carving : std::uint8_t {
  open,    ///< blocked cells in the tool become free: particles can enter. Free ones are not split at all.
  remove,  ///< cells in the tool are taken away, free ones, too: their neighbours' faces are the boundary
};

struct CarveOptions {
  /// Cells are not split: those are taken whole whose corners' mean is in the tool.
  bool whole_cells = false;
  double snap = SectionOptions{}.snap;  ///< see SectionOptions
};

struct Carved {
  std::vector<Cell> opened;  ///< cells that are free now
  std::size_t removed = 0;   ///< cells taken away
  std::vector<Cell> whole;   ///< cells that could not be split (see Section), and may reach into the tools or out
};

/// Opens or takes away what lies in some tools: cells that a tool meets are split by its planes, one after another, and
/// only what is left inside goes on to the next, so that a tool may end inside cells. `cells`: those that are
/// concerned, such as cells_near() finds; others are not split. The scene is watertight where tissue has become
/// free: nothing is parted.
///
/// Throws InvalidArgument where a cell is not there or is named twice, or snap is not in [2^-30, 1/4]; and what
/// split_by_plane() throws; everything is then as it was. Cost: that of the cells named and those around them.
Carved carve(ComplexEdit& edit, std::span<const Cell> cells, std::span<const ConvexTool> tools, Carving what,
             const CarveOptions& options = {});

/// Opens tissue along a surface (Plane, Disc, BladePath): blocked cells are split by its two sides, and the layer
/// between becomes free. As carve(); and throws as thicken().
template <class Surface>
Carved cut(ComplexEdit& edit, std::span<const Cell> cells, const Surface& surface, double width,
           const CarveOptions& options = {}) {
  return carve(edit, cells, thicken(surface, width), Carving::open, options);
}

/// Open faces of some cells (all corners at most `within` metres from a plane), such as those of an end of a vessel
/// that was cut through. Cost: linear in the cells.
std::vector<CellFace> open_faces(ComplexEdit& edit, std::span<const Cell> cells, const Plane& plane, double within);

}  // namespace dartcast
