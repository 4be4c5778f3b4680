// Edits drawn at random, likely enough to be possible.
#pragma once

#include <array>
#include <span>
#include <unordered_map>
#include <vector>

#include "base/random.hpp"
#include "dartcast/map_edits.hpp"

namespace dartcast::test {

enum class EditKind {
  split_edge,
  split_face,
  split_cell,
  merge_cells,
  merge_faces,
  merge_edges,
  sew,
  unsew,
  mark,
  remove
};
inline constexpr std::size_t edit_kinds = 10;

struct Edit {
  EditKind kind;
  std::vector<Dart> darts;
};

/// The cells of a map, to draw from: all alike, or those that edits made lately.
class CellBag {
 public:
  explicit CellBag(const CombinatorialMap& map) : cells_(map.cells()) {
    for (std::size_t i = 0; i < cells_.size(); ++i) place_[cells_[i].value] = i;
  }

  void update(const EditReport& report) {
    for (const CellHandle& h : report.removed) take_out(h.cell);
    for (const Cell c : report.added) {
      place_[c.value] = cells_.size();
      cells_.push_back(c);
    }
    if (!report.added.empty()) recent_.push_back(report.added);
    if (recent_.size() > 8) recent_.erase(recent_.begin());
  }

  [[nodiscard]] std::size_t size() const { return cells_.size(); }
  [[nodiscard]] std::span<const Cell> all() const { return cells_; }

  Cell draw(const CombinatorialMap& map, Random& random) const {
    if (!recent_.empty() && random.below(2) == 0) {
      const auto& some = recent_[random.below(static_cast<std::uint32_t>(recent_.size()))];
      const Cell c = some[random.below(static_cast<std::uint32_t>(some.size()))];
      if (map.contains(c)) return c;
    }
    return cells_[random.below(static_cast<std::uint32_t>(cells_.size()))];
  }

 private:
  void take_out(Cell c) {
    const std::size_t at = place_.at(c.value);
    cells_[at] = cells_.back();
    place_[cells_[at].value] = at;
    cells_.pop_back();
    place_.erase(c.value);
  }

  std::vector<Cell> cells_;
  std::unordered_map<std::uint32_t, std::size_t> place_;
  std::vector<std::vector<Cell>> recent_;
};

/// In the plane faces are split, never cells.
EditKind in_dimension(EditKind kind, unsigned dimension);

/// Merging is tried more often than splitting, for it is refused more often; the number of cells stays about the same.
EditKind draw_kind(const CellBag& bag, std::size_t usual, Random& random, unsigned dimension = 3);

/// An edit of the kind at the cell; it may turn out to be impossible.
Edit draw_edit(const CombinatorialMap& map, EditKind kind, Cell c, const CellBag& bag, Random& random);

/// Does it; returns the new cells.
std::vector<Cell> apply(Transaction& t, const Edit& e);

}  // namespace dartcast::test
