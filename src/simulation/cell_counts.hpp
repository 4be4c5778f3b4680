// How many particles each cell holds, over all ranks that share them. Not installed.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/particle_state.hpp"
#include "dynamics/cell_lists.hpp"
#include "simulation/particle_share.hpp"

namespace dartcast {

class CellCounts {
 public:
  /// Cost: that of CellLists::update(); with several ranks linear in the cells.
  void update(const CombinatorialMap& map, std::span<const ParticleState> states, Ranks* ranks) {
    lists_.update(map, states);
    sums_.clear();
    if (!are_several(ranks)) return;
    for (std::uint32_t pool = 0; pool + 1 < first_.size(); ++pool)
      first_[pool + 1] = first_[pool] + map.slot_count(pool);
    sums_.resize(first_.back());
    for (const Cell c : map.cells()) sums_[place(c)] = lists_.count(c);
    ranks->sum(sums_);
  }

  /// At most 2^32 - 1.
  [[nodiscard]] std::uint32_t of(Cell c) const {
    if (sums_.empty()) return lists_.count(c);
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(sums_[place(c)], UINT32_MAX));
  }

 private:
  [[nodiscard]] std::size_t place(Cell c) const { return first_[c.pool()] + c.index(); }

  CellLists lists_;                     // of this rank
  std::vector<std::uint64_t> sums_;     // of all ranks; empty if there is one
  std::array<std::size_t, 6> first_{};  // of each pool's cells in `sums_`
};

}  // namespace dartcast
