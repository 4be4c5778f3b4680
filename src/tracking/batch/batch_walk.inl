// Walks beyond their first simplex, one simplex of each walk in a round. Part of the batch's kernel
// (tracking/batch/batch_kernel.inl).
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <new>
#include <optional>

#include "dartcast/predicates.hpp"
#include "tracking/batch/batch_steps.inl"
#include "tracking/walk.hpp"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// The next simplex of every walk. Returns the number of walks that go on.
template <CacheKind kind>
inline std::size_t Batch<kind>::walk_on(std::size_t count) {
  std::size_t next = 0;
  for (std::size_t first = 0; first < count; first += block) {
    const std::size_t n = std::min<std::size_t>(block, count - first);
    for (std::size_t k = 0; k < n; ++k) enter(walks_[first + k], k);
    for (std::size_t k = 0; k < n; k += 4) test_four(&walks_[first], k, n - 1);
    arrivals_ = 0;
    for (std::size_t k = 0; k < n; ++k) {
      WalkCursor& cursor = walks_[next] = walks_[first + k];
      cursor.tests += 3;
      if (FacetSigns4(signs_[k]).is_inside()) {
        arrive(cursor, corners_[k], k);
      } else if (leave_simplex(cursor, corners_[k], k)) {
        ++next;
      }
    }
    if constexpr (kind != CacheKind::none) cache_arrivals();
  }
  return next;
}

// The ways through a cell of a standard type. Null for others: many have shapes of their own, and tables take memory.
[[gnu::always_inline]] inline const ExitTable* table_of(std::uint32_t cell, const Shape& shape) {
  if (Cell(cell).pool() == CombinatorialMap::general_pool) return nullptr;
  const ExitTable& table = shape.exits();
  return table.empty() ? nullptr : &table;
}
// The row without a table.
[[gnu::always_inline]] inline unsigned general_row(const Shape& shape, const WalkCursor& cursor) {
  if (cursor.face == 0) return cursor.place;
  const Across at = shape.entry(static_cast<std::uint16_t>(cursor.face - 1), cursor.place);
  return 4U * at.index + at.place;
}

// Finds the simplex behind the facet that the walk passes, and prefetches its new corner. k: its place in the block.
template <CacheKind kind>
inline void Batch<kind>::enter(WalkCursor& cursor, std::size_t k) {
  VertexNumbers& corners = corners_[k];
  const CellView cell = map_.view(Cell(cursor.cell), cursor.record);
  const Shape& shape = cell.shape();
  const ExitTable* const table = table_of(cursor.cell, shape);
  if (cursor.face != entered) {
    const unsigned row = table != nullptr ? table->entry(cursor.face, cursor.place).row() : general_row(shape, cursor);
    cursor.index = static_cast<std::uint16_t>(row / 4);
    cursor.place = static_cast<std::uint16_t>(row % 4);
    cursor.face = entered;
  }
  exits_here_[k] = table != nullptr ? table->exits_of(cursor.index) : nullptr;
  if (kind == CacheKind::barycentric && cursor.place == no_facet) {  // where the step started
    corners = vertices_[cursor.particle];
    return prefetch(now_, corners);
  }
  const auto& local = shape.simplices()[cursor.index].vertex;
  for (unsigned i = 0; i < 4; ++i) corners[i] = cell.vertex(local[i]).value;
  if (cursor.place == no_facet) return prefetch(now_, corners);
  const Vec3* const apex = now_ + corners[cursor.place];
  __builtin_prefetch(apex);
  __builtin_prefetch(&apex->z);
}

template <CacheKind kind>
inline void Batch<kind>::test_four(const WalkCursor* walks, std::size_t k, std::size_t last) {
  const std::size_t k1 = std::min(k + 1, last);
  const std::size_t k2 = std::min(k + 2, last);
  const std::size_t k3 = std::min(k + 3, last);
  const Corners4 v(now_, corners_[k], corners_[k1], corners_[k2], corners_[k3]);
  const Vec3x4 q = targets_of({{walks[k].particle, walks[k1].particle, walks[k2].particle, walks[k3].particle}});
  const BatchDeterminants& d = *new (&determinants_[k / 4]) BatchDeterminants(v, q);
  store_signs(d.signs(v, q), k);
  if constexpr (kind == CacheKind::barycentric) ends_[k / 4] = q;
}

// Goes on into the next simplex if the filter decides which; else defers the step. k: its place in the block.
template <CacheKind kind>
inline bool Batch<kind>::leave_simplex(WalkCursor& cursor, const VertexNumbers& corners, std::size_t k) {
  const FacetSigns4 signs(signs_[k]);
  const unsigned tested = 15U & ~(1U << cursor.place);
  if (!signs.is_known(tested)) return defer(cursor.particle);
  const unsigned open = signs.open() & tested;
  cursor.exact += static_cast<unsigned>(std::popcount(open));
  const unsigned behind = signs.negative() & tested;
  if (behind == 0) {
    const unsigned on = signs.zero() & tested;
    if (on != 0) {
      if (const auto wall = find_touched_wall(map_, cursor, corners, on)) return end_on_wall(cursor, on, *wall);
    }
    on == 0 ? arrive(cursor, corners, k) : arrive_on_facets(cursor, corners, k, on);
    return false;
  }
  const bool single = std::has_single_bit(behind);
  const unsigned facet = single ? static_cast<unsigned>(std::countr_zero(behind)) : first_exit(cursor, corners, behind);
  return pass_on(cursor, corners, facet, exits_here_[k]);
}

// The facet by which the segment leaves, of several that the target is behind.
template <CacheKind kind>
inline unsigned Batch<kind>::first_exit(WalkCursor& cursor, const VertexNumbers& corners, unsigned behind) const {
  const std::uint32_t i = cursor.particle;
  const Vec3 p = start_of(i);
  const Vec3& q = targets_[i];
  unsigned facet = static_cast<unsigned>(std::countr_zero(behind));
  while ((behind &= behind - 1) != 0) {
    const unsigned other = static_cast<unsigned>(std::countr_zero(behind));
    const auto& edge = side_edge[facet][other];
    const Vec3& a = now_[corners[edge[0]]];
    const Vec3& b = now_[corners[edge[1]]];
    const int first = filtered_sign(a - q, p - q, b - q);
    ++cursor.tests;
    cursor.exact += first == 0 ? 1 : 0;
    if (first < 0 || (first == 0 && !passes_before(i, a, b, p, q))) facet = other;
  }
  return facet;
}

// As leaves_before() in tracking/walk.hpp, where the filter does not decide.
template <CacheKind kind>
bool Batch<kind>::passes_before(std::uint32_t i, const Vec3& a, const Vec3& b, const Vec3& p, const Vec3& q) const {
  Sign s = p == a || p == b ? Sign::zero : orient3d_exact(a, b, p, q);
  if (s == Sign::zero) {
    const Space<Stored, 4> space{&map_, {now_}, 0};
    std::optional<unsigned> zeros;
    if (kind == CacheKind::barycentric && (flags_[i] & exact_flag) != 0) zeros = flags_[i] & 15U;
    s = Ties<Stored, 4>(space, states_[i].at(), p, q, zeros).line(a, b);
  }
  return s == Sign::positive;
}

// Within the cell or out of it without a branch: none could predict which.
template <CacheKind kind>
inline bool Batch<kind>::pass_on(WalkCursor& cursor, const VertexNumbers& corners, unsigned facet,
                                 const SimplexExit* exits) {
  if (exits == nullptr) return pass_general(cursor, corners, facet);
  const SimplexExit& exit = exits[facet];
  const LineCrossing next = cross_standard(map_, cursor.cell, cursor.record, exit);
  if (next.wall != 0) return end_at_wall(cursor, corners, facet);
  cursor.cell = next.cell;
  cursor.face = static_cast<std::uint16_t>(next.face);
  cursor.place = exit.place;
  cursor.record = map_.record(Cell(next.cell));
  __builtin_prefetch(cursor.record);
  return true;
}

template <CacheKind kind>
inline bool Batch<kind>::pass_general(WalkCursor& cursor, const VertexNumbers& corners, unsigned facet) {
  const Across across = across_of(cursor, facet);
  if (across.outer()) return pass_face(cursor, corners, facet, across);
  cursor.index = across.index;
  cursor.place = across.place;
  return true;
}

// Into the cell beyond.
template <CacheKind kind>
inline bool Batch<kind>::pass_face(WalkCursor& cursor, const VertexNumbers& corners, unsigned facet, Across across) {
  const CellView cell = map_.view(Cell(cursor.cell), cursor.record);
  const std::uint16_t face = across.face();
  if (cell.is_wall(face)) return end_at_wall(cursor, corners, facet);
  cursor.cell = cell.neighbour(face).value;
  cursor.face = static_cast<std::uint16_t>(1 + cell.neighbour_face(face));
  cursor.place = cell.shape().triangle_from_other_side(face, across.place);
  cursor.record = map_.record(Cell(cursor.cell));
  __builtin_prefetch(cursor.record);
  return true;
}

template <CacheKind kind>
inline void Batch<kind>::arrive(const WalkCursor& cursor, const VertexNumbers& corners, std::size_t k) {
  end(cursor);
  vertices_[cursor.particle] = corners;
  arrival_[arrivals_] = {cursor.particle, static_cast<std::uint32_t>(k)};
  arrivals_ += kind != CacheKind::barycentric || needs_coordinates(cursor) ? 1 : 0;
}

template <CacheKind kind>
inline void Batch<kind>::end(const WalkCursor& cursor) {
  ParticleState& s = states_[cursor.particle];
  s.put({Cell(cursor.cell), cursor.index}, targets_[cursor.particle]);
  s.touching_count = 0;
  count_step(cursor, counters_);
  if (moved && cursor.place != no_facet) counters_.updated_by_deformation += left_behind_[cursor.particle] ? 1 : 0;
}

// Computed again where it is needed: few walks come to a wall, or have several facets that the target is behind.
template <CacheKind kind>
inline Vec3 Batch<kind>::start_of(std::uint32_t i) const {
  if constexpr (!moved) return states_[i].position;
  return carried_position(i, determinants_of(previous_determinants_.data(), i));
}

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
