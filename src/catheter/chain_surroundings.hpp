// The walls around a chain of points, looked up once for the many ways that a substep looks at.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/environment.hpp"
#include "dynamics/near_walls.hpp"
#include "solids/element_touches.hpp"
#include "solids/wall_parts.hpp"

namespace dartcast {

/// A segment of a chain, from point i to the next. It owns its first point.
inline SolidElement chain_segment(std::uint32_t i) { return {{i, i + 1, i + 1}, 2, 1, 1}; }

class ChainSurroundings {
 public:
  /// A way that ends no farther than `margin` from one that was looked up, and begins where it does, needs no other look.
  explicit ChainSurroundings(double margin) : margin_(margin) {}

  /// Forgets all. To be called before the walls move or change.
  void clear();

  /// Finds the touches of all segments on their straight way among walls at rest. Returns false if a cell around is
  /// flat: then walls are not known. Segments that rest are left out. `particles`: the chain at the start.
  /// Preconditions: as TouchFinder::find().
  bool find(const CellComplex& complex, const Particles& particles, std::size_t segments, const SolidMotion& motion,
            std::vector<ElementTouch>& touches);

 private:
  // A way that was looked up, and the walls near it.
  struct Known {
    std::array<Vec3, 2> from;
    std::array<Vec3, 2> to;
    bool is_set = false;
    WallParts walls;
  };

  [[nodiscard]] bool covers(std::size_t segment, const SolidMotion& motion) const;
  void look_up(const CellComplex& complex, Cell cell, std::size_t segment, const SolidMotion& motion);
  bool all_positive(const CellComplex& complex);

  double margin_;
  std::vector<Known> known_;  // by segment
  std::vector<Cell> reached_;
  std::vector<Cell> positive_;  // cells that are known to be, sorted
  std::vector<Cell> merged_;
  NearWalls near_;
  TouchFinder finder_;
};

}  // namespace dartcast
