#include "dartcast/map/replacement.hpp"

#include <algorithm>

#include "dartcast/base/error.hpp"

namespace dartcast {

namespace {

class Judgement {
 public:
  Judgement(const Map& map, std::span<const Cell> removed, std::span<const CellDraft> drafts)
      : map_(map), drafts_(drafts) {
    plan_.removed.assign(removed.begin(), removed.end());
    std::sort(plan_.removed.begin(), plan_.removed.end());
  }

  Replacement judge() {
    check_removed();
    for (const CellDraft& draft : drafts_) add_form(draft);
    list_continued();
    for (std::uint32_t i = 0; i < drafts_.size(); ++i) {
      for (std::uint16_t f = 0; f < drafts_[i].faces.size(); ++f) add_link(i, f);
    }
    check_outer();
    list_opened();
    return std::move(plan_);
  }

 private:
  struct Continued {
    CellFace from;
    std::uint32_t draft;
    std::uint16_t face;
    bool operator<(const Continued& other) const { return from < other.from; }
  };

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

  void add_form(const CellDraft& draft) {
    plan_.forms.push_back(form_of(draft));
    if (!plan_.forms.back().defect.empty())
      refuse(static_cast<std::uint32_t>(plan_.forms.size() - 1), plan_.forms.back().defect);
    for (const DraftFace& f : draft.faces) {
      for (const DraftCorner& c : f.corners) check_vertex(c.vertex);
      if (f.point.valid()) check_vertex(f.point);
    }
    if (draft.point.valid()) check_vertex(draft.point);
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
        if (drafts_[i].faces[f].from.valid()) continued_.push_back({drafts_[i].faces[f].from, i, f});
      }
    }
    std::sort(continued_.begin(), continued_.end());
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
      check_fit(draft, here, there.point, vertices_of(there));
      plan_.links.push_back({draft, face, {}, link.draft, link.draft_face});
    } else if (link.face.valid()) {
      check_stays(link.face);
      check_fit(draft, here, point_of(link.face), vertices_of(link.face));
      plan_.links.push_back({draft, face, link.face});
      outer_.push_back(link.face);
    }
  }

  // A face of a removed cell stands for the one that continues it.
  [[nodiscard]] DraftLink resolved(std::uint32_t draft, std::uint16_t face) const {
    DraftLink link = drafts_[draft].faces[face].across;
    if (link.draft != DraftLink::no_draft || !is_removed(link.face.cell)) return link;
    const auto found = std::lower_bound(continued_.begin(), continued_.end(), Continued{link.face, 0, 0});
    if (found == continued_.end() || found->from != link.face)
      refuse(draft, "would be sewn to a face that is no more: leave it open, or continue the face");
    link.draft = found->draft;
    link.draft_face = found->face;
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

  static std::vector<std::uint32_t> vertices_of(const DraftFace& face) {
    std::vector<std::uint32_t> vertices;
    for (const DraftCorner& c : face.corners) vertices.push_back(c.vertex.value);
    return vertices;
  }

  [[nodiscard]] std::vector<std::uint32_t> vertices_of(CellFace f) const {
    const CellView v = map_.view(f.cell);
    std::vector<std::uint32_t> vertices;
    for (const std::uint16_t k : v.shape().corners(f.face)) vertices.push_back(v.vertex(k).value);
    return vertices;
  }

  [[nodiscard]] Vertex point_of(CellFace f) const {
    const CellView v = map_.view(f.cell);
    const auto& key = v.shape().key();
    if (!key.faces[f.face].has_point) return {};
    std::uint16_t point = key.corner_count;
    for (std::uint16_t g = 0; g < f.face; ++g)
      point = static_cast<std::uint16_t>(point + (key.faces[g].has_point ? 1 : 0));
    return v.vertex(point);
  }

  // The same corners the other way around, and the same point.
  void check_fit(std::uint32_t draft, const DraftFace& face, Vertex point,
                 const std::vector<std::uint32_t>& other) const {
    const std::size_t k = face.corners.size();
    const auto start = std::find(other.begin(), other.end(), face.corners[0].vertex.value) - other.begin();
    bool fits = other.size() == k && static_cast<std::size_t>(start) < k;
    for (std::size_t i = 0; fits && i < k; ++i)
      fits = face.corners[i].vertex.value == other[(static_cast<std::size_t>(start) + k - i) % k];
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

  const Map& map_;
  std::span<const CellDraft> drafts_;
  Replacement plan_;
  std::vector<Continued> continued_;  // sorted
  std::vector<CellFace> outer_;       // faces of cells that stay, to be sewn to drafts
};

}  // namespace

Replacement judge(const Map& map, std::span<const Cell> removed, std::span<const CellDraft> drafts) {
  return Judgement(map, removed, drafts).judge();
}

}  // namespace dartcast
