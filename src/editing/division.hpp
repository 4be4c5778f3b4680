// Cells divided into their simplices, before cuts that cannot be made otherwise. Private to editing.
#pragma once

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "dartcast/cutting.hpp"

namespace dartcast::detail {

/// Undoes the work of an action on an edit if the action throws.
template <class Action>
auto all_or_nothing(ComplexEdit& edit, Action&& action) {
  const Transaction::Savepoint before = edit.savepoint();
  try {
    return action();
  } catch (...) {
    edit.roll_back(before);
    throw;
  }
}

/// Pairs of cells: one that an edit replaced, and one in its place.
struct Succession {
  std::vector<std::pair<Cell, Cell>> pairs;

  /// The cells in the place of some. Those that nothing replaced are among them.
  [[nodiscard]] std::vector<Cell> now(std::span<const Cell> before) const;
  /// The cell that this one is in the place of; the same if it replaced none.
  [[nodiscard]] Cell before(Cell now) const;
};

/// Divides cells into their simplices, as divide_into_simplices() does, but whatever becomes of the cells beside them.
/// Precondition: can_be_divided(), each.
Succession divide(ComplexEdit& edit, std::span<const Cell> cells);

/// Whether a cell has several simplices, all of them positive. It may also be one that this edit has removed.
bool can_be_divided(ComplexEdit& edit, Cell c);

/// The effects of a cut, and what it did to cells.
template <class Effects>
struct CutAttempt {
  Effects effects;
  Succession succession;
  std::vector<Cell> whole;  ///< cells, as they were before the cut, that it could not split
  bool keep_faces = false;  ///< bent faces must not move if only cells beside them change
};

/// Those of the cells that a division and a cut made, and around them, for which ComplexEdit::refused_cells() asks.
std::vector<Cell> refused_cells(ComplexEdit& edit, const Succession& division, const Succession& cut, bool keep_faces);

/// Divides some cells, and makes a cut. Some cells cannot be cut as they are: commit() would refuse their parts, or
/// they stayed whole. Then it makes the cut anew with these divided first, too. If that does not suffice, parts are
/// thin, and vertices that snap bend them: then it makes the cut anew with the smallest snap. All or nothing.
/// `cut(cells, snap)` returns a CutAttempt. There are at most as many repetitions as cells, and one.
template <class Cut>
auto cut_with_division(ComplexEdit& edit, std::span<const Cell> cells, double snap, std::vector<Cell> divided,
                       Cut&& cut) {
  return all_or_nothing(edit, [&] {
    const Transaction::Savepoint before = edit.savepoint();
    for (;;) {
      const Succession division = divide(edit, divided);
      auto attempt = cut(division.now(cells), snap);
      const std::vector<Cell> refused = refused_cells(edit, division, attempt.succession, attempt.keep_faces);
      std::vector<Cell> more;
      const auto add = [&](Cell c) {
        if (std::find(divided.begin(), divided.end(), c) == divided.end() && can_be_divided(edit, c)) more.push_back(c);
      };
      for (const Cell c : refused) add(division.before(attempt.succession.before(c)));
      for (const Cell c : attempt.whole) add(division.before(c));
      if (more.empty() && (refused.empty() || snap <= SectionOptions::min_snap)) return std::move(attempt.effects);
      edit.roll_back(before);
      if (more.empty()) snap = SectionOptions::min_snap;
      divided.insert(divided.end(), more.begin(), more.end());
      std::sort(divided.begin(), divided.end());
      divided.erase(std::unique(divided.begin(), divided.end()), divided.end());
    }
  });
}

}  // namespace dartcast::detail
