// Walks apart (batch_slice_starts.inl), along their lines (batch_far_walks.inl), among vertices where they are at the end of
// the first slice. Stepper takes the other slices, and the whole step if anything is undecided. Part of the batch's
// kernel (tracking/batch/batch_kernel.inl).
#pragma once

#include <array>
#include <cstdint>

#include "tracking/batch/batch_far_walks.inl"
#include "tracking/batch/batch_slice_starts.inl"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

class SliceWalks : public LineLanes {
 public:
  SliceWalks(Batch<true>& batch, const BatchList<SliceWalk>& apart) : LineLanes(batch.now), b(batch), apart_(apart) {
    times_.fill(splat(0.0));  // lanes without a walk read them, too
  }

  // The functions of FarWalks.
  bool start_next(std::uint32_t l) {
    while (next_ < apart_.count) {
      if (next_ % 4 == 0) stage();
      const SliceWalk& walk = apart_.at[next_];
      of_line_[l] = &walk;
      times_[l / 4][l % 4] = 1.0 / walk.slices;
      if (begin(l, starts_, next_++ % 4, walk.particle, b.states[walk.particle], walk.record)) return true;
      b.defer(walk.particle);
    }
    return false;
  }
  void prefetch(const LinePlace& at) const {
    const Vec3* const was = before_move(at.corner);
    __builtin_prefetch(was);
    __builtin_prefetch(&was->z);
  }
  [[gnu::always_inline]] Vec3x4 corners(const LinePlace* at, std::uint32_t l) const {
    const Vec3* was[4];
    for (unsigned k = 0; k < 4; ++k) was[k] = before_move(at[k].corner);
    return between(load_vec3x4(*was[0], *was[1], *was[2], *was[3]),
                   load_vec3x4(*at[0].corner, *at[1].corner, *at[2].corner, *at[3].corner), times_[l / 4]);
  }
  [[nodiscard]] std::uint32_t stops(const LinePlace* /*at*/, std::uint32_t /*l*/) const { return 0; }
  bool goes_on(std::uint32_t /*l*/) { return true; }
  void pass_target(std::uint32_t /*l*/) {}
  bool leave_undecided(const LinePlace& at) { return b.defer(at.particle); }
  void leave_unlisted(const LinePlace& at) { b.defer(at.particle); }
  bool arrive(std::uint32_t l) { return end(l, false); }
  bool end_at_wall(std::uint32_t l) { return end(l, true); }

 private:
  // Prepares four walks.
  void stage() {
    const Index4 k = index4_from(next_, apart_.count);
    const SliceWalk* const walk[4] = {&apart_.at[k.at[0]], &apart_.at[k.at[1]], &apart_.at[k.at[2]],
                                      &apart_.at[k.at[3]]};
    const Index4 i = apart_.particles(next_);
    const Double4 time = {1.0 / walk[0]->slices, 1.0 / walk[1]->slices, 1.0 / walk[2]->slices, 1.0 / walk[3]->slices};
    const Corners4 v = between(b.simplices_of(b.before, i), b.simplices_of(b.now, i), time);
    const auto target = [&](unsigned l) { return slice_target(b, walk[l]->particle, walk[l]->slices); };
    starts_ = LineStarts4(
        v, load_vec3x4(walk[0]->start_point(), walk[1]->start_point(), walk[2]->start_point(), walk[3]->start_point()),
        load_vec3x4(target(0), target(1), target(2), target(3)));
  }

  // Where a vertex was, by where it is. By bytes: the difference of pointers would be divided by the size of a point.
  [[nodiscard]] [[gnu::always_inline]] const Vec3* before_move(const Vec3* now) const {
    const auto bytes = [](const Vec3* x) { return reinterpret_cast<const char*>(x); };
    return reinterpret_cast<const Vec3*>(bytes(b.before) + (bytes(now) - bytes(b.now)));
  }

  // Leaves the rest of the step to Stepper. Returns false: the walk does not go on.
  bool end(std::uint32_t l, bool at_wall) {
    const LinePlace& at = places[l];
    const SliceWalk& slice = *of_line_[l];
    const WalkCursor cursor = passed_cursor(b.map, at);
    const auto number = static_cast<StepStatus>(b.partial.size());
    Walk walk;
    walk.end = at_wall ? WalkEnd::wall : WalkEnd::arrived;
    walk.simplex = {Cell(cursor.cell), cursor.index};
    if (at_wall) {
      walk.wall_simplex = walk.simplex;
      walk.wall_facet = static_cast<std::uint8_t>(at.exit_facet);
      b.walls.add({slice.particle, number, walk.wall_facet, corners_of(b.map, cursor)});
    }
    b.status[slice.particle] = number;
    b.partial.emplace_back(slice.start_point(), walk, TestCounts{cursor.tests, cursor.exact});
    b.partial.back().slices = slice.slices;
    return false;
  }

  Batch<true>& b;
  const BatchList<SliceWalk>& apart_;
  std::uint32_t next_ = 0;
  LineStarts4 starts_;
  std::array<const SliceWalk*, lines> of_line_;
  std::array<Double4, lines / 4> times_;  // of the step: the vertices are where they are then
};

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
