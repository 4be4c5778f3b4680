// Drafts of the cells that an edit touches. The edit alters them and puts them in the place of the cells.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/map_edits.hpp"

namespace dartcast::detail {

/// Cells in the order in which they were taken, each with its draft. Links between faces follow (DraftLink).
class Rework {
 public:
  explicit Rework(Transaction& t) : transaction_(t) {}

  [[nodiscard]] const CombinatorialMap& map() const { return transaction_.map(); }

  /// The number of the cell's draft. The first call for a cell makes the draft.
  std::uint32_t take(Cell c) {
    const auto [found, fresh] = number_.try_emplace(c.value, static_cast<std::uint32_t>(drafts_.size()));
    if (fresh) {
      cells_.push_back(c);
      drafts_.push_back(draft_of(map(), c));
    }
    return found->second;
  }
  [[nodiscard]] bool taken(Cell c) const { return number_.contains(c.value); }
  CellDraft& draft(std::uint32_t number) { return drafts_[number]; }
  [[nodiscard]] const CellDraft& draft(std::uint32_t number) const { return drafts_[number]; }
  CellDraft& draft(Cell c) { return drafts_[take(c)]; }
  /// Adds a draft without a cell.
  std::uint32_t add(CellDraft draft) {
    drafts_.push_back(std::move(draft));
    return static_cast<std::uint32_t>(drafts_.size() - 1);
  }
  /// Takes a cell that nothing replaces.
  void only_remove(Cell c) { cells_.push_back(c); }

  /// Puts the drafts in the place of the cells.
  std::vector<Cell> put() { return transaction_.replace(cells_, drafts_); }

 private:
  Transaction& transaction_;
  std::vector<Cell> cells_;
  std::vector<CellDraft> drafts_;
  std::unordered_map<std::uint32_t, std::uint32_t> number_;
};

/// The corner that a dart starts from. Precondition: the face has its corners as in the map.
inline std::size_t corner_of(const Shape& s, std::uint16_t dart) {
  return dart - std::size_t{s.first_dart(s.face_of(dart))};
}

[[noreturn]] inline void refuse(const CombinatorialMap& map, Cell c, const std::string& reason) {
  throw EditRefused("cell " + std::to_string(map.source(c)) + " " + reason);
}

/// Throws InvalidArgument if there is no such cell.
inline void expect_cell(const CombinatorialMap& map, Cell c) {
  if (!map.contains(c)) throw InvalidArgument("there is no such cell: an earlier edit replaced it; look it up anew");
}

/// Throws InvalidArgument if the map is planar. `what`: the action, such as "cuts".
inline void expect_space(const CombinatorialMap& map, const char* what) {
  if (map.dimension() == 2)
    throw InvalidArgument(std::string(what) +
                          " need cells of space: in the plane, edit the map (dartcast/map_edits.hpp)");
}

/// Throws InvalidArgument if there is no such dart.
inline void expect_dart(const CombinatorialMap& map, Dart d) {
  if (!map.contains(d.cell) || d.number >= map.shape(d.cell).dart_count())
    throw InvalidArgument("there is no such dart: an earlier edit replaced its cell; find it anew by its vertices");
}

/// Throws InvalidArgument if there is no such face.
inline void expect_face(const CombinatorialMap& map, CellFace f) {
  if (!map.contains(f.cell) || f.face >= map.shape(f.cell).face_count())
    throw InvalidArgument("there is no such face: an earlier edit replaced its cell; find it anew by its vertices");
}

/// A dart of the edge in each cell around it, all in the direction of d.
inline std::vector<Dart> around_edge(const CombinatorialMap& map, Dart d) {
  std::vector<Dart> darts = {d};
  for (Dart x = map.phi3(map.phi2(d)); x.valid() && x != d; x = map.phi3(map.phi2(x))) darts.push_back(x);
  if (!map.phi3(map.phi2(darts.back())).valid()) {
    for (Dart x = map.phi3(d); x.valid(); x = map.phi3(map.phi2(x))) darts.push_back(map.phi2(x));
  }
  return darts;
}

}  // namespace dartcast::detail
