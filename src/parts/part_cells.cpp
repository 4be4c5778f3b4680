// Handles of cells in a part and in the whole.
#include "parts/part_cells.hpp"

#include <algorithm>
#include <utility>

namespace dartcast {

PartCells::PartCells(unsigned rank, std::array<std::vector<Entry>, 5> cells) : rank_(rank), cells_(std::move(cells)) {}

Cell PartCells::here(Cell whole) const {
  if (!whole.valid()) return {};
  const std::vector<Entry>& pool = cells_[whole.pool()];
  const auto found =
      std::lower_bound(pool.begin(), pool.end(), whole, [](const Entry& e, Cell c) { return e.whole < c; });
  if (found == pool.end() || found->whole != whole) return {};
  return Cell(whole.pool(), static_cast<std::uint32_t>(found - pool.begin()));
}

}  // namespace dartcast
