// The cells that a rank has of an environment that is spread over several: its own, and ghosts around them. Not installed.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "dartcast/ids.hpp"

namespace dartcast {

/// Whose each cell of the rank's map is, and its handle in the map of the whole environment. Cells have the order that they
/// have in the whole, so that comparisons of handles have the same result here and there.
class PartCells {
 public:
  struct Entry {
    Cell whole;
    std::uint32_t owner = 0;  ///< its rank
  };

  /// `cells`: an entry for each cell of the rank's map, in the order of its pools and of the places in them.
  PartCells(unsigned rank, std::array<std::vector<Entry>, 5> cells);

  [[nodiscard]] unsigned rank() const { return rank_; }
  [[nodiscard]] bool is_own(Cell c) const { return owner(c) == rank_; }
  [[nodiscard]] unsigned owner(Cell c) const { return entry(c).owner; }

  // Cells that are invalid stay so.
  [[nodiscard]] Cell whole(Cell c) const { return c.valid() ? entry(c).whole : c; }
  /// Invalid if the rank does not have it.
  [[nodiscard]] Cell here(Cell whole) const;
  [[nodiscard]] SimplexId whole(SimplexId s) const { return {whole(s.cell), s.simplex}; }
  [[nodiscard]] SimplexId here(SimplexId s) const { return {here(s.cell), s.simplex}; }

 private:
  [[nodiscard]] const Entry& entry(Cell c) const { return cells_[c.pool()][c.index()]; }

  unsigned rank_;
  std::array<std::vector<Entry>, 5> cells_;
};

}  // namespace dartcast
