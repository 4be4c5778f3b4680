// Splits drafts of cells, and keeps the links between their faces.
#include "topology/workpiece.hpp"

#include <algorithm>
#include <utility>

#include "topology/draft_cuts.hpp"

namespace dartcast::detail {

std::uint32_t Workpiece::take(Cell c) {
  const std::uint32_t number = rework_.take(c);
  if (number == next_part_.size()) {
    next_part_.push_back(DraftLink::no_draft);
    whole_.push_back(c);
  }
  return number;
}

void Workpiece::sew(FaceOfDraft a, FaceOfDraft b) {
  face(a).across = {{}, b.draft, b.face};
  face(b).across = {{}, a.draft, a.face};
}

// A draft that was just made names the cell beyond a face. The part of that cell that has the face is found when it is
// asked for.
FaceOfDraft Workpiece::opposite(FaceOfDraft f) {
  const DraftLink link = face(f).across;
  if (link.draft != DraftLink::no_draft) return {link.draft, link.draft_face};
  if (!link.face.valid()) return {};
  for (std::uint32_t number = take(link.face.cell); number != DraftLink::no_draft; number = next_part_[number]) {
    const std::vector<DraftFace>& faces = draft(number).faces;
    const auto found =
        std::find_if(faces.begin(), faces.end(), [&](const DraftFace& other) { return other.from == link.face; });
    if (found == faces.end()) continue;
    const FaceOfDraft other = {number, static_cast<std::uint16_t>(found - faces.begin())};
    sew(f, other);
    return other;
  }
  throw InternalError("a face that is to be split has no other side");
}

void Workpiece::split_face(FaceOfDraft f, Vertex u, Vertex v) {
  const FaceOfDraft other = opposite(f);
  const auto last = [&](FaceOfDraft of) {
    return FaceOfDraft{of.draft, static_cast<std::uint16_t>(draft(of.draft).faces.size() - 1)};
  };
  cut_face(draft(f.draft), f.face, u, v);
  if (!other.valid()) return;
  cut_face(draft(other.draft), other.face, v, u);
  sew(last(f), last(other));
}

// After faces of a draft have changed their numbers, or their draft.
void Workpiece::sew_again(std::uint32_t number) {
  const std::vector<DraftFace>& faces = draft(number).faces;
  for (std::uint16_t f = 0; f < faces.size(); ++f) {
    const DraftLink& link = faces[f].across;
    if (link.draft != DraftLink::no_draft) face({link.draft, link.draft_face}).across = {{}, number, f};
  }
}

std::uint32_t Workpiece::split_cell(std::uint32_t number, std::span<const std::uint8_t> leaving, DraftFace cut) {
  CellDraft part;
  CellDraft& whole = draft(number);
  part.free = whole.free;
  part.source = whole.source;
  std::size_t kept = 0;
  for (std::size_t f = 0; f < leaving.size(); ++f) {
    if (leaving[f] != 0)
      part.faces.push_back(std::move(whole.faces[f]));
    else if (kept++ != f)
      whole.faces[kept - 1] = std::move(whole.faces[f]);
  }
  whole.faces.resize(kept);
  DraftFace beyond = cut;
  std::reverse(beyond.corners.begin(), beyond.corners.end());
  whole.faces.push_back(std::move(cut));
  part.faces.push_back(std::move(beyond));
  const auto faces = static_cast<std::uint16_t>(part.faces.size());
  const std::uint32_t added = rework_.add(std::move(part));
  next_part_.push_back(next_part_[number]);
  next_part_[number] = added;
  whole_.push_back(whole_[number]);
  sew_again(number);
  sew_again(added);
  sew({number, static_cast<std::uint16_t>(kept)}, {added, static_cast<std::uint16_t>(faces - 1)});
  return added;
}

}  // namespace dartcast::detail
