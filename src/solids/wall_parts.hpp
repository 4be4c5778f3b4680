// Walls near an element or a group of them, with their edges and vertices: each of these once.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "dynamics/near_walls.hpp"
#include "mesh/box_tree.hpp"

namespace dartcast {

/// The box of a point's straight way.
inline Box way_of(const Vec3& from, const Vec3& to) { return join({from, from}, {to, to}); }

/// Larger by a length on each side, and by more than the rounding of that.
inline Box widened(const Box& box, double by) {
  const auto largest = [](const Vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); };
  const double more = by + 0x1p-50 * std::max({by, largest(box.low), largest(box.high)});
  return {box.low - Vec3{more, more, more}, box.high + Vec3{more, more, more}};
}

class WallParts {
 public:
  /// A vertex or an edge, and the first wall that has it.
  struct Part {
    std::array<std::uint32_t, 2> vertex{};  ///< sorted; both the same for a vertex
    std::uint32_t wall = 0;                 ///< in walls()
    std::uint8_t corner = 0;                ///< of the wall; an edge goes from it to the next
    std::uint32_t beside = 0;               ///< the next wall that has it; the same if there is none
    Box way;
  };

  /// Coordinates are as decisions see them: flushed().
  void set(std::span<const NearWall> walls);

  [[nodiscard]] std::span<const NearWall> walls() const { return walls_; }
  /// The box of each wall's way.
  [[nodiscard]] std::span<const Box> ways() const { return ways_; }
  [[nodiscard]] std::span<const Part> edges();
  [[nodiscard]] std::span<const Part> vertices();

 private:
  void list(unsigned size, std::vector<Part>& parts) const;

  std::vector<NearWall> walls_;
  std::vector<Box> ways_;
  std::vector<Part> edges_;
  std::vector<Part> vertices_;
};

}  // namespace dartcast
