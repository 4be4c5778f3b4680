// Steps that have ended at walls: where they meet them, four at a time, if doubles prove it. Else Stepper computes it.
// Part of the batch's kernel (tracking/batch/batch_kernel.inl).
#pragma once

#include <algorithm>
#include <cstdint>

#include "tracking/batch/batch_impacts.inl"
#include "tracking/batch/batch_slice_starts.inl"
#include "tracking/batch/batch_steps.inl"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// Four walks to walls: their targets, the facets at the walls and the simplices there, where they are at these times.
inline Vec3x4 targets_at(const Batch<false>& b, const AtWalls& at) { return b.targets_of(at.particles()); }
inline Vec3x4 targets_at(const Batch<true>& b, const AtWalls& at) {
  const auto target = [&](unsigned l) { return slice_target(b, at[l]->particle, at.step(l).slices); };
  return load_vec3x4(target(0), target(1), target(2), target(3));
}
template <bool moved>
[[gnu::always_inline]] inline Vec3x4 facet_corners_at(const Batch<moved>& b, const AtWalls& at, unsigned i) {
  const Vec3x4 now = at.corners(b.now, i);
  if constexpr (!moved) return now;
  return between(at.corners(b.before, i), now, at.times());
}
template <bool moved>
[[gnu::always_inline]] inline Corners4 simplices_at(const Batch<moved>& b, const AtWalls& at) {
  if constexpr (!moved) return at.simplices(b.now);
  return between(at.simplices(b.before), at.simplices(b.now), at.times());
}

// Particles that stop at walls in the first of several slices: the vertices carry them along to the end of the step, as in
// StepRun::take_slices(). Returns a mask of those for which doubles prove all that is asked there.
inline Mask4 carry_on(const Batch<true>& b, const AtWalls& at, WallImpact4& impacts) {
  const Double4 slices = at.slices();
  Mask4 carried = impacts.known & (slices > 1.0);
  if (!any(carried)) return Mask4{};
  const Corners4 from = at.simplices(b.before);
  const Corners4 to = at.simplices(b.now);
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

// Four impacts. `stops`: particles stop at walls.
template <bool moved>
inline void compute_impact4(Batch<moved>& b, const AtWalls& at, std::uint32_t count, bool stops) {
  const Vec3x4 facets[3] = {facet_corners_at(b, at, 0), facet_corners_at(b, at, 1), facet_corners_at(b, at, 2)};
  WallImpact4 impacts(at, facets, targets_at(b, at));
  if (!any(impacts.known)) return;
  impacts.put(simplices_at(b, at));
  Mask4 carried{};
  Mask4 left_behind{};
  if constexpr (moved) {
    impacts.move_walls(at, b.before, b.now);
    if (stops) carried = carry_on(b, at, impacts);
    const Index4 i = at.particles();
    left_behind = BatchDeterminants(b.simplices_of(b.now, i), b.places_of(i)).any_negative();
  }
  SimplexCache4 caches;
  store_cache<moved>(impacts.there, impacts.position, caches);
  for (std::uint32_t l = 0; l < count; ++l) {
    if (impacts.known[l] == 0) continue;
    const std::uint32_t i = at[l]->particle;
    StepState& partial = b.partial[at[l]->partial];
    partial.impact = impacts.of(l);
    if constexpr (moved) {
      partial.left_behind = left_behind[l] != 0;  // as left_behind() in tracking/step_run.hpp
      partial.carried_on = carried[l] != 0;
    }
    ++partial.tests.tests;  // on which side p is
    if (moved && !partial.knows_end()) continue;
    b.vertices[i] = at[l]->corners;
    if (!moved) forget(b.caches, b.flags, i);
    if (moved || partial.tests.tests <= short_tests) b.caches[i / 4].put(i % 4, caches.of(l));
  }
}

template <bool moved>
inline void compute_impacts(Batch<moved>& b, bool stops) {
  for (std::uint32_t k = 0; k < b.walls.count; k += 4) {
    const Index4 i = index4_from(k, b.walls.count);
    const auto& walls = b.walls.at;
    compute_impact4(b, {{&walls[i.at[0]], &walls[i.at[1]], &walls[i.at[2]], &walls[i.at[3]]}, b.partial.data()},
                    std::min(4U, b.walls.count - k), stops);
  }
}

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
