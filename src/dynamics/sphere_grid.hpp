// A grid of several levels for boxes of very different sizes.
//
// A box is in the cell that holds its middle, in the level whose cells are the next power of two above its longest
// edge. Its neighbours of that level are in 27 cells, those of each coarser level in at most 27. M. Mueller and others
// call it a hierarchical grid: B. Mirtich, "Efficient algorithms for two-phase collision detection", 1997.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/vec3.hpp"

namespace dartcast {

struct SpherePair {
  std::uint32_t a = 0;  ///< < b
  std::uint32_t b = 0;

  constexpr auto operator<=>(const SpherePair&) const = default;
};

namespace detail {

/// The box that a sphere sweeps; empty if low is above high.
struct SweptBox {
  Vec3 low;
  Vec3 high;

  [[nodiscard]] bool empty() const { return !(low.x <= high.x); }
  [[nodiscard]] SweptBox joined(const SweptBox& o) const {
    return {{std::min(low.x, o.low.x), std::min(low.y, o.low.y), std::min(low.z, o.low.z)},
            {std::max(high.x, o.high.x), std::max(high.y, o.high.y), std::max(high.z, o.high.z)}};
  }
  [[nodiscard]] bool holds(const SweptBox& o) const {
    return low.x <= o.low.x && o.high.x <= high.x && low.y <= o.low.y && o.high.y <= high.y && low.z <= o.low.z &&
           o.high.z <= high.z;
  }
  [[nodiscard]] bool meets(const SweptBox& o) const {
    return low.x <= o.high.x && o.low.x <= high.x && low.y <= o.high.y && o.low.y <= high.y && low.z <= o.high.z &&
           o.low.z <= high.z;
  }
};

class SphereGrid {
 public:
  /// Puts the boxes that are not empty into cells. Cost: linear; no allocation in steady state.
  void build(std::span<const SweptBox> boxes);

  /// The number of boxes in the grid. Their order puts most neighbours near each other.
  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  /// Adds the pairs of an entry's box with boxes of coarser levels, and with boxes of its level at earlier places.
  /// Over all entries, that is each pair whose boxes meet once.
  void find(std::size_t entry, std::vector<SpherePair>& found) const;

 private:
  using Place = std::array<std::int32_t, 3>;
  struct GridCell {
    std::int32_t level = 0;
    Place place{};
    std::uint32_t first = 0;  // its entries are [first, first + count)
    std::uint32_t count = 0;
  };
  struct Entry {
    SweptBox box;
    std::uint32_t sphere = 0;
    std::uint32_t cell = 0;
  };

  void enter(std::uint32_t sphere, const SweptBox& box, int lowest);
  void scatter(std::span<const SweptBox> boxes);
  [[nodiscard]] std::size_t slot(std::int32_t level, const Place& place) const;
  void find_in(const GridCell& cell, std::size_t end, const Entry& e, std::vector<SpherePair>& found) const;

  std::vector<std::uint32_t> cell_of_;  // by sphere
  std::vector<GridCell> cells_;
  std::vector<std::uint32_t> table_;  // cells by level and place: open addressing, at most half full
  std::vector<std::int32_t> levels_;  // that there are, ascending
  std::vector<Entry> entries_;        // by cell, then by sphere
};

}  // namespace detail

}  // namespace dartcast
