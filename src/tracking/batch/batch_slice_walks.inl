// Far walks apart from the others, where vertices move: the step has several slices, or the filter does not prove where
// the mesh carries the start, as at walls. The walk of the first slice, or of the only one, goes along its line
// (batch_far_walks.inl), among vertices where they are at the end of the slice. Stepper takes the other slices, and the
// whole step where anything is undecided. Part of the batch's kernel (tracking/batch/batch_kernel.inl).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "tracking/batch/batch_line_walks.inl"
#include "tracking/batch/batch_steps.inl"
#include "tracking/carry.hpp"
#include "tracking/space.hpp"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// Returns false where the target is near, where the particle's coordinates are not known, where its simplex is not proved
// to be positive, or where the particle is rounded out of it.
template <CacheKind kind>
bool Batch<kind>::add_slice_walk(std::uint32_t i, unsigned slices) {
  const Space<Between> space{&map_, {before_, now_, 1.0 / slices}, simplex_count_};
  const SimplexId at = states_[i].at();
  __builtin_prefetch(map_.record(at.cell));
  const Corners corners = corners_of(space.positions, vertices_[i]);
  const Determinants d(corners, target_of(i, slices));
  const Weights weights = determinants_of(previous_determinants_.data(), i);
  if (std::isnan(weights[0]) || !d.proves_positive() || !is_far_away(d)) return false;
  const SimplexPlacement start = place_in_simplex(space, at, corners, combine(corners, shares_of(weights)));
  if (start.simplex != at) return false;
  const Vec3& x = start.position;
  slice_walks_[slice_walk_count_++] = {i, slices, map_.record(at.cell), {x.x, x.y, x.z}};
  return true;
}

// The target of a walk in the first of so many slices.
template <CacheKind kind>
inline Vec3 Batch<kind>::target_of(std::uint32_t i, unsigned slices) const {
  const Vec3& here = states_[i].position;
  return slices == 1 ? targets_[i] : next_slice(here, targets_[i] - here, slices).target;
}

template <CacheKind kind>
void Batch<kind>::walk_first_slices() {
  slice_times_.fill(splat(0.0));  // lanes without a walk read them, too
  next_line_ = staged_ = 0;
  pass_simplices<LineKind::apart>([&](std::uint32_t l) { return start_next_slice(l); });
}

// As start_next_line().
template <CacheKind kind>
inline bool Batch<kind>::start_next_slice(std::uint32_t l) {
  while (next_line_ < slice_walk_count_) {
    if (next_line_ == staged_) stage_slices();
    const auto from = static_cast<unsigned>(next_line_ + 4 - staged_);
    const auto number = static_cast<std::uint32_t>(next_line_++);
    const SliceWalk& walk = slice_walks_[number];
    slice_of_line_[l] = number;
    slice_times_[l / 4][l % 4] = 1.0 / walk.slices;
    if (start_line(l, walk.particle, walk.record, from)) return true;
    defer(walk.particle);
  }
  return false;
}

// Prepares four walks from number next_line_ on.
template <CacheKind kind>
inline void Batch<kind>::stage_slices() {
  const std::size_t last = slice_walk_count_ - 1;
  const auto walk = [&](std::size_t k) -> const SliceWalk& { return slice_walks_[std::min(next_line_ + k, last)]; };
  const Index4 i = {{walk(0).particle, walk(1).particle, walk(2).particle, walk(3).particle}};
  const Double4 time = {1.0 / walk(0).slices, 1.0 / walk(1).slices, 1.0 / walk(2).slices, 1.0 / walk(3).slices};
  const Corners4 v = between(simplices_of(before_, i), simplices_of(now_, i), time);
  const auto start = [&](std::size_t k) { return walk(k).start_point(); };
  const auto target = [&](std::size_t k) { return target_of(walk(k).particle, walk(k).slices); };
  line_starts_ = LineStarts4(v, load_vec3x4(start(0), start(1), start(2), start(3)),
                             load_vec3x4(target(0), target(1), target(2), target(3)));
  staged_ = next_line_ + 4;
}

// Where a vertex was, by where it is. By bytes: the difference of pointers would be divided by the size of a point.
template <CacheKind kind>
[[gnu::always_inline]] inline const Vec3* Batch<kind>::before_move(const Vec3* now) const {
  const auto bytes = [](const Vec3* x) { return reinterpret_cast<const char*>(x); };
  return reinterpret_cast<const Vec3*>(bytes(before_) + (bytes(now) - bytes(now_)));
}

// The new corners of four walks, in the lanes from l on.
template <CacheKind kind>
[[gnu::always_inline]] inline Vec3x4 Batch<kind>::corners_in_slices(const LinePlace* at, std::uint32_t l) const {
  const Vec3* before[4];
  for (unsigned k = 0; k < 4; ++k) before[k] = before_move(at[k].corner);
  return between(load_vec3x4(*before[0], *before[1], *before[2], *before[3]),
                 load_vec3x4(*at[0].corner, *at[1].corner, *at[2].corner, *at[3].corner), slice_times_[l / 4]);
}

// Leaves the rest of the step to Stepper. Returns false: the walk does not go on.
template <CacheKind kind>
inline bool Batch<kind>::end_slice(std::uint32_t l, bool at_wall) {
  const LinePlace& at = line_places_[l];
  const SliceWalk& slice = slice_walks_[slice_of_line_[l]];
  const WalkCursor cursor = passed_cursor(at);
  const auto number = static_cast<StepStatus>(partial_.size());
  Walk walk;
  walk.end = at_wall ? WalkEnd::wall : WalkEnd::arrived;
  walk.simplex = {Cell(cursor.cell), cursor.index};
  if (at_wall) {
    walk.wall_simplex = walk.simplex;
    walk.wall_facet = static_cast<std::uint8_t>(at.exit_facet);
    at_walls_[at_wall_count_++] = {slice.particle, number, walk.wall_facet, corners_of_walk(cursor)};
  }
  status_[slice.particle] = number;
  partial_.emplace_back(slice.start_point(), walk, TestCounts{cursor.tests, cursor.exact});
  partial_.back().slices = slice.slices;
  return false;
}

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
