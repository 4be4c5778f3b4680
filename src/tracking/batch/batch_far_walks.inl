// Walks to targets that are far away, along their lines (batch_line_walks.inl): many in turn, so that memory is
// prefetched. Walks that are undecided there are left to rounds (batch_walk.inl). Part of the batch's kernel
// (tracking/batch/batch_kernel.inl).
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "tracking/batch/batch_cell_walks.inl"
#include "tracking/batch/batch_line_walks.inl"
#include "tracking/batch/batch_slice_walks.inl"
#include "tracking/batch/batch_steps.inl"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// The far walks: simplices of all; then, in turns, whole cells and simplices of those that pass cells; or, where vertices
// move, those that walk apart.
template <CacheKind kind>
void Batch<kind>::walk_lines() {
  line_arrivals_ = 0;
  to_cells_ = 0;
  for (LinePlace& at : line_places_) at.corner = now_;  // lanes without a walk read it, too
  for (std::uint32_t pool = 0; pool < CombinatorialMap::general_pool; ++pool)
    record_pools_[pool] = {map_.record(Cell(pool, 0)), map_.record_stride(pool)};
  begin_lines(far_walks_.data(), far_count_);
  pass_simplices<LineKind::to_target>([&](std::uint32_t l) { return start_next_line(l); });
  if constexpr (moved)
    walk_first_slices();
  else
    walk_farther();
  if constexpr (kind != CacheKind::none) cache_line_arrivals();
}

// The walks in farther_walks_. They pass simplices up to their first hexahedron, and wherever a cell is undecided.
template <CacheKind kind>
void Batch<kind>::walk_farther() {
  if (farther_count_ == 0) return;
  begin_lines(farther_walks_.data(), farther_count_);
  pass_simplices<LineKind::to_cells>([&](std::uint32_t l) {
    const bool begins = start_next_line(l);
    set_to_cells(l, begins && in_range_of_floats(line_walks_[l / 4].line, l % 4));
    return begins;
  });
  while (by_cells_.written != 0) {
    by_cells_.read_again();
    walk_cells();
    by_cells_.read_again();
    staged_ = 0;
    pass_simplices<LineKind::to_cells>([&](std::uint32_t l) { return resume_next_line(l); });
  }
}

// Walks to begin next.
template <CacheKind kind>
inline void Batch<kind>::begin_lines(const WalkStart* walks, std::size_t count) {
  walk_starts_ = walks;
  walk_start_count_ = count;
  next_line_ = staged_ = 0;
}

// Walks that start_next(lane) begins. In turns, each of three passes: the new corners of all walks are found, and
// prefetched; four walks at a time pass their simplices, and their next cells are prefetched; walks that may have ended,
// or those that go on to pass cells, are looked at.
template <CacheKind kind>
template <LineKind line, class StartNext>
inline void Batch<kind>::pass_simplices(const StartNext& start_next) {
  std::uint32_t live = 0;
  for (std::uint32_t l = 0; l < lines; ++l) live |= (start_next(l) ? 1U : 0U) << l;
  while (live != 0) {
    if (++turns_ % turns_at_once == 0) [[unlikely]]
      live = stop_lines(live, start_next);
    for (std::uint32_t left = live; left != 0; left &= left - 1) {
      const auto l = static_cast<std::uint32_t>(std::countr_zero(left));
      if (!find_corners<line>(l, start_next)) live ^= 1U << l;
    }
    std::uint32_t marked = 0;
    for (std::uint32_t l = 0; l < lines; l += 4) {
      const std::uint32_t here = (live >> l) & 15U;
      if (here != 0) marked |= pass_four<line>(l, here) << l;
    }
    for (; marked != 0; marked &= marked - 1) {
      const auto l = static_cast<std::uint32_t>(std::countr_zero(marked));
      if (!goes_on<line>(l) && !start_next(l)) live ^= 1U << l;
    }
  }
}

// Leaves to Stepper the walks that have asked more tests than any can. Returns the lanes that still have a walk.
template <CacheKind kind>
template <class StartNext>
std::uint32_t Batch<kind>::stop_lines(std::uint32_t live, const StartNext& start_next) {
  for (std::uint32_t l = 0; l < lines; ++l) {
    const LinePlace& at = line_places_[l];
    if (((live >> l) & 1U) == 0 || at.tests + 3ULL * at.passed <= most_line_tests_) continue;
    defer(at.particle);
    if (!start_next(l)) live ^= 1U << l;
  }
  return live;
}

// Finds the new corner of the walk in lane l, or of the first one after it that has one. Returns false where there is
// none.
template <CacheKind kind>
template <LineKind line, class StartNext>
inline bool Batch<kind>::find_corners(std::uint32_t l, const StartNext& start_next) {
  LinePlace& at = line_places_[l];
  while (!find_corner(at, map_, now_)) {
    if constexpr (line == LineKind::apart)
      defer(at.particle);
    else
      leave_unlisted(at);
    if (!start_next(l)) return false;
  }
  if constexpr (line == LineKind::apart) {
    const Vec3* const was = before_move(at.corner);
    __builtin_prefetch(was);
    __builtin_prefetch(&was->z);
  }
  return true;
}

// Prepares four walks from number next_line_ on.
template <CacheKind kind>
inline void Batch<kind>::stage_lines() {
  const std::size_t end = std::min(next_line_ + block, walk_start_count_);
  for (std::size_t k = std::min(next_line_ + block - 4, end); k < end; ++k) {
    __builtin_prefetch(walk_starts_[k].record);
    prefetch(now_, vertices_[walk_starts_[k].particle]);
  }
  const std::size_t last = walk_start_count_ - 1;
  const auto particle = [&](std::size_t k) { return walk_starts_[std::min(next_line_ + k, last)].particle; };
  const Index4 i = {{particle(0), particle(1), particle(2), particle(3)}};
  const Corners4 v = simplices_of(now_, i);
  line_starts_ = LineStarts4(v, starts_of(i, v), targets_of(i));
  staged_ = next_line_ + 4;
}

// Begins the next walk that can begin, in lane l. Returns false where there is none.
template <CacheKind kind>
inline bool Batch<kind>::start_next_line(std::uint32_t l) {
  while (next_line_ < walk_start_count_) {
    if (next_line_ == staged_) stage_lines();
    const auto [i, record] = walk_starts_[next_line_];
    const auto from = static_cast<unsigned>(next_line_ + 4 - staged_);
    ++next_line_;
    if (start_line(l, i, record, from)) return true;
    add_to_rounds(first_cursor(i, states_[i], record, 1, 0));
  }
  return false;
}

template <CacheKind kind>
inline bool Batch<kind>::start_line(std::uint32_t l, std::uint32_t i, const std::uint32_t* record, unsigned from) {
  const unsigned facet = facets_entered[static_cast<std::size_t>(line_starts_.turns[from])];
  if (facet == no_facet || line_starts_.in_range[from] == 0) return false;
  LineWalks4& walks = line_walks_[l / 4];
  walks.begin(l % 4, line_starts_, from, facet);
  LinePlace& at = line_places_[l];
  at.record = record;
  at.particle = i;
  at.cell = states_[i].cell.value;
  at.passed = 0;
  at.tests = 1;  // with the three of the simplex: the sides of all its facets
  at.face = 0;
  at.place = 4U * states_[i].simplex + facet;
  at.turn = 0;
  return walks.is_inside(l % 4);
}

// Resumes the next walk that has passed cells, in lane l. Returns false where there is none.
template <CacheKind kind>
inline bool Batch<kind>::resume_next_line(std::uint32_t l) {
  if (by_cells_.next == by_cells_.count) return false;
  if (by_cells_.next == staged_) stage_resumed_lines();
  const auto from = static_cast<unsigned>(by_cells_.next + 4 - staged_);
  const CellWalk& walk = by_cells_.take();
  if (walk.tests + 3ULL * walk.passed > most_line_tests_) [[unlikely]] {
    defer(walk.particle);
    return resume_next_line(l);
  }
  line_walks_[l / 4].go_on(l % 4, resumed_lines_, from);
  LinePlace& at = line_places_[l];
  at.record = walk.record;
  at.particle = walk.particle;
  at.cell = walk.cell;
  at.passed = walk.passed;
  at.tests = walk.tests;
  at.face = 0;
  at.place = row_behind(walk);
  at.turn = 0;
  set_to_cells(l, walk.to_cells);
  return true;
}

// Prepares four walks.
template <CacheKind kind>
inline void Batch<kind>::stage_resumed_lines() {
  const Index4 k = by_cells_.next_four();
  VertexNumbers triangle[4];
  for (unsigned l = 0; l < 4; ++l) {
    const CellWalk& walk = by_cells_.walks[k.at[l]];
    const unsigned row = row_behind(walk);
    const Shape& shape = map_.view(Cell(walk.cell), walk.record).shape();
    for (unsigned i = 0; i < 3; ++i)
      triangle[l][i] = walk.record[2U + shape.simplices()[row / 4].vertex[facet_corners[row % 4][i]]];
  }
  Vec3x4 corner[3];
  for (unsigned i = 0; i < 3; ++i)
    corner[i] = load_vec3x4(now_[triangle[0][i]], now_[triangle[1][i]], now_[triangle[2][i]], now_[triangle[3][i]]);
  const Index4 particles = by_cells_.particles(k);
  resumed_lines_ = LineResumptions4(places_of(particles), targets_of(particles), by_cells_.reaches(k), corner);
  staged_ = by_cells_.next + 4;
}

// 4 * simplex + facet, behind the triangle that the walk has entered its cell by.
template <CacheKind kind>
inline unsigned Batch<kind>::row_behind(const CellWalk& walk) const {
  const Across at = map_.view(Cell(walk.cell), walk.record).shape().entry(walk.face, walk.triangle);
  return 4U * at.index + at.place;
}

template <CacheKind kind>
inline void Batch<kind>::set_to_cells(std::uint32_t l, bool to_cells) {
  to_cells_ = (to_cells_ & ~(1U << l)) | (to_cells ? 1U : 0U) << l;
}

// Passes a simplex of each walk in the lanes from l on that are in the mask `live`. Returns a mask of those to look at.
template <CacheKind kind>
template <LineKind line>
[[gnu::always_inline]] inline std::uint32_t Batch<kind>::pass_four(std::uint32_t l, std::uint32_t live) {
  LineWalks4& walks = line_walks_[l / 4];
  LinePlace* const at = &line_places_[l];
  if constexpr (line == LineKind::apart)
    walks.pass(corners_in_slices(at, l));
  else
    walks.pass(load_vec3x4(*at[0].corner, *at[1].corner, *at[2].corner, *at[3].corner));
  std::uint32_t walls = 0;
  std::uint32_t crossed = 0;
  for (std::uint32_t k = 0; k < 4; ++k) {
    if (((live >> k) & 1U) == 0) continue;
    walls |= leave(at[k], static_cast<unsigned>(walks.slot[k]), map_, record_pools_.data()) << k;
    if constexpr (line == LineKind::to_cells) crossed |= (at[k].face != 0 ? 1U : 0U) << k;
  }
  at_wall_lanes_[l / 4] = walls;
  return (walks.undecided | walks.near_end | walls | (crossed & (to_cells_ >> l))) & live;
}

// Looks at a walk that needs it. Returns whether it goes on.
template <CacheKind kind>
template <LineKind line>
inline bool Batch<kind>::goes_on(std::uint32_t l) {
  LinePlace& at = line_places_[l];
  const LineWalks4& walks = line_walks_[l / 4];
  constexpr bool apart = line == LineKind::apart;
  if (((walks.undecided >> (l % 4)) & 1U) != 0) return apart ? defer(at.particle) : leave_to_rounds(at);
  if (((walks.near_end >> (l % 4)) & 1U) != 0) {
    const int side = walks.side_of_target(l % 4);
    if (side == 0) return apart ? defer(at.particle) : leave_to_rounds(at);
    at.tests += at.passed > 1 ? 1 : 0;  // in the first simplex the sides of all facets are counted
    if (side > 0) return apart ? end_slice(l, false) : arrive_by_line(passed_cursor(at));
    if constexpr (line == LineKind::to_cells) set_to_cells(l, false);
  }
  if (((at_wall_lanes_[l / 4] >> (l % 4)) & 1U) != 0) {
    if (apart) return end_slice(l, true);
    const WalkCursor cursor = passed_cursor(at);
    return end_at_wall(cursor, corners_of_walk(cursor), at.exit_facet);
  }
  if constexpr (line == LineKind::to_cells) {
    if (((to_cells_ >> l) & 1U) != 0 && at.face != 0 && Cell(at.cell).pool() == hexahedra) return leave_to_cells(l);
  }
  return true;
}

// Returns false: the walk does not go on from simplex to simplex.
template <CacheKind kind>
inline bool Batch<kind>::leave_to_cells(std::uint32_t l) {
  const LinePlace& at = line_places_[l];
  const auto face = static_cast<std::uint16_t>(at.face - 1);
  const auto triangle = static_cast<std::uint16_t>(at.place);
  by_cells_.add({at.record, line_walks_[l / 4].line.reach[l % 4], at.particle, at.cell, face, triangle, at.passed,
                 at.tests, true});
  return false;
}

// In the simplex that the walk has passed.
template <CacheKind kind>
inline WalkCursor Batch<kind>::passed_cursor(const LinePlace& at) const {
  const unsigned entered_by = at.passed == 1 ? no_facet : at.row % 4;
  return {at.particle,
          at.passed_cell,
          static_cast<std::uint16_t>(at.row / 4),
          static_cast<std::uint16_t>(entered_by),
          at.tests + 3 * at.passed,
          0,
          entered,
          map_.record(Cell(at.passed_cell))};
}

// Returns false: the walk does not go on along its line. The rounds test, and count, the simplex that it has passed.
template <CacheKind kind>
inline bool Batch<kind>::leave_to_rounds(const LinePlace& at) {
  WalkCursor cursor = passed_cursor(at);
  cursor.tests -= 3;
  add_to_rounds(cursor);
  return false;
}

// Leaves a walk to rounds that has come to a shape without a table, or begins in one.
template <CacheKind kind>
void Batch<kind>::leave_unlisted(const LinePlace& at) {
  const auto place = static_cast<std::uint16_t>(at.place);
  const auto face = static_cast<std::uint16_t>(at.face);
  add_to_rounds({at.particle, at.cell, 0, place, at.tests + 3 * at.passed, 0, face, at.record});
}

template <CacheKind kind>
[[gnu::always_inline]] inline VertexNumbers Batch<kind>::corners_of_walk(const WalkCursor& cursor) const {
  const CellView cell = map_.view(Cell(cursor.cell), cursor.record);
  const auto& local = cell.shape().simplices()[cursor.index].vertex;
  return {cell.vertex(local[0]).value, cell.vertex(local[1]).value, cell.vertex(local[2]).value,
          cell.vertex(local[3]).value};
}

// Returns false: the walk does not go on.
template <CacheKind kind>
inline bool Batch<kind>::arrive_by_line(const WalkCursor& cursor) {
  end(cursor);
  vertices_[cursor.particle] = corners_of_walk(cursor);
  line_arrival_[line_arrivals_] = cursor.particle;
  line_arrivals_ += moved || (kind == CacheKind::barycentric && needs_coordinates(cursor)) ? 1 : 0;
  return false;
}

// As cache_arrivals().
template <CacheKind kind>
inline void Batch<kind>::cache_line_arrivals() {
  SimplexCache4 four;
  for (std::uint32_t a = 0; a < line_arrivals_; a += 4) {
    const Index4 at = index4_from(a, line_arrivals_);
    const Index4 i = {
        {line_arrival_[at.at[0]], line_arrival_[at.at[1]], line_arrival_[at.at[2]], line_arrival_[at.at[3]]}};
    const Vec3x4 q = targets_of(i);
    const BatchDeterminants d(simplices_of(now_, i), q);
    if constexpr (moved) store_previous_geometry(d, four);
    if constexpr (kind == CacheKind::barycentric) store_barycentric<false>(d, q, four);
    for (std::uint32_t l = 0; l < std::min(line_arrivals_ - a, 4U); ++l)
      caches_[i.at[l] / 4].put(i.at[l] % 4, four.of(l));
  }
}

// As start_of(), of four.
template <CacheKind kind>
inline Vec3x4 Batch<kind>::starts_of(const Index4& i, const Corners4& now) const {
  if constexpr (!moved) return places_of(i);
  return carry_along(determinants_of(previous_determinants_.data(), i).of_corner, now);
}

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
