// Walks that end at walls: where they meet them, for Stepper to resume from. Part of the batch's kernel
// (tracking/batch/batch_kernel.inl).
#pragma once

#include <algorithm>
#include <cstdint>

#include "tracking/batch/batch_steps.inl"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// The target is beyond a wall.
template <CacheKind kind>
bool Batch<kind>::end_at_wall(const WalkCursor& cursor, const VertexNumbers& corners, unsigned facet) {
  Walk walk;
  walk.end = WalkEnd::wall;
  walk.simplex = walk.wall_simplex = {Cell(cursor.cell), cursor.index};
  walk.wall_facet = static_cast<std::uint8_t>(facet);
  at_walls_[at_wall_count_++] = {cursor.particle, static_cast<StepStatus>(partial_.size()), walk.wall_facet, corners};
  return defer_at_wall(cursor, walk);
}

// The target is on a wall.
template <CacheKind kind>
bool Batch<kind>::end_on_wall(const WalkCursor& cursor, unsigned on, const SimplexFacet& wall) {
  Walk walk;
  walk.end = WalkEnd::wall;
  walk.simplex = {Cell(cursor.cell), cursor.index};
  walk.zeros = static_cast<std::uint8_t>(on);
  walk.wall_simplex = wall.simplex;
  walk.wall_facet = static_cast<std::uint8_t>(wall.facet);
  walk.at_end = true;
  return defer_at_wall(cursor, walk);
}

// Defers the step to Stepper, from the wall on. Returns false: the walk does not go on.
template <CacheKind kind>
inline bool Batch<kind>::defer_at_wall(const WalkCursor& cursor, const Walk& walk) {
  const std::uint32_t i = cursor.particle;
  if constexpr (moved) {  // Stepper will ask how the wall has moved
    const CellView cell = map_.view(walk.wall_simplex.cell);
    for (const std::uint16_t local : cell.shape().simplices()[walk.wall_simplex.simplex].vertex)
      __builtin_prefetch(before_ + cell.vertex(local).value);
  }
  status_[i] = static_cast<StepStatus>(partial_.size());
  partial_.emplace_back(start_of(i), walk, TestCounts{cursor.tests, cursor.exact});
  return false;
}

// Where doubles do not prove an impact, Stepper computes it.
template <CacheKind kind>
inline void Batch<kind>::compute_impacts() {
  for (std::uint32_t k = 0; k < at_wall_count_; k += 4) compute_impact4(k);
}

// Four walks to walls: their targets, the facets at the walls and the simplices there, where they are at these times.
template <CacheKind kind>
[[gnu::always_inline]] inline Vec3x4 Batch<kind>::targets_at(const AtWalls& at) const {
  if constexpr (!moved) return targets_of(at.particles());
  const auto target = [&](unsigned l) { return target_of(at[l]->particle, at.step(l).slices); };
  return load_vec3x4(target(0), target(1), target(2), target(3));
}
template <CacheKind kind>
[[gnu::always_inline]] inline Vec3x4 Batch<kind>::facet_corners_at(const AtWalls& at, unsigned i) const {
  const Vec3x4 now = at.corners(now_, i);
  if constexpr (!moved) return now;
  return between(at.corners(before_, i), now, at.times());
}
template <CacheKind kind>
[[gnu::always_inline]] inline Corners4 Batch<kind>::simplices_at(const AtWalls& at) const {
  if constexpr (moved)
    return between(at.simplices(before_), at.simplices(now_), at.times());
  else
    return at.simplices(now_);
}

// Particles that stop at walls in the first of several slices: the vertices carry them along to the end of the step, as in
// StepRun::take_slices(). Returns a mask of those for which doubles prove all that is asked there.
template <CacheKind kind>
inline Mask4 Batch<kind>::carry_on(const AtWalls& at, WallImpact4& impacts) const {
  const Double4 slices = at.slices();
  Mask4 carried = impacts.known & (slices > 1.0);
  if (!stops_ || !any(carried)) return Mask4{};
  const Corners4 from = at.simplices(before_);
  const Corners4 to = at.simplices(now_);
  Vec3x4 position = impacts.position;
  BatchDeterminants there = impacts.there;
  for (double slice = 2.0; any(carried & (slices >= slice)); ++slice) {
    const Mask4 goes_on = slices >= slice;
    const Corners4 v = between(from, to, slice / slices);
    const Vec3x4 x = carry_along(there.value, v);
    const BatchDeterminants d(v, x);
    carried &= ~goes_on | (there.proves_coordinates() & d.all_positive());
    position = choose(goes_on, x, position);
    there = choose(goes_on, d, there);
  }
  impacts.position = choose(carried, position, impacts.position);
  impacts.there = choose(carried, there, impacts.there);
  return carried;
}

// As left_behind() in tracking/step_run.hpp.
template <CacheKind kind>
inline Mask4 Batch<kind>::are_left_behind(const AtWalls& at) const {
  const Index4 i = at.particles();
  return BatchDeterminants(simplices_of(now_, i), places_of(i)).any_negative();
}

template <CacheKind kind>
inline void Batch<kind>::compute_impact4(std::uint32_t k) {
  const std::uint32_t last = at_wall_count_ - 1;
  const AtWalls at = {{&at_walls_[k], &at_walls_[std::min(k + 1, last)], &at_walls_[std::min(k + 2, last)],
                       &at_walls_[std::min(k + 3, last)]},
                      partial_.data()};
  const Vec3x4 facets[3] = {facet_corners_at(at, 0), facet_corners_at(at, 1), facet_corners_at(at, 2)};
  WallImpact4 impacts(at, facets, targets_at(at));
  if (lanes_set(impacts.known) == 0) return;
  impacts.put(simplices_at(at));
  Mask4 carried{};
  Mask4 left_behind{};
  if constexpr (moved) {
    impacts.move_walls(at, before_, now_);
    carried = carry_on(at, impacts);
    left_behind = are_left_behind(at);
  }
  SimplexCache4 caches;
  if constexpr (moved) store_previous_geometry(impacts.there, caches);
  if constexpr (kind == CacheKind::barycentric) store_barycentric<false>(impacts.there, impacts.position, caches);
  for (std::uint32_t l = 0; l < 4 && k + l < at_wall_count_; ++l) {
    if (impacts.known[l] == 0) continue;
    const std::uint32_t i = at[l]->particle;
    StepState& partial = partial_[at[l]->partial];
    partial.impact = impacts.of(l);
    if constexpr (moved) {
      partial.left_behind = left_behind[l] != 0;
      partial.carried_on = carried[l] != 0;
    }
    ++partial.tests.tests;  // on which side p is
    if (moved && !partial.knows_end()) continue;
    vertices_[i] = at[l]->corners;
    if constexpr (kind == CacheKind::none) continue;
    if (moved || partial.tests.tests <= short_tests) {
      caches_[i / 4].put(i % 4, caches.of(l));
      if (!moved) flags_[i] = 0;
    } else {
      forget(caches_, flags_, i);
    }
  }
}

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
