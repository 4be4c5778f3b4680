// Whether edges and triangles meet walls, in integers of any length. It shares nothing with the steps of solids.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "mesh/box_tree.hpp"
#include "solids/elements.hpp"

namespace dartcast {

/// All walls of a complex as they stand, but for those with a corner outside the exact range: their cells are not valid.
class WallAudit {
 public:
  /// Cost: n log n in the cells of the complex.
  explicit WallAudit(const CellComplex& complex);

  /// Whether an element, a closed set, has a point of a wall. Corners that are not finite or outside the exact range meet
  /// all walls.
  [[nodiscard]] bool meets_wall(std::span<const Vec3> positions, const SolidElement& element) const;

 private:
  std::vector<std::array<Vec3, 3>> walls_;
  BoxTree tree_;
};

/// The box around a triangle.
Box audit_box(const std::array<Vec3, 3>& t);

/// Whether two closed triangles have a point in common. A corner may be given twice or three times: then it is an edge or
/// a point. Preconditions: all coordinates are finite. Cost: some 10 us.
bool audit_meet(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

}  // namespace dartcast
