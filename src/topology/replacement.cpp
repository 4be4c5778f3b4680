// Plans a replacement of cells: links the faces of drafts, and checks that the result is a map.
#include "topology/replacement.hpp"

#include <algorithm>

#include "dartcast/error.hpp"
#include "topology/key_table.hpp"

namespace dartcast {

namespace {

class ReplacementPlanner {
 public:
  ReplacementPlanner(const CombinatorialMap& map, std::span<const Cell> removed, std::span<const CellDraft> drafts)
      : map_(map), drafts_(drafts), continued_(face_count(drafts)) {
    plan_.removed.assign(removed.begin(), removed.end());
    std::sort(plan_.removed.begin(), plan_.removed.end());
  }

  Replacement plan_replacement() {
    check_removed();
    plan_.forms = forms_of(drafts_, map_.dimension());
    for (std::uint32_t i = 0; i < drafts_.size(); ++i) check_draft(i);
    list_continued();
    for (std::uint32_t i = 0; i < drafts_.size(); ++i) {
      for (std::uint16_t f = 0; f < drafts_[i].faces.size(); ++f) add_link(i, f);
    }
    check_outer();
    list_opened();
    return std::move(plan_);
  }

 private:
  static std::uint64_t key_of(CellFace f) { return (std::uint64_t{f.cell.value} << 16U) | f.face; }

  static std::size_t face_count(std::span<const CellDraft> drafts) {
    std::size_t count = 0;
    for (const CellDraft& draft : drafts) count += draft.faces.size();
    return count;
  }

  [[noreturn]] void refuse(std::uint32_t draft, const std::string& reason) const {
    throw EditRefused("cell " + std::to_string(drafts_[draft].source) + " " + reason);
  }

  void check_removed() const {
    for (const Cell c : plan_.removed) {
      if (!map_.contains(c))
        throw InvalidArgument("a cell to be replaced is not there (pool " + std::to_string(c.pool()) + ", place " +
                              std::to_string(c.index()) + "): an earlier edit replaced it; look it up anew");
    }
    if (std::adjacent_find(plan_.removed.begin(), plan_.removed.end()) != plan_.removed.end())
      throw InvalidArgument("a cell is to be replaced twice: name it once");
  }

  void check_draft(std::uint32_t number) const {
    const DraftForm& form = plan_.forms[number];
    if (!form.defect.empty()) refuse(number, form.defect);
    for (const std::uint32_t v : form.corners) check_vertex(Vertex(v));
    for (const DraftFace& f : drafts_[number].faces) {
      if (f.point.valid()) check_vertex(f.point);
      if (f.patch.value >= map_.patch_names().size())
        throw InvalidArgument("there is no patch " + std::to_string(f.patch.value) +
                              ": name one by its place in patch_names()");
    }
    if (drafts_[number].point.valid()) check_vertex(drafts_[number].point);
  }

  void check_vertex(Vertex v) const {
    if (!map_.is_vertex(v))
      throw InvalidArgument("there is no vertex " + std::to_string(v.value) + ": add it to the transaction first");
  }

  [[nodiscard]] bool is_removed(Cell c) const {
    return std::binary_search(plan_.removed.begin(), plan_.removed.end(), c);
  }

  void list_continued() {
    for (std::uint32_t i = 0; i < drafts_.size(); ++i) {
      for (std::uint16_t f = 0; f < drafts_[i].faces.size(); ++f) {
        const CellFace from = drafts_[i].faces[f].from;
        if (!from.valid()) continue;
        std::uint32_t& number = continued_[key_of(from)];
        if (number != detail::KeyTable::none) refuse(i, "would continue a face that another continues, too");
        number = static_cast<std::uint32_t>(faces_.size());
        faces_.emplace_back(i, f);
      }
    }
  }

  void add_link(std::uint32_t draft, std::uint16_t face) {
    const DraftLink link = resolved(draft, face);
    const DraftFace& here = drafts_[draft].faces[face];
    if (link.draft != DraftLink::no_draft) {
      if (link.draft >= drafts_.size() || link.draft_face >= drafts_[link.draft].faces.size())
        throw InvalidArgument("a face is to be sewn to a draft, or a face of it, that there is not");
      if (link.draft == draft)
        refuse(draft, "would have one face on both sides: merge the faces between the cells first");
      const DraftLink back = resolved(link.draft, link.draft_face);
      if (back.draft != draft || back.draft_face != face) refuse(draft, "would have a face sewn to two others");
      if (link.draft < draft) return;
      const DraftFace& there = drafts_[link.draft].faces[link.draft_face];
      check_fit(draft, here, there.point, there.corners.size(), [&](std::size_t i) { return there.corners[i].vertex; });
      plan_.links.push_back({draft, face, {}, link.draft, link.draft_face});
    } else if (link.face.valid()) {
      check_stays(link.face);
      const CellView v = map_.view(link.face.cell);
      const auto corners = v.shape().corners(link.face.face);
      check_fit(draft, here, map_.point(link.face), corners.size(),
                [&](std::size_t i) { return v.vertex(corners[i]); });
      plan_.links.push_back({draft, face, link.face});
      outer_.push_back(link.face);
    }
  }

  // A face of a removed cell means the draft's face that continues it.
  [[nodiscard]] DraftLink resolved(std::uint32_t draft, std::uint16_t face) const {
    DraftLink link = drafts_[draft].faces[face].across;
    if (link.draft != DraftLink::no_draft || !is_removed(link.face.cell)) return link;
    const std::uint32_t number = continued_.find(key_of(link.face));
    if (number == detail::KeyTable::none)
      refuse(draft, "would be sewn to a face that is no more: leave it open, or continue the face");
    link.draft = faces_[number].first;
    link.draft_face = faces_[number].second;
    return link;
  }

  void check_stays(CellFace f) const {
    if (!map_.contains(f.cell) || f.face >= map_.shape(f.cell).face_count())
      throw InvalidArgument("a face is to be sewn to a cell, or a face of it, that there is not");
    const Cell across = map_.view(f.cell).neighbour(f.face);
    if (across.valid() && !is_removed(across))
      throw EditRefused("cell " + std::to_string(map_.source(f.cell)) + " has its face sewn to cell " +
                        std::to_string(map_.source(across)) + ", which stays: unsew it first");
  }

  // Whether the other face has the same corners in opposite order, and the same point. `vertex(i)`: of its `count`
  // corners.
  template <class VertexAt>
  void check_fit(std::uint32_t draft, const DraftFace& face, Vertex point, std::size_t count, VertexAt&& vertex) const {
    const std::size_t k = face.corners.size();
    std::size_t start = 0;
    while (start < count && vertex(start) != face.corners[0].vertex) ++start;
    bool fits = count == k && start < k;
    for (std::size_t i = 0; fits && i < k; ++i) fits = face.corners[i].vertex == vertex((start + k - i) % k);
    if (map_.dimension() == 2) fits = fits && start == 1;  // an edge has a start and an end
    if (!fits) refuse(draft, "would be sewn to a face with other corners, or with them in another order");
    if (face.point != point) refuse(draft, "would be sewn to a face that is fanned from another point");
  }

  void check_outer() {
    std::sort(outer_.begin(), outer_.end());
    const auto twice = std::adjacent_find(outer_.begin(), outer_.end());
    if (twice != outer_.end())
      throw EditRefused("cell " + std::to_string(map_.source(twice->cell)) + " would have a face sewn to two others");
  }

  void list_opened() {
    for (const Cell c : plan_.removed) {
      for (std::uint16_t f = 0; f < map_.shape(c).face_count(); ++f) {
        const CellFace other = map_.opposite({c, f});
        if (!other.valid() || is_removed(other.cell)) continue;
        if (!std::binary_search(outer_.begin(), outer_.end(), other)) plan_.opened.push_back(other);
      }
    }
  }

  const CombinatorialMap& map_;
  std::span<const CellDraft> drafts_;
  Replacement plan_;
  detail::KeyTable continued_;                                  // faces of removed cells: number in the next
  std::vector<std::pair<std::uint32_t, std::uint16_t>> faces_;  // of drafts, which continue them
  std::vector<CellFace> outer_;                                 // faces of cells that stay, to be sewn to drafts
};

}  // namespace

Replacement plan_replacement(const CombinatorialMap& map, std::span<const Cell> removed,
                             std::span<const CellDraft> drafts) {
  return ReplacementPlanner(map, removed, drafts).plan_replacement();
}

}  // namespace dartcast
