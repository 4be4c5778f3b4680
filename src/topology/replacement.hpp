// A replacement of cells by others, judged before anything is changed.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/map_edits.hpp"

namespace dartcast {

/// What is to be done; made by plan_replacement().
struct Replacement {
  struct Link {
    std::uint32_t draft;  ///< number of the draft
    std::uint16_t face;   ///< of the draft
    CellFace outer;       ///< a cell that stays; invalid: another draft
    std::uint32_t other = 0;
    std::uint16_t other_face = 0;
  };

  std::vector<Cell> removed;     ///< sorted
  std::vector<DraftForm> forms;  ///< of the drafts
  std::vector<Link> links;       ///< faces that are sewn, those between two drafts once
  std::vector<CellFace> opened;  ///< faces of cells that stay, which lose what lay across
};

/// Judges whether the drafts can take the place of the cells: each draft is a cell (form_of()); every face is sewn to
/// one with the same corners in opposite order and the same point, which is of another cell and sewn to nothing else:
/// a face of a draft, or one of a cell that stays, which is open now or sewn to a removed cell. Throws InvalidArgument
/// where a cell is named that there is not, or twice; EditRefused where the result would be no map. Cost: n log n in
/// the darts of the drafts and of the cells removed.
Replacement plan_replacement(const CombinatorialMap& map, std::span<const Cell> removed,
                             std::span<const CellDraft> drafts);

}  // namespace dartcast
