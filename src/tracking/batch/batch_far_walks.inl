// Walks to targets that are far away, along their lines (batch_line_walks.inl): many in turn, so that memory is
// prefetched. Part of the batch's kernel (tracking/batch/batch_kernel.inl).
//
// One loop serves three kinds of walks. Each kind is a class that has the lanes. It says which walk begins next in one,
// where its corners are, and how it ends: FarWalks here, those that pass whole cells in between (batch_cell_walks.inl), and those of slices
// of steps (batch_slice_walks.inl).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "tracking/batch/batch_line_walks.inl"
#include "tracking/batch/batch_steps.inl"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

inline constexpr std::uint32_t lines = 32;            // walks in turn
inline constexpr std::uint32_t turns_at_once = 1024;  // before their tests are counted

// A walk along a line asks no more tests than this. It passes each simplex once at most: by three tests, or five or more
// in a whole cell by 17. A few others are asked at its ends.
inline std::uint64_t max_line_tests(std::uint64_t simplex_count) {
  return std::min<std::uint64_t>(4 * simplex_count + 16, 1U << 31U);
}

// Where the walks are, one in each lane.
struct LineLanes {
  std::array<LineWalks4, lines / 4> walks;
  std::array<LinePlace, lines> places;
  std::array<std::uint32_t, lines / 4> wall_lanes;  // a bit for each

  explicit LineLanes(const Vec3* positions) {
    for (LinePlace& at : places) at.corner = positions;  // lanes without a walk read it, too
  }

  // Begins a walk in lane l, in its first simplex. Returns false if it is not proved by which facet the line enters it.
  bool begin(std::uint32_t l, const LineStarts4& starts, unsigned from, std::uint32_t particle, const ParticleState& s,
             const std::uint32_t* record) {
    const unsigned facet = facets_entered[static_cast<std::size_t>(starts.turns[from])];
    if (facet == no_facet || starts.in_range[from] == 0) return false;
    walks[l / 4].begin(l % 4, starts, from, facet);
    // With the three tests of the simplex: the sides of all its facets.
    places[l].begin(particle, s.cell.value, record, 4U * s.simplex + facet, 0, 1);
    return walks[l / 4].is_inside(l % 4);
  }
};

// The walks that `kind` begins. They go in turns of three passes. The new corners of all walks are found, and
// prefetched. Four walks at a time pass their simplices, and their next cells are prefetched. Walks that may have
// ended, or that `kind` asks for, are looked at.
template <bool moved, class Kind>
class LineLoop {
 public:
  LineLoop(Batch<moved>& batch, Kind& kind) : b(batch), kind_(kind) {}

  void run() {
    std::uint32_t live = 0;
    for (std::uint32_t l = 0; l < lines; ++l) live |= (kind_.start_next(l) ? 1U : 0U) << l;
    for (std::uint32_t turn = 1; live != 0; ++turn) {
      if (turn % turns_at_once == 0) [[unlikely]]
        live = stop(live);
      for (std::uint32_t left = live; left != 0; left &= left - 1) {
        const auto l = static_cast<std::uint32_t>(std::countr_zero(left));
        if (!find_corners(l)) live ^= 1U << l;
      }
      std::uint32_t marked = 0;
      for (std::uint32_t l = 0; l < lines; l += 4) {
        const std::uint32_t here = (live >> l) & 15U;
        if (here != 0) marked |= pass_four(l, here) << l;
      }
      for (; marked != 0; marked &= marked - 1) {
        const auto l = static_cast<std::uint32_t>(std::countr_zero(marked));
        if (!goes_on(l) && !kind_.start_next(l)) live ^= 1U << l;
      }
    }
  }

 private:
  // Leaves to Stepper the walks that have asked more tests than any can. Returns the lanes that still have a walk.
  [[gnu::cold, gnu::noinline]] std::uint32_t stop(std::uint32_t live) {
    for (std::uint32_t l = 0; l < lines; ++l) {
      const LinePlace& at = kind_.places[l];
      if (((live >> l) & 1U) == 0 || at.all_tests() <= max_line_tests(b.simplex_count)) continue;
      b.defer(at.particle);
      if (!kind_.start_next(l)) live ^= 1U << l;
    }
    return live;
  }

  // Finds the new corner of the walk in lane l, or of the first one after it that has one. Returns false if there is
  // none.
  bool find_corners(std::uint32_t l) {
    LinePlace& at = kind_.places[l];
    while (!find_corner(at, b.map, b.now)) {
      kind_.leave_unlisted(at);
      if (!kind_.start_next(l)) return false;
    }
    kind_.prefetch(at);
    return true;
  }

  // Passes a simplex of each walk in the lanes from l on that are in the mask `live`. Returns a mask of those to look at.
  [[gnu::always_inline]] std::uint32_t pass_four(std::uint32_t l, std::uint32_t live) {
    LineWalks4& walks = kind_.walks[l / 4];
    LinePlace* const at = &kind_.places[l];
    walks.pass(kind_.corners(at, l));
    std::uint32_t walls = 0;
    for (std::uint32_t k = 0; k < 4; ++k) {
      if (((live >> k) & 1U) != 0) walls |= leave(at[k], static_cast<unsigned>(walks.slot[k]), b.map) << k;
    }
    kind_.wall_lanes[l / 4] = walls;
    return (walks.undecided | walks.near_end | walls | kind_.stops(at, l)) & live;
  }

  // Looks at a walk that needs it. Returns whether it goes on.
  bool goes_on(std::uint32_t l) {
    LinePlace& at = kind_.places[l];
    const LineWalks4& walks = kind_.walks[l / 4];
    if (((walks.undecided >> (l % 4)) & 1U) != 0) return kind_.leave_undecided(at);
    if (((walks.near_end >> (l % 4)) & 1U) != 0) {
      const int side = walks.side_of_target(l % 4);
      if (side == 0) return kind_.leave_undecided(at);
      at.tests += at.passed > 1 ? 1 : 0;  // in the first simplex the sides of all facets are counted
      if (side > 0) return kind_.arrive(l);
      kind_.pass_target(l);
    }
    if (((kind_.wall_lanes[l / 4] >> (l % 4)) & 1U) != 0) return kind_.end_at_wall(l);
    return kind_.goes_on(l);
  }

  Batch<moved>& b;
  Kind& kind_;
};

// The simplex that a walk has passed.
inline WalkCursor passed_cursor(const CombinatorialMap& map, const LinePlace& at) {
  const unsigned entered_by = at.passed == 1 ? no_facet : at.row % 4;
  return {at.particle,
          at.passed_cell,
          static_cast<std::uint16_t>(at.row / 4),
          static_cast<std::uint16_t>(entered_by),
          at.all_tests(),
          0,
          entered,
          map.record(Cell(at.passed_cell))};
}
[[gnu::always_inline]] inline VertexNumbers corners_of(const CombinatorialMap& map, const WalkCursor& cursor) {
  return corners_of_simplex(map.view(Cell(cursor.cell), cursor.record), cursor.index);
}

// Walks from simplex to simplex. If a sign is not proved, they go on in rounds.
template <bool moved>
class FarWalks : public LineLanes {
 public:
  FarWalks(Batch<moved>& batch, const BatchList<WalkStart>& far, BatchList<WalkCursor>& rounds)
      : LineLanes(batch.now), b(batch), far_(far), rounds_(rounds) {}

  // Begins the next walk that can begin, in lane l. Returns false if there is none.
  bool start_next(std::uint32_t l) {
    while (next_ < far_.count) {
      if (next_ % 4 == 0) stage();
      const auto [i, record] = far_.at[next_];
      if (begin(l, starts_, next_++ % 4, i, b.states[i], record)) return true;
      rounds_.add(first_cursor(i, b.states[i], record, 1, 0));
    }
    return false;
  }

  void prefetch(const LinePlace& /*at*/) const {}
  // The new corners of four walks.
  [[gnu::always_inline]] Vec3x4 corners(const LinePlace* at, std::uint32_t /*l*/) const {
    return load_vec3x4(*at[0].corner, *at[1].corner, *at[2].corner, *at[3].corner);
  }
  [[nodiscard]] std::uint32_t stops(const LinePlace* /*at*/, std::uint32_t /*l*/) const { return 0; }
  bool goes_on(std::uint32_t /*l*/) { return true; }
  void pass_target(std::uint32_t /*l*/) {}

  // The rounds test, and count, the simplex that it has passed.
  bool leave_undecided(const LinePlace& at) {
    WalkCursor cursor = passed_cursor(b.map, at);
    cursor.tests -= 3;
    rounds_.add(cursor);
    return false;
  }
  // It has come to a shape without a table, or begins in one.
  [[gnu::cold, gnu::noinline]] void leave_unlisted(const LinePlace& at) {
    const auto place = static_cast<std::uint16_t>(at.place);
    const auto face = static_cast<std::uint16_t>(at.face);
    rounds_.add({at.particle, at.cell, 0, place, at.all_tests(), 0, face, at.record});
  }
  bool arrive(std::uint32_t l) {
    const WalkCursor cursor = passed_cursor(b.map, places[l]);
    if (b.arrive(cursor, corners_of(b.map, cursor))) b.arrived.add({cursor.particle, 0});
    return false;
  }
  bool end_at_wall(std::uint32_t l) {
    const WalkCursor cursor = passed_cursor(b.map, places[l]);
    return b.end_at_wall(cursor, corners_of(b.map, cursor), places[l].exit_facet);
  }

 protected:
  Batch<moved>& b;
  LineStarts4 starts_;  // of four walks

 private:
  // Prepares four walks, and prefetches what those of the next block need.
  void stage() {
    const std::uint32_t end = std::min(next_ + block, far_.count);
    for (std::uint32_t k = std::min(next_ + block - 4, end); k < end; ++k) {
      __builtin_prefetch(far_.at[k].record);
      prefetch_corners(b.now, b.vertices[far_.at[k].particle]);
    }
    const Index4 i = far_.particles(next_);
    const Corners4 v = b.simplices_of(b.now, i);
    starts_ = LineStarts4(v, b.starts_of(i, v), b.targets_of(i));
  }

  const BatchList<WalkStart>& far_;
  std::uint32_t next_ = 0;
  BatchList<WalkCursor>& rounds_;
};

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
