// The counts of far walks: the code of the batch's own walks along lines (batch_line_walks.inl, batch_cell_lanes.inl),
// with the same walk in all lanes. A line is projected anew in each simplex, because few walks leave a rank.
#include <algorithm>
#include <cmath>

#include "complex/simplex.hpp"
#include "tracking/batch/batch_cell_lanes.inl"
#include "tracking/batch/batch_line_walks.inl"
#include "tracking/batch/coordinate_bounds.hpp"
#include "tracking/batch/far_walk_counts.hpp"

namespace dartcast::detail {

namespace {

using By = FarWalk::By;
using portable::CellWalks8;
using portable::LineStarts4;
using portable::LineWalks4;
using portable::Vec3x4;

constexpr unsigned all_facets = 15;
constexpr unsigned none = 4;

Vec3x4 in_all_lanes(const Vec3& x) { return portable::load_vec3x4(x, x, x, x); }

// A walk along the line, in the simplex behind this triangle.
LineWalks4 walk_behind(const std::array<Vec3, 3>& triangle, const Vec3& p, const Vec3& q, double reach) {
  const Vec3x4 corner[3] = {in_all_lanes(triangle[0]), in_all_lanes(triangle[1]), in_all_lanes(triangle[2])};
  const portable::LineResumptions4 lines(in_all_lanes(p), in_all_lanes(q), portable::splat(reach), corner);
  LineWalks4 walk;
  for (unsigned l = 0; l < 4; ++l) walk.go_on(l, lines, l);
  return walk;
}

// A walk through the hexahedron that it has entered by this face.
CellWalks8 walk_through(const CellView& cell, const CellRow& row, const Vec3* positions, const Vec3& p, const Vec3& q,
                        double reach) {
  portable::CellStarts4 starts;
  starts.line = portable::Lines4(in_all_lanes(p), in_all_lanes(q));
  starts.line.reach_to(portable::splat(reach));
  portable::FarCorners8 far;
  far.diagonals = portable::splat_int(static_cast<int>(row.diagonals));
  for (unsigned i = 0; i < 4; ++i) {
    starts.near[i] = starts.line.project(in_all_lanes(positions[cell.vertex(row.near[i]).value]));
    std::fill_n(far.at[i], 8, positions + cell.vertex(row.far[i]).value);
  }
  CellWalks8 walk;
  for (unsigned l = 0; l < 8; ++l) walk.begin(l, starts, l % 4);
  walk.pass(far);
  return walk;
}

unsigned place_in(const VertexNumbers& v, std::uint32_t vertex) {
  return static_cast<unsigned>(std::find(v.begin(), v.end(), vertex) - v.begin());
}

// The corner of a simplex that is not in the triangle.
unsigned apex_of(const VertexNumbers& v, const std::array<std::uint32_t, 3>& triangle) {
  unsigned i = 0;
  while (std::find(triangle.begin(), triangle.end(), v[i]) != triangle.end()) ++i;
  return i;
}

}  // namespace

// As Batch::carry_four() and Batch::add_part_walk().
void FarWalkCounts::begin(SimplexId start, bool carried) {
  const VertexNumbers v = vertex_numbers(complex_, start);
  const Corners corners = portable::corners_of(positions_, v);
  const Determinants determinants(corners, q_);
  if (!portable::is_far_away(determinants)) return;
  scalar_before_ = scalar_;
  in_first_ = true;
  const bool alone = carried && (positions_.s < 1.0 || !Determinants(corners, p_).all_proved_positive());
  if (!alone) go_to_rounds();
  if (complex_.map().view(start.cell).shape().exits().empty()) return;
  const portable::Corners4 lanes(corners.data(), {0, 1, 2, 3}, {0, 1, 2, 3}, {0, 1, 2, 3}, {0, 1, 2, 3});
  const LineStarts4 starts(lanes, in_all_lanes(p_), in_all_lanes(q_));
  const unsigned facet = portable::facets_entered[static_cast<std::size_t>(starts.turns[0])];
  if (facet == none || starts.in_range[0] == 0) return;
  LineWalks4 walk;
  walk.begin(0, starts, 0, facet);
  if (!walk.is_inside(0)) return;
  for (unsigned i = 0; i < 3; ++i) triangle_[i] = v[facet_corners[facet][i]];
  const bool to_cells = portable::is_far_away(determinants, farther_coordinate) &&
                        portable::are_known_positive(complex_) && portable::in_range_of_floats(starts.line, 0);
  now_.by = to_cells ? By::line_to_cells : alone ? By::line_alone : By::line;
  now_.reach = starts.line.reach[0];
  now_.counts = {1, 0};  // with the three of the simplex: the sides of all its facets
}

void FarWalkCounts::go_on(const FarWalk& walk, SimplexId left, unsigned facet) {
  now_ = walk;
  scalar_before_ = scalar_;
  const VertexNumbers v = vertex_numbers(complex_, left);
  enters_cell_ = true;
  if (now_.by_line()) {
    for (unsigned i = 0; i < 3; ++i) triangle_[i] = v[now_.slots[i]];
  } else {
    for (unsigned i = 0; i < 3; ++i) triangle_[i] = v[facet_corners[facet][i]];
  }
}

void FarWalkCounts::pass(SimplexId simplex, unsigned facet) {
  const VertexNumbers v = vertex_numbers(complex_, simplex);
  look_at(simplex, v);
  for (unsigned i = 0; i < 3; ++i) {
    if (!now_.by_line()) triangle_[i] = v[facet_corners[facet][i]];
    now_.slots[i] = static_cast<std::uint8_t>(place_in(v, triangle_[i]));
  }
  scalar_before_ = scalar_;
  in_first_ = false;
  enters_cell_ = complex_.map().view(simplex.cell).shape().simplices()[simplex.simplex].across[facet].outer();
}

void FarWalkCounts::end(const Walk& walk) {
  if (now_.by == By::determinants || walk.end == WalkEnd::wall) return;
  if (walk.end == WalkEnd::invalid_cell) now_ = {};
  if (walk.end == WalkEnd::arrived) look_at(walk.simplex, vertex_numbers(complex_, walk.simplex));
}

// A batch leaves the step to one particle's walk where a sign is not known in a round.
void FarWalkCounts::look_at(SimplexId simplex, const VertexNumbers& v) {
  const bool is_first_round = in_first_ && now_.by == By::rounds;
  const unsigned apex = is_first_round ? none : apex_of(v, triangle_);
  if (enters_cell_ && (now_.by == By::line_to_cells || now_.by == By::cells)) look_at_cell(simplex, v, apex);
  if (now_.by == By::cells) return;
  if (now_.by_line() && complex_.map().view(simplex.cell).shape().exits().empty()) go_to_rounds();
  if (now_.by_line()) look_along_line(v, apex);
  const unsigned tested = in_first_ ? all_facets : all_facets & ~(1U << apex);
  if (now_.by == By::rounds && !is_known_in_rounds(v, tested)) now_ = {};
}

// As Batch::leave_cells().
void FarWalkCounts::look_at_cell(SimplexId entered, const VertexNumbers& v, unsigned facet) {
  const bool is_hexahedron = entered.cell.pool() == portable::hexahedra;
  if (!is_hexahedron && now_.by == By::line_to_cells) return;
  for (unsigned i = 0; i < 3; ++i) triangle_[i] = v[facet_corners[facet][i]];
  now_.by = By::line_to_cells;
  if (!is_hexahedron) return;
  const CellView cell = complex_.map().view(entered.cell);
  const std::uint16_t face = cell.shape().simplices()[entered.simplex].across[facet].face();
  const CellWalks8 walk =
      walk_through(cell, cell.shape().exits().cell_rows()[4U * face], positions_.to, p_, q_, now_.reach);
  if ((walk.undecided & 1U) != 0) return;
  now_.by = (walk.near_end & 1U) != 0 ? By::line : By::cells;
  if (now_.by == By::cells) now_.counts.tests += CellWalks8::sides_asked;
}

// As Batch::goes_on().
void FarWalkCounts::look_along_line(const VertexNumbers& v, unsigned apex) {
  const auto at = [&](std::uint32_t vertex) { return positions_[Vertex{vertex}]; };
  LineWalks4 walk = walk_behind({at(triangle_[0]), at(triangle_[1]), at(triangle_[2])}, p_, q_, now_.reach);
  walk.pass(in_all_lanes(at(v[apex])));
  const bool near_end = (walk.near_end & 1U) != 0;
  if ((walk.undecided & 1U) != 0 || (near_end && walk.side_of_target(0) == 0)) return go_to_rounds();
  if (near_end && now_.by == By::line_to_cells) now_.by = By::line;
  now_.counts.tests += near_end && !in_first_ ? 4 : 3;
  triangle_[static_cast<std::size_t>(walk.slot[0])] = v[apex];
}

// In the next simplex. Those of the first one are not asked twice.
void FarWalkCounts::go_to_rounds() {
  if (now_.by == By::line_alone) {
    now_ = {};
    return;
  }
  const TestCounts so_far = in_first_ ? TestCounts{} : now_.counts;
  now_.by = By::rounds;
  now_.counts = {so_far.tests - scalar_before_.tests, so_far.exact - scalar_before_.exact};
}

// As FacetSigns4::is_known() in batch_simplex.inl.
bool FarWalkCounts::is_known_in_rounds(const VertexNumbers& v, unsigned tested) const {
  const Corners corners = portable::corners_of(positions_, v);
  const Determinants d(corners, q_);
  unsigned open = 0;
  for (unsigned i = 0; i < 4; ++i) open |= d.decides(i) ? 0U : 1U << i;
  if (!d.all_proved_positive() && !d.proves_positive()) return false;
  return (open & tested) == 0 || d.exact(corners, q_);
}

}  // namespace dartcast::detail
