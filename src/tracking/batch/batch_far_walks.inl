// Walks to targets that are far away, along their lines (batch_line_walks.inl): many in turn, so that memory is
// prefetched. Walks that are undecided there are left to rounds (batch_walk.inl). Part of the batch's kernel
// (tracking/batch/batch_kernel.inl).
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "tracking/batch/batch_line_walks.inl"
#include "tracking/batch/batch_steps.inl"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// The walks in far_walks_. In turns, each of three passes: the new corners of all walks are found, and prefetched; four
// walks at a time pass their simplices, and their next cells are prefetched; walks that may have ended are looked at.
template <CacheKind kind>
void Batch<kind>::walk_lines() {
  next_line_ = staged_ = 0;
  line_arrivals_ = 0;
  for (LinePlace& at : line_places_) at.corner = now_;  // lanes without a walk read it, too
  for (std::uint32_t pool = 0; pool < CombinatorialMap::general_pool; ++pool)
    record_pools_[pool] = {map_.record(Cell(pool, 0)), map_.record_stride(pool)};
  std::uint32_t live = 0;
  for (std::uint32_t l = 0; l < lines; ++l) live |= (start_next_line(l) ? 1U : 0U) << l;
  while (live != 0) {
    for (std::uint32_t left = live; left != 0; left &= left - 1) {
      const auto l = static_cast<std::uint32_t>(std::countr_zero(left));
      if (!find_corners(l)) live ^= 1U << l;
    }
    std::uint32_t marked = 0;
    for (std::uint32_t l = 0; l < lines; l += 4) {
      const std::uint32_t here = (live >> l) & 15U;
      if (here != 0) marked |= pass_simplices(l, here) << l;
    }
    for (; marked != 0; marked &= marked - 1) {
      const auto l = static_cast<std::uint32_t>(std::countr_zero(marked));
      if (!goes_on(l) && !start_next_line(l)) live ^= 1U << l;
    }
  }
  if constexpr (kind != CacheKind::none) cache_line_arrivals();
}

// Finds the new corner of the walk in lane l, or of the first one after it that has one. Returns false where there is
// none.
template <CacheKind kind>
inline bool Batch<kind>::find_corners(std::uint32_t l) {
  while (!find_corner(line_places_[l], map_, now_)) {
    leave_unlisted(line_places_[l]);
    if (!start_next_line(l)) return false;
  }
  return true;
}

// Prepares four walks from number next_line_ on.
template <CacheKind kind>
inline void Batch<kind>::stage_lines() {
  const std::size_t end = std::min(next_line_ + block, far_count_);
  for (std::size_t k = std::min(next_line_ + block - 4, end); k < end; ++k) {
    __builtin_prefetch(far_walks_[k].record);
    prefetch(now_, vertices_[far_walks_[k].particle]);
  }
  const std::size_t last = far_count_ - 1;
  const auto particle = [&](std::size_t k) { return far_walks_[std::min(next_line_ + k, last)].particle; };
  const Index4 i = {{particle(0), particle(1), particle(2), particle(3)}};
  const Corners4 v = simplices_of(now_, i);
  line_starts_ = LineStarts4(v, starts_of(i, v), targets_of(i));
  staged_ = next_line_ + 4;
}

// Begins the next walk that can begin, in lane l. Returns false where there is none.
template <CacheKind kind>
inline bool Batch<kind>::start_next_line(std::uint32_t l) {
  while (next_line_ < far_count_) {
    if (next_line_ == staged_) stage_lines();
    const auto [i, record] = far_walks_[next_line_];
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

// Passes a simplex of each walk in the lanes from l on that are in the mask `live`. Returns a mask of those to look at.
template <CacheKind kind>
[[gnu::always_inline]] inline std::uint32_t Batch<kind>::pass_simplices(std::uint32_t l, std::uint32_t live) {
  LineWalks4& walks = line_walks_[l / 4];
  LinePlace* const at = &line_places_[l];
  walks.pass(load_vec3x4(*at[0].corner, *at[1].corner, *at[2].corner, *at[3].corner));
  std::uint32_t walls = 0;
  for (std::uint32_t k = 0; k < 4; ++k) {
    if (((live >> k) & 1U) == 0) continue;
    walls |= leave(at[k], static_cast<unsigned>(walks.slot[k]), map_, record_pools_.data()) << k;
  }
  at_wall_lanes_[l / 4] = walls;
  return (walks.undecided | walks.near_end | walls) & live;
}

// Looks at a walk that needs it. Returns whether it goes on.
template <CacheKind kind>
inline bool Batch<kind>::goes_on(std::uint32_t l) {
  LinePlace& at = line_places_[l];
  const LineWalks4& walks = line_walks_[l / 4];
  if (((walks.undecided >> (l % 4)) & 1U) != 0) return leave_to_rounds(at);
  if (((walks.near_end >> (l % 4)) & 1U) != 0) {
    const int side = walks.side_of_target(l % 4);
    if (side == 0) return leave_to_rounds(at);
    at.tests += at.passed > 1 ? 1 : 0;  // in the first simplex the sides of all facets are counted
    if (side > 0) return arrive_by_line(passed_cursor(at));
  }
  if (((at_wall_lanes_[l / 4] >> (l % 4)) & 1U) == 0) return true;
  const WalkCursor cursor = passed_cursor(at);
  return end_at_wall(cursor, corners_of_walk(cursor), at.exit_facet);
}

// In the simplex that the walk has passed.
template <CacheKind kind>
inline WalkCursor Batch<kind>::passed_cursor(const LinePlace& at) const {
  const unsigned entered_by = at.passed == 1 ? no_facet : at.row % 4;
  return {at.particle,
          at.passed_cell,
          static_cast<std::uint16_t>(at.row / 4),
          static_cast<std::uint16_t>(entered_by),
          static_cast<std::uint16_t>(at.tests + 3 * at.passed),
          0,
          entered,
          map_.record(Cell(at.passed_cell))};
}

// Returns false: the walk does not go on along its line. The rounds test, and count, the simplex that it has passed.
template <CacheKind kind>
inline bool Batch<kind>::leave_to_rounds(const LinePlace& at) {
  WalkCursor cursor = passed_cursor(at);
  cursor.tests = static_cast<std::uint16_t>(cursor.tests - 3);
  add_to_rounds(cursor);
  return false;
}

// The same where the walk has come to a shape without a table, or begins in one.
template <CacheKind kind>
void Batch<kind>::leave_unlisted(const LinePlace& at) {
  WalkCursor cursor = passed_cursor(at);
  cursor.cell = at.cell;
  cursor.record = at.record;
  cursor.face = static_cast<std::uint16_t>(at.face);
  cursor.place = static_cast<std::uint16_t>(at.place);
  add_to_rounds(cursor);
}

template <CacheKind kind>
inline VertexNumbers Batch<kind>::corners_of_walk(const WalkCursor& cursor) const {
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
  const auto* const d = previous_determinants_.data();
  const Double4 w[4] = {determinants_of(d, i, 0), determinants_of(d, i, 1), determinants_of(d, i, 2),
                        determinants_of(d, i, 3)};
  return carry_along(w, now);
}

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
