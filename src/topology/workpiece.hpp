// Cells that are split again and again, as drafts, before they go into the map in one replacement. Private.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "topology/rework.hpp"

namespace dartcast::detail {

/// A face of a draft.
struct FaceOfDraft {
  std::uint32_t draft = DraftLink::no_draft;
  std::uint16_t face = 0;

  [[nodiscard]] bool valid() const { return draft != DraftLink::no_draft; }
};

/// Drafts by number. The first part of a cell that is split keeps the number of its draft.
class Workpiece {
 public:
  explicit Workpiece(Transaction& t) : rework_(t) {}

  [[nodiscard]] bool taken(Cell c) const { return rework_.taken(c); }
  /// The number of the draft of a cell: that of its first part, if it was split. The first call for a cell makes it.
  std::uint32_t take(Cell c);
  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(next_part_.size()); }
  /// The cell that a draft is a part of.
  [[nodiscard]] Cell whole(std::uint32_t number) const { return whole_[number]; }
  [[nodiscard]] const CellDraft& draft(std::uint32_t number) const { return rework_.draft(number); }
  CellDraft& draft(std::uint32_t number) { return rework_.draft(number); }

  /// The other side of a face; invalid on the boundary. Takes the cell there if that has not been done.
  FaceOfDraft opposite(FaceOfDraft f);
  /// Splits a face on both sides with an edge between two of its corners. Precondition: no edge of it joins them.
  void split_face(FaceOfDraft f, Vertex u, Vertex v);
  /// Splits a cell along a face. Its faces marked in `leaving`, and the other side of `cut`, go to a new draft, whose
  /// number is returned. `cut`: as the part that stays sees it, without links.
  std::uint32_t split_cell(std::uint32_t number, std::span<const std::uint8_t> leaving, DraftFace cut);

  /// Replaces the cells with the drafts. Returns the new cells in the order of the drafts. Throws as
  /// Transaction::replace().
  std::vector<Cell> put() { return rework_.put(); }

 private:
  DraftFace& face(FaceOfDraft f) { return rework_.draft(f.draft).faces[f.face]; }
  void sew(FaceOfDraft a, FaceOfDraft b);
  void sew_again(std::uint32_t number);

  Rework rework_;
  std::vector<std::uint32_t> next_part_;  // of the same cell, by draft
  std::vector<Cell> whole_;               // by draft
};

}  // namespace dartcast::detail
