// Walks to targets near by, beyond their first simplex: one simplex of each walk in a round. Part of the batch's kernel
// (tracking/batch/batch_kernel.inl).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <new>
#include <optional>

#include "dartcast/predicates.hpp"
#include "tracking/batch/batch_steps.inl"
#include "tracking/walk.hpp"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// 4 * simplex + facet: where a walk has come to.
[[gnu::always_inline]] inline unsigned row_entered(const Shape& shape, const WalkCursor& cursor) {
  if (cursor.face == 0) return cursor.place;
  const Across at = shape.entry(static_cast<std::uint16_t>(cursor.face - 1), cursor.place);
  return 4U * at.index + at.place;
}

// As leaves_before() in tracking/walk.hpp, if the filter does not decide.
template <bool moved>
[[gnu::noinline]] bool passes_before(const Batch<moved>& b, std::uint32_t i, const Vec3& p, const Vec3& q,
                                     const Vec3& s, const Vec3& t) {
  Sign sign = s == p || t == p ? Sign::zero : orient3d_exact(s, t, p, q);
  if (sign == Sign::zero) {
    const Space<Stored, 4> space{&b.map, {b.now}, 0};
    std::optional<unsigned> zeros;
    if (!moved && (b.flags[i] & exact_flag) != 0) zeros = b.flags[i] & 15U;
    sign = Ties<Stored, 4>(space, b.states[i].at(), p, q, zeros).line(s, t);
  }
  return sign == Sign::positive;
}

// The facet by which the segment leaves, of several that the target is behind.
template <bool moved>
inline unsigned first_exit(const Batch<moved>& b, WalkCursor& cursor, const VertexNumbers& corners, unsigned behind) {
  const std::uint32_t i = cursor.particle;
  const Vec3 p = b.start_of(i);
  const Vec3& q = b.targets[i];
  unsigned facet = static_cast<unsigned>(std::countr_zero(behind));
  while ((behind &= behind - 1) != 0) {
    const unsigned other = static_cast<unsigned>(std::countr_zero(behind));
    const auto& edge = side_edge[facet][other];
    const Vec3& s = b.now[corners[edge[0]]];
    const Vec3& t = b.now[corners[edge[1]]];
    const int first = filtered_sign(s - q, p - q, t - q);
    ++cursor.tests;
    cursor.exact += first == 0 ? 1 : 0;
    if (first < 0 || (first == 0 && !passes_before(b, i, p, q, s, t))) facet = other;
  }
  return facet;
}

// Into the cell beyond a face. Returns false if that is a wall.
template <bool moved>
inline bool pass_face(Batch<moved>& b, WalkCursor& cursor, const VertexNumbers& corners, unsigned facet,
                      Across across) {
  const CellView cell = b.map.view(Cell(cursor.cell), cursor.record);
  const std::uint16_t face = across.face();
  if (cell.is_wall(face)) return b.end_at_wall(cursor, corners, facet);
  cursor.cell = cell.neighbour(face).value;
  cursor.face = static_cast<std::uint16_t>(1 + cell.neighbour_face(face));
  cursor.place = cell.shape().triangle_from_other_side(face, across.place);
  cursor.record = b.map.record(Cell(cursor.cell));
  __builtin_prefetch(cursor.record);
  return true;
}

// Takes walks out of their first simplices. Those that leave their cell come last, in a row: no branch could predict
// which they are.
template <bool moved>
inline void leave_first_simplices(Batch<moved>& b, const BatchList<ExitCandidate>& exits,
                                  BatchList<WalkCursor>& rounds) {
  std::array<CellExit, max_batch> out_of_cell;
  std::uint32_t out = 0;
  std::uint32_t next = rounds.count;
  for (std::uint32_t k = 0; k < exits.count; ++k) {
    const auto [i, behind, open, record] = exits.at[k];
    const ParticleState& s = b.states[i];
    std::uint32_t tests = 4;
    std::uint32_t exact = open;
    auto facet = static_cast<unsigned>(std::countr_zero(behind));
    if (!std::has_single_bit(behind)) {
      WalkCursor cursor = first_cursor(i, s, record, tests, exact);
      facet = first_exit(b, cursor, b.vertices[i], behind);
      tests = cursor.tests;
      exact = cursor.exact;
    }
    // From registers: a record that was just written in parts could not be loaded as a whole yet.
    const Across across = b.map.view(s.cell, record).shape().simplices()[s.simplex].across[facet];
    rounds.at[next] = {i, s.cell.value, across.index, across.place, tests, exact, entered, record};
    out_of_cell[out] = {i, across, facet, tests, exact, record};
    const std::uint32_t leaves = across.index / Across::outer_bit;
    next += 1 - leaves;
    out += leaves;
  }
  for (std::uint32_t k = 0; k < out; ++k) {
    const auto& [i, across, facet, tests, exact, record] = out_of_cell[k];
    rounds.at[next] = first_cursor(i, b.states[i], record, tests, exact);
    if (pass_face(b, rounds.at[next], b.vertices[i], facet, across)) ++next;
  }
  rounds.count = next;
}

// Block by block, in passes with as few branches as possible. The first pass finds all simplices of the block and
// prefetches their corners. The second one tests them, four in a vector. The third one goes on with the walks that have
// not ended.
template <bool moved>
class Rounds {
 public:
  Rounds(Batch<moved>& batch, BatchList<WalkCursor>& walks) : b(batch), walks_(walks) {}

  void run() {
    std::uint32_t count = walks_.count;
    for (std::uint64_t round = 1; count > 0; ++round) {
      if (round > b.simplex_count) {  // a segment passes each simplex once at most
        for (std::uint32_t k = 0; k < count; ++k) b.defer(walks_.at[k].particle);
        return;
      }
      count = walk_on(count);
    }
  }

 private:
  // The next simplex of every walk. Returns the number of walks that go on.
  std::uint32_t walk_on(std::uint32_t count) {
    std::uint32_t next = 0;
    for (std::uint32_t first = 0; first < count; first += block) {
      WalkCursor* const walks = &walks_.at[first];
      const std::uint32_t n = std::min(block, count - first);
      for (std::uint32_t k = 0; k < n; ++k) enter(walks[k], k);
      for (std::uint32_t k = 0; k < n; k += 4) test_four(walks, k, n);
      arrival_count_ = 0;
      for (std::uint32_t k = 0; k < n; ++k) {
        WalkCursor& cursor = walks_.at[next] = walks[k];
        cursor.tests += 3;
        if (FacetSigns4(signs_[k]).is_inside())
          arrive(cursor, k);
        else if (leave_simplex(cursor, k))
          ++next;
      }
      cache_arrivals();
    }
    return next;
  }

  // Finds the simplex behind the facet that the walk passes, and prefetches its new corner. k: its place in the block.
  void enter(WalkCursor& cursor, std::uint32_t k) {
    VertexNumbers& corners = corners_[k];
    const CellView cell = b.map.view(Cell(cursor.cell), cursor.record);
    const Shape& shape = cell.shape();
    if (cursor.face != entered) {
      const unsigned row = row_entered(shape, cursor);
      cursor.index = static_cast<std::uint16_t>(row / 4);
      cursor.place = static_cast<std::uint16_t>(row % 4);
      cursor.face = entered;
    }
    if (!moved && cursor.place == no_facet) {  // where the step started
      corners = b.vertices[cursor.particle];
      return prefetch_corners(b.now, corners);
    }
    corners = corners_of_simplex(cell, cursor.index);
    if (cursor.place == no_facet) return prefetch_corners(b.now, corners);
    const Vec3* const apex = b.now + corners[cursor.place];
    __builtin_prefetch(apex);
    __builtin_prefetch(&apex->z);
  }

  [[gnu::always_inline]] void test_four(const WalkCursor* walks, std::uint32_t k, std::uint32_t n) {
    const Index4 i = index4_from(k, n);
    const Corners4 v(b.now, corners_[i.at[0]], corners_[i.at[1]], corners_[i.at[2]], corners_[i.at[3]]);
    const Vec3x4 q = b.targets_of(
        {{walks[i.at[0]].particle, walks[i.at[1]].particle, walks[i.at[2]].particle, walks[i.at[3]].particle}});
    const BatchDeterminants& d = *new (&determinants_[k / 4]) BatchDeterminants(v, q);
    store_bits(d.signs(v, q), &signs_[k]);
    if constexpr (!moved) targets_[k / 4] = q;
  }

  // Goes on into the next simplex if the filter decides which; else defers the step.
  bool leave_simplex(WalkCursor& cursor, std::uint32_t k) {
    const FacetSigns4 signs(signs_[k]);
    const VertexNumbers& corners = corners_[k];
    const unsigned tested = 15U & ~(1U << cursor.place);
    if (!signs.is_known(tested)) return b.defer(cursor.particle);
    cursor.exact += static_cast<unsigned>(std::popcount(signs.open() & tested));
    const unsigned behind = signs.negative() & tested;
    if (behind == 0) {
      const unsigned on = signs.zero() & tested;
      if (on != 0 && !b.is_off_walls(cursor, corners, on)) return false;
      return on == 0 || moved ? arrive(cursor, k) : arrive_on_facets(cursor, corners, on);
    }
    const bool single = std::has_single_bit(behind);
    const unsigned facet =
        single ? static_cast<unsigned>(std::countr_zero(behind)) : first_exit(b, cursor, corners, behind);
    return pass_on(cursor, corners, facet);
  }

  bool pass_on(WalkCursor& cursor, const VertexNumbers& corners, unsigned facet) {
    const CellView cell = b.map.view(Cell(cursor.cell), cursor.record);
    const Across across = cell.shape().simplices()[cursor.index].across[facet];
    if (across.outer()) return pass_face(b, cursor, corners, facet, across);
    cursor.index = across.index;
    cursor.place = across.place;
    return true;
  }

  bool arrive(const WalkCursor& cursor, std::uint32_t k) {
    arrivals_[arrival_count_] = {cursor.particle, k};
    arrival_count_ += b.arrive(cursor, corners_[k]) ? 1 : 0;
    return false;
  }
  [[gnu::noinline]] bool arrive_on_facets(const WalkCursor& cursor, const VertexNumbers& corners, unsigned on) {
    if (b.arrive(cursor, corners, on)) b.arrived.add({cursor.particle, on});
    return false;
  }

  // For the walks of the block that have arrived, strictly inside.
  void cache_arrivals() {
    SimplexCache4 four;
    for (std::uint32_t a = 0; a < arrival_count_;) {
      const std::uint32_t k = arrivals_[a].place / 4;
      store_cache<moved>(determinants_[k], targets_[k], four);
      for (; a < arrival_count_ && arrivals_[a].place / 4 == k; ++a) {
        const std::uint32_t i = arrivals_[a].particle;
        b.caches[i / 4].put(i % 4, four.of(arrivals_[a].place % 4));
      }
    }
  }

  Batch<moved>& b;
  BatchList<WalkCursor>& walks_;
  // The block that is tested.
  std::array<VertexNumbers, block> corners_;
  std::array<BatchDeterminants, block / 4> determinants_;
  std::array<Vec3x4, block / 4> targets_;
  std::array<long long, block> signs_;
  std::array<PlacedArrival, block> arrivals_;
  std::uint32_t arrival_count_;
};

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
