// Lists the ways through a shape: how each facet is left, then where the triangles of its faces lead.
#include "topology/exit_table.hpp"

#include <algorithm>

namespace dartcast::detail {

namespace {

// The number of the corner that is this point.
std::uint8_t corner_at(const ImplicitSimplex& s, const std::array<std::uint8_t, 3>& corners, std::uint16_t point) {
  std::uint8_t i = 0;
  while (i < 2 && s.vertex[corners[i]] != point) ++i;
  return i;
}

std::uint16_t row_of(const Across& at) { return static_cast<std::uint16_t>(4U * at.index + at.place); }

}  // namespace

ExitTable::ExitTable(const Shape& shape) {
  const std::vector<ImplicitSimplex>& simplices = shape.simplices();
  const bool flat = simplices[0].vertex[0] == simplices[0].vertex[1];
  if (shape.dimension() != 3 || flat || simplices.size() > max_simplices) return;
  add_rows(shape);
  add_faces(shape);
  cell_rows_ = CellRows(shape);
}

void ExitTable::add_rows(const Shape& shape) {
  for (const ImplicitSimplex& s : shape.simplices()) {
    for (unsigned facet = 0; facet < 4; ++facet) {
      const Across across = s.across[facet];
      SimplexExit& exit = exits_.emplace_back();
      if (across.outer()) {
        const std::uint16_t face = across.face();
        exit.place = shape.triangle_from_other_side(face, across.place);
        exit.word = static_cast<std::uint16_t>(2U + shape.point_count() + face);
        exit.extra = static_cast<std::uint16_t>(exit.word + shape.face_count());
        exit.outer = 1;
        exit.face_shift = static_cast<std::uint8_t>(3U * face);
        exit.wall_shift = static_cast<std::uint8_t>(18U + face);
        exit.turn = corner_at(s, exit_corners(facet), shape.triangle(face, across.place)[0]);
      } else {
        const ImplicitSimplex& next = shape.simplices()[across.index];
        exit.place = row_of(across);
        exit.turn = corner_at(s, exit_corners(facet), next.vertex[facet_corners[across.place][0]]);
      }
      entries_.push_back({static_cast<std::uint16_t>(4U * entries_.size()), s.vertex[facet]});
    }
  }
}

void ExitTable::add_faces(const Shape& shape) {
  first_.push_back(0);
  for (std::uint16_t face = 0; face < shape.face_count(); ++face) {
    first_.push_back(static_cast<std::uint16_t>(entries_.size()));
    for (std::uint16_t t = 0; t < shape.triangle_count(face); ++t) {
      const Across at = shape.entry(face, t);
      const ImplicitSimplex& s = shape.simplices()[at.index];
      const unsigned turn = corner_at(s, facet_corners[at.place], shape.triangle(face, t)[0]);
      entries_.push_back({static_cast<std::uint16_t>(4U * row_of(at) + turn), s.vertex[at.place]});
    }
  }
}

}  // namespace dartcast::detail
