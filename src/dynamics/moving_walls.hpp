// All walls of a complex with the boxes around their ways in the last move, for steps of many points: most are near none.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "complex/simplex.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/threads.hpp"
#include "dynamics/near_walls.hpp"
#include "mesh/box_tree.hpp"

namespace dartcast {

/// In space.
class MovingWalls {
 public:
  /// Which complex, after how many edits: the walls of another are listed anew.
  struct Version {
    std::uint64_t environment = 0;
    std::uint64_t edits = 0;
    bool operator==(const Version&) const = default;
  };

  /// Brings the boxes to the last move. Cost: linear in the walls; in the cells if they are listed anew.
  void update(const CellComplex& complex, const Version& version, Threads threads);

  /// Whether every wall whose box meets that of the way satisfies a condition. Precondition: update(). Walls with a corner
  /// that is not in the exact range are left out, as NearWalls does.
  template <class Condition>
  bool all_near(const CellComplex& complex, const Vec3& from, const Vec3& to, Condition&& condition) const {
    Box box = join({from, from}, {to, to});
    const Vec3 largest = extent_of(box.low, box.high);
    const double margin = 0x1p-50 * std::max({largest.x, largest.y, largest.z});  // more than rounding
    box.low = box.low - Vec3{margin, margin, margin};
    box.high = box.high + Vec3{margin, margin, margin};
    bool all = true;
    tree_->query(box, [&](std::uint32_t i) {
      NearWalls::for_each_triangle(complex, faces_[i], [&](const NearWall& wall) { all = all && condition(wall); });
      return all;
    });
    return all;
  }

 private:
  void list(const CellComplex& complex);
  [[nodiscard]] static Box box_of(const CellComplex& complex, CellFace face);

  std::optional<Version> version_;
  std::vector<CellFace> faces_;
  std::optional<BoxTree> tree_;
};

}  // namespace dartcast
