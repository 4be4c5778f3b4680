// Divides cells into their simplices. The faces are split along their fans, on both sides.
#include "editing/division.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

#include "dartcast/error.hpp"
#include "dartcast/remeshing.hpp"
#include "editing/region.hpp"
#include "topology/facet_corners.hpp"
#include "topology/key_table.hpp"
#include "topology/rework.hpp"

namespace dartcast {

namespace detail {

std::vector<Cell> Succession::now(std::span<const Cell> before) const {
  std::vector<std::pair<Cell, Cell>> sorted = pairs;
  std::sort(sorted.begin(), sorted.end());
  std::vector<Cell> cells;
  cells.reserve(before.size());
  for (const Cell c : before) {
    const auto first = std::partition_point(sorted.begin(), sorted.end(), [&](const auto& p) { return p.first < c; });
    for (auto p = first; p != sorted.end() && p->first == c; ++p) cells.push_back(p->second);
    if (first == sorted.end() || first->first != c) cells.push_back(c);
  }
  return cells;
}

Cell Succession::before(Cell now) const {
  const auto found = std::find_if(pairs.begin(), pairs.end(), [&](const auto& p) { return p.second == now; });
  return found == pairs.end() ? now : found->first;
}

namespace {

class Divider {
 public:
  Divider(ComplexEdit& edit, std::span<const Cell> cells)
      : edit_(edit), map_(edit.map()), rework_(edit.topology()), cells_(cells.begin(), cells.end()) {
    for (const Cell c : cells_) {
      first_[c.value] = static_cast<std::uint32_t>(whole_.size());
      rework_.only_remove(c);
      for (std::size_t s = 0; s < map_.shape(c).simplices().size(); ++s) {
        rework_.add({{}, {}, map_.is_free(c), map_.source(c)});
        whole_.push_back(c);
      }
    }
  }

  Succession divide() {
    for (const Cell c : cells_) {
      const auto& simplices = map_.shape(c).simplices();
      for (std::uint16_t s = 0; s < simplices.size(); ++s) {
        std::vector<DraftFace> faces;
        for (std::uint16_t facet = 0; facet < 4; ++facet) faces.push_back(face_of(c, s, facet));
        rework_.draft(first_.find(c.value) + s).faces = std::move(faces);
      }
    }
    Succession succession;
    const std::vector<Cell> now = rework_.put();
    for (std::size_t i = 0; i < now.size(); ++i) succession.pairs.emplace_back(whole_[i], now[i]);
    return succession;
  }

 private:
  [[nodiscard]] bool is_divided(Cell c) const { return first_.find(c.value) != KeyTable::none; }

  // The corner of a cell, or the new vertex in the place of a Steiner point.
  Vertex vertex(const CellView& v, std::uint16_t local) {
    if (local < v.shape().corner_count()) return v.vertex(local);
    const Vertex point = v.vertex(local);
    std::uint32_t& made = at_point_[point.value];
    if (made == KeyTable::none) made = edit_.topology().add_vertex(point, point).value;
    return Vertex(made);
  }

  DraftFace face_of(Cell c, std::uint16_t simplex, std::uint16_t facet) {
    const CellView v = map_.view(c);
    const ImplicitSimplex& s = v.shape().simplices()[simplex];
    const auto& [i, j, k] = facet_corners[facet];
    DraftFace face;
    for (const std::uint8_t corner : {i, k, j}) face.corners.push_back({vertex(v, s.vertex[corner])});
    const Across across = s.across[facet];
    if (!across.outer()) {
      face.across = {{}, first_.find(c.value) + across.index, across.place};
      return face;
    }
    const CellFace here{c, across.face()};
    const CellFace there = map_.opposite(here);
    face.patch = map_.patch(here);
    if (v.shape().triangle_count(here.face) == 1) {
      face.from = here;
      face.across.face = there;
    } else if (there.valid()) {
      face.across = beyond(there, v.shape().triangle_from_other_side(here.face, across.place));
    }
    return face;
  }

  // The face beyond a triangle of a fan, as the cell there numbers it.
  DraftLink beyond(CellFace f, std::uint16_t triangle) {
    if (is_divided(f.cell)) {
      const Across entry = map_.shape(f.cell).entry(f.face, triangle);
      return {{}, first_.find(f.cell.value) + entry.index, entry.place};
    }
    std::uint32_t& first = split_[(std::uint64_t{f.cell.value} << 16U) | f.face];
    if (first == KeyTable::none) first = split(f);
    return {{}, rework_.take(f.cell), static_cast<std::uint16_t>(triangle == 0 ? f.face : first + triangle - 1U)};
  }

  // Splits a face of a cell that stays whole along its fan. The first triangle keeps the face's number. Returns the
  // number of the second one: the others follow.
  std::uint32_t split(CellFace f) {
    const std::uint32_t number = rework_.take(f.cell);
    if (number == whole_.size()) whole_.push_back(f.cell);
    CellDraft& draft = rework_.draft(number);
    const auto first = static_cast<std::uint32_t>(draft.faces.size());
    const CellView v = map_.view(f.cell);
    const DraftFace face = std::move(draft.faces[f.face]);
    for (std::uint16_t t = 0; t < v.shape().triangle_count(f.face); ++t) {
      DraftFace part;
      part.patch = face.patch;
      for (const std::uint16_t local : v.shape().triangle(f.face, t)) part.corners.push_back({vertex(v, local)});
      for (std::size_t i = 0; i < 3; ++i)
        part.corners[i].coplanar = may_be_coplanar(face, part.corners[i].vertex, part.corners[(i + 1) % 3].vertex);
      const CellFace here = map_.opposite(f);
      const Across entry = map_.shape(here.cell).entry(here.face, v.shape().triangle_from_other_side(f.face, t));
      part.across = {{}, first_.find(here.cell.value) + entry.index, entry.place};
      if (t == 0)
        draft.faces[f.face] = std::move(part);
      else
        draft.faces.push_back(std::move(part));
    }
    return first;
  }

  // Whether the faces at an edge of a triangle may lie in one plane. Those of one fan may.
  static bool may_be_coplanar(const DraftFace& face, Vertex from, Vertex to) {
    for (std::size_t i = 0; i < face.corners.size(); ++i) {
      if (face.corners[i].vertex == from && face.corners[(i + 1) % face.corners.size()].vertex == to)
        return face.corners[i].coplanar;
    }
    return true;
  }

  ComplexEdit& edit_;
  const CombinatorialMap& map_;
  Rework rework_;
  std::vector<Cell> cells_;
  std::vector<Cell> whole_;  // by draft: the cell that it is a part of
  KeyTable first_;           // the draft of the first simplex, by cell
  KeyTable at_point_;        // the vertex in the place of a Steiner point
  KeyTable split_;           // by face of a cell that stays whole, if it is split: see split()
};

}  // namespace

Succession divide(ComplexEdit& edit, std::span<const Cell> cells) {
  return cells.empty() ? Succession{} : Divider(edit, cells).divide();
}

bool can_be_divided(ComplexEdit& edit, Cell c) {
  return edit.map().shape(c).simplices().size() > 1 && is_positive(edit, c);
}

std::vector<Cell> refused_cells(ComplexEdit& edit, const Succession& division, const Succession& cut, bool keep_faces) {
  std::vector<Cell> now;
  now.reserve(division.pairs.size() + cut.pairs.size());
  for (const Succession* s : {&division, &cut}) {
    for (const auto& pair : s->pairs) {
      if (edit.map().contains(pair.second)) now.push_back(pair.second);
    }
  }
  return edit.refused_cells(now, keep_faces);
}

}  // namespace detail

std::vector<Cell> divide_into_simplices(ComplexEdit& edit, std::span<const Cell> cells) {
  detail::expect_space(edit.map(), "divisions into simplices");
  std::vector<Cell> divided;
  for (const Cell c : cells) {
    detail::expect_cell(edit.map(), c);
    if (!detail::is_positive(edit, c))
      detail::refuse(edit.map(), c, "has a simplex that is not positive, so it cannot be divided: repair it first");
    if (detail::can_be_divided(edit, c)) divided.push_back(c);
  }
  std::sort(divided.begin(), divided.end());
  divided.erase(std::unique(divided.begin(), divided.end()), divided.end());
  return detail::cut_with_division(edit, cells, SectionOptions::min_snap, divided, [](std::vector<Cell> now, double) {
    return detail::CutAttempt<std::vector<Cell>>{std::move(now), {}, {}, true};
  });
}

}  // namespace dartcast
