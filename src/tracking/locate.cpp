// The grid of the locator, and exact signs among the cells of one bin.
#include "tracking/locate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/elementary.hpp"
#include "complex/simplex.hpp"
#include "dartcast/validity.hpp"
#include "tracking/carry.hpp"

namespace dartcast {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

void extend(Vec3& low, Vec3& high, const Vec3& x) {
  low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
  high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
}

// Not decreasing in x, as each operation is: so a cell's box covers the bin of every point in it.
std::uint32_t bin_along(double x, double low, double high, std::uint32_t bins) {
  const double at = (x - low) / (high - low) * bins;
  if (!(at > 0.0)) return 0;
  return std::min(bins - 1, static_cast<std::uint32_t>(std::min(at, 4e9)));
}

// The first simplex of the cell whose corners are such that holds(corners); invalid if none is.
template <class Holds>
SimplexId find_in(const CellComplex& complex, Cell c, Holds&& holds) {
  const CellView cell = complex.map().view(c);
  const auto& simplices = cell.shape().simplices();
  const auto find = [&](const auto& space) -> SimplexId {
    for (std::uint16_t s = 0; s < simplices.size(); ++s) {
      if (holds(space.corners(cell, simplices[s]))) return {c, s};
    }
    return {};
  };
  return complex.map().dimension() == 2 ? find(current_space<3>(complex)) : find(current_space<4>(complex));
}

// The first closed simplex of the cell that holds x.
SimplexId find_in(const CellComplex& complex, Cell c, const Vec3& x) {
  return find_in(complex, c, [&](const auto& corners) { return detail::in_closed_simplex(corners, x); });
}

// Whether the closed simplex holds x and the start of the way from there to `inner`. Then no facet that x lies on has
// `inner` behind it.
template <std::size_t N>
bool holds_way(const std::array<Vec3, N>& corners, const Vec3& x, const Vec3& inner) {
  for (unsigned facet = 0; facet < N; ++facet) {
    const Sign at = orient_facet(corners, facet, x);
    if (at == Sign::negative || (at == Sign::zero && orient_facet(corners, facet, inner) == Sign::negative))
      return false;
  }
  return true;
}

}  // namespace

Locator::Locator(const CellComplex& complex) {
  bounds_ = {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (const Vec3& x : complex.positions()) {
    if (in_exact_range(x)) extend(bounds_.low, bounds_.high, flushed(x));
  }
  make(complex, complex.map().cells());
}

Locator::Locator(const CellComplex& complex, const std::vector<Cell>& cells) {
  bounds_ = {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (const Cell c : cells) {
    const Box box = box_of(complex, c);
    extend(bounds_.low, bounds_.high, box.low);
    extend(bounds_.low, bounds_.high, box.high);
  }
  make(complex, cells);
}

void Locator::make(const CellComplex& complex, const std::vector<Cell>& cells) {
  choose_bins(cells.size());
  // Cells much larger than a bin would fill the grid: then the bins grow.
  while (bins_ != std::array<std::uint32_t, 3>{1, 1, 1} && entry_count(complex, cells) > 32 * cells.size()) {
    for (auto& n : bins_) n = std::max(1U, n / 2);
  }
  fill(complex, cells);
}

Locator::Box Locator::box_of(const CellComplex& complex, Cell c) {
  Box box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  const auto positions = complex.positions();
  for (const std::uint32_t v : complex.map().view(c).vertices()) extend(box.low, box.high, flushed(positions[v]));
  return box;
}

std::array<std::uint32_t, 3> Locator::bin_of(const Vec3& x) const {
  return {bin_along(x.x, bounds_.low.x, bounds_.high.x, bins_[0]),
          bin_along(x.y, bounds_.low.y, bounds_.high.y, bins_[1]),
          bin_along(x.z, bounds_.low.z, bounds_.high.z, bins_[2])};
}

template <class Visit>
void Locator::for_each_bin(const Box& box, Visit&& visit) const {
  const auto low = bin_of(box.low);
  const auto high = bin_of(box.high);
  for (std::uint32_t k = low[2]; k <= high[2]; ++k) {
    for (std::uint32_t j = low[1]; j <= high[1]; ++j) {
      for (std::uint32_t i = low[0]; i <= high[0]; ++i) visit(bin_index(i, j, k));
    }
  }
}

void Locator::choose_bins(std::size_t cells) {
  const std::array<double, 3> size = {bounds_.high.x - bounds_.low.x, bounds_.high.y - bounds_.low.y,
                                      bounds_.high.z - bounds_.low.z};
  const double largest = std::max({size[0], size[1], size[2]});
  if (!(largest > 0.0)) return;
  std::array<double, 3> share{};
  for (unsigned a = 0; a < 3; ++a) share[a] = std::max(size[a] / largest, 1e-3);
  const double per_largest = cube_root(static_cast<double>(cells) / (share[0] * share[1] * share[2]));
  for (unsigned a = 0; a < 3; ++a)
    bins_[a] = static_cast<std::uint32_t>(std::clamp(per_largest * share[a], 1.0, 4096.0));
}

std::size_t Locator::entry_count(const CellComplex& complex, const std::vector<Cell>& cells) const {
  std::size_t count = 0;
  for (const Cell c : cells) {
    const Box box = box_of(complex, c);
    const auto low = bin_of(box.low);
    const auto high = bin_of(box.high);
    count += std::size_t{high[0] - low[0] + 1U} * (high[1] - low[1] + 1U) * (high[2] - low[2] + 1U);
  }
  return count;
}

void Locator::fill(const CellComplex& complex, const std::vector<Cell>& cells) {
  first_.assign(std::size_t{bins_[0]} * bins_[1] * bins_[2] + 1, 0);
  for (const Cell c : cells) for_each_bin(box_of(complex, c), [&](std::size_t bin) { ++first_[bin + 1]; });
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  entries_.resize(first_.back());
  auto next = first_;
  for (const Cell c : cells) for_each_bin(box_of(complex, c), [&](std::size_t bin) { entries_[next[bin]++] = c; });
}

// The first simplex in a free cell that look(cell) finds, else the first in a blocked one.
template <class Look>
SimplexId Locator::first_free(const CellComplex& complex, const Vec3& x, Look&& look) const {
  if (!bounds_.holds(x)) return {};
  const std::size_t at = bin(x);
  SimplexId blocked;
  for (std::size_t e = first_[at]; e < first_[at + 1]; ++e) {
    if (!box_of(complex, entries_[e]).holds(x)) continue;
    const SimplexId here = look(entries_[e]);
    if (here.valid() && complex.map().is_free(here.cell)) return here;
    if (!blocked.valid()) blocked = here;
  }
  return blocked;
}

SimplexId Locator::find(const CellComplex& complex, const Vec3& x) const {
  return first_free(complex, x, [&](Cell c) { return find_in(complex, c, x); });
}

SimplexId Locator::find(const CellComplex& complex, const Vec3& x, const Vec3& inner) const {
  return first_free(complex, x, [&](Cell c) {
    return find_in(complex, c, [&](const auto& corners) { return holds_way(corners, x, inner); });
  });
}

// Cells with a simplex that is not positive hold nothing.
Location Locator::locate(const CellComplex& complex, const Vec3& x) const {
  const SimplexId found = first_free(complex, x, [&](Cell c) {
    const SimplexId here = find_in(complex, c, x);
    return here.valid() && check_cell(complex.map(), complex.positions(), c) ? SimplexId{} : here;
  });
  if (!found.valid()) return {};
  const Placement p = placement(complex.map(), found, complex.corners(found), x);
  return {complex.map().is_free(found.cell) ? Place::free : Place::blocked, found, p.kind, p.dart};
}

}  // namespace dartcast
