// A hash grid of several levels: each box is stored once, in the level of its size.
#include "dynamics/sphere_grid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>

namespace dartcast::detail {

namespace {

constexpr std::uint32_t nothing = 0xffffffffU;

Vec3 middle_of(const SweptBox& b) { return (b.low + b.high) * 0.5; }

// Cells are longer than the boxes in them by this share of themselves at least. This is more than all rounding below,
// because coordinates are at most 2^30 cells (min_level()).
constexpr double spare = 0x1p-16;

int level_of(const SweptBox& b) {
  const Vec3 edge = b.high - b.low;
  const double longest = std::max({edge.x, edge.y, edge.z});
  return longest > 0.0 ? std::ilogb(longest * (1.0 + spare)) + 1 : -1021;
}

// The level whose cells are 2^-30 to 2^-29 of the largest coordinate: places fit into 32 bits.
int min_level(std::span<const SweptBox> boxes) {
  double largest = 0x1p-980;
  for (const SweptBox& b : boxes) {
    if (b.empty()) continue;
    for (const double x : {b.low.x, b.low.y, b.low.z, b.high.x, b.high.y, b.high.z})
      largest = std::max(largest, std::abs(x));
  }
  return std::ilogb(largest) - 29;
}

std::int32_t place_of(double x, double cells_per_length) {
  return static_cast<std::int32_t>(std::floor(x * cells_per_length));
}

}  // namespace

std::size_t SphereGrid::slot(std::int32_t level, const Place& place) const {
  const auto word = [](std::int32_t i) { return std::uint64_t{static_cast<std::uint32_t>(i)}; };
  std::uint64_t h = (word(place[0]) | word(place[1]) << 32U) * 0x9e3779b97f4a7c15U;
  h = (h ^ h >> 29U ^ (word(place[2]) | word(level) << 32U)) * 0xbf58476d1ce4e5b9U;
  const std::size_t mask = table_.size() - 1;
  std::size_t at = (h ^ h >> 32U) & mask;
  const auto is_here = [&](const GridCell& c) {
    return c.place[0] == place[0] && c.place[1] == place[1] && c.place[2] == place[2] && c.level == level;
  };
  while (table_[at] != nothing && !is_here(cells_[table_[at]])) at = (at + 1) & mask;
  return at;
}

void SphereGrid::enter(std::uint32_t sphere, const SweptBox& box, int lowest) {
  const std::int32_t level = std::max(lowest, level_of(box));
  const double scale = std::ldexp(1.0, -level);
  const Vec3 m = middle_of(box);
  const Place place = {place_of(m.x, scale), place_of(m.y, scale), place_of(m.z, scale)};
  std::uint32_t& cell = table_[slot(level, place)];
  if (cell == nothing) {
    cell = static_cast<std::uint32_t>(cells_.size());
    cells_.push_back({level, place});
  }
  ++cells_[cell].count;
  cell_of_[sphere] = cell;
}

void SphereGrid::build(std::span<const SweptBox> boxes) {
  const int lowest = min_level(boxes);
  cells_.clear();
  table_.assign(std::bit_ceil(2 * boxes.size() + 2), nothing);
  cell_of_.assign(boxes.size(), nothing);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!boxes[i].empty()) enter(static_cast<std::uint32_t>(i), boxes[i], lowest);
  }
  scatter(boxes);
}

void SphereGrid::scatter(std::span<const SweptBox> boxes) {
  std::uint32_t first = 0;
  levels_.clear();
  for (GridCell& c : cells_) {
    c.first = first;
    first += c.count;
    c.count = 0;
    if (std::find(levels_.begin(), levels_.end(), c.level) == levels_.end()) levels_.push_back(c.level);
  }
  std::sort(levels_.begin(), levels_.end());
  entries_.resize(first);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (cell_of_[i] == nothing) continue;
    GridCell& c = cells_[cell_of_[i]];
    entries_[c.first + c.count++] = {boxes[i], static_cast<std::uint32_t>(i), cell_of_[i]};
  }
}

void SphereGrid::find_in(const GridCell& cell, std::size_t end, const Entry& e, std::vector<SpherePair>& found) const {
  for (std::size_t k = cell.first; k < end; ++k) {
    if (!entries_[k].box.meets(e.box)) continue;
    const std::uint32_t other = entries_[k].sphere;
    found.push_back({std::min(e.sphere, other), std::max(e.sphere, other)});
  }
}

void SphereGrid::find(std::size_t entry, std::vector<SpherePair>& found) const {
  const Entry& e = entries_[entry];
  const GridCell& own = cells_[e.cell];
  find_in(own, entry, e, found);
  for (auto level = std::lower_bound(levels_.begin(), levels_.end(), own.level); level != levels_.end(); ++level) {
    const double scale = std::ldexp(1.0, -*level);
    const auto from = [scale](double x) { return static_cast<std::int32_t>(std::floor(x * scale - 0.5)); };
    const auto to = [scale](double x) { return static_cast<std::int32_t>(std::floor(x * scale + 0.5)); };
    const Place low = {from(e.box.low.x), from(e.box.low.y), from(e.box.low.z)};
    Place high = {to(e.box.high.x), to(e.box.high.y), to(e.box.high.z)};
    const bool same = *level == own.level;
    if (same) high[2] = own.place[2];
    for (Place p = low; p[2] <= high[2]; ++p[2]) {
      for (p[1] = low[1]; p[1] <= high[1]; ++p[1]) {
        for (p[0] = low[0]; p[0] <= high[0]; ++p[0]) {
          // In its own level, only earlier places count: by z, then y, then x.
          if (same && std::tie(p[2], p[1], p[0]) >= std::tie(own.place[2], own.place[1], own.place[0])) continue;
          const std::uint32_t cell = table_[slot(*level, p)];
          if (cell != nothing) find_in(cells_[cell], cells_[cell].first + cells_[cell].count, e, found);
        }
      }
    }
  }
}

}  // namespace dartcast::detail
