// A replacement of cells with others, checked before anything is changed.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/map_edits.hpp"

namespace dartcast {

/// The plan of a replacement, made by plan_replacement().
struct Replacement {
  struct Link {
    std::uint32_t draft;  ///< number of the draft
    std::uint16_t face;   ///< of the draft
    CellFace outer;       ///< a face of a cell that stays; invalid: another draft
    std::uint32_t other = 0;
    std::uint16_t other_face = 0;
  };

  std::vector<Cell> removed;     ///< sorted
  std::vector<DraftForm> forms;  ///< of the drafts
  std::vector<Link> links;       ///< faces that are sewn, those between two drafts once
  std::vector<CellFace> opened;  ///< faces of cells that stay and lose their neighbour
};

/// Checks whether the drafts can take the place of the cells:
///
///  - each draft is a cell (form_of());
///  - every face is sewn to a face with the same corners in opposite order and the same point;
///  - that face belongs to another cell and is sewn to no other face. It is a face of a draft, or a face of a cell that
///    stays, which is open now or sewn to a removed cell.
///
/// Throws InvalidArgument if a cell does not exist or is named twice. Throws EditRefused if the result would not
/// be a map. Cost: n log n in the darts of the drafts and of the removed cells.
Replacement plan_replacement(const CombinatorialMap& map, std::span<const Cell> removed,
                             std::span<const CellDraft> drafts);

}  // namespace dartcast
