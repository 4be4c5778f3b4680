// The kernel of the batch (tracking/batch/batch.hpp). Its phases, in order (Batch::run() in batch_steps.inl):
//
// 1. Caches that do not fit the scene are made or emptied (batch_remember.inl).
// 2. First simplex (batch_first_simplex.inl). Four targets are tested at a time: against the corners, or by
//    barycentric coordinates. Targets that are proved inside end the step. Steps that are held, or must be split and have
//    a near target, are deferred to Stepper (batch_split_steps.inl). The others are carried along with the mesh. Those
//    with near targets leave by their exit facet.
// 3. Far walks (batch_far_walks.inl) go along their lines. Where a sign is not proved they go on in rounds. The farthest
//    pass whole hexahedra (batch_cell_walks.inl). Those of steps that are split end with the first part
//    (batch_slice_walks.inl).
// 4. Rounds (batch_walk.inl). In each, every walk finds its next simplex, is tested there, and arrives, goes on, stops
//    at a wall, or is deferred where a sign is not proved. Arrivals leave a cache entry (batch_remember.inl).
// 5. Impacts (batch_walls.inl). Four walks that end at walls at a time: the places where they meet them, where doubles
//    prove these. Where nothing responds, the mesh carries particles along from walls to the end of steps that are split.
//    Stepper resumes from there.
// 6. Exact coordinates of those that arrived on facets (batch_remember.inl).
//
// Below these: batch_simplex.inl (determinants and signs), batch_line_walks.inl, batch_cell_lanes.inl, batch_caches.inl,
// batch_impacts.inl, and batch_records.inl (scratch records).
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "tracking/batch/batch.hpp"
#include "tracking/batch/batch_cell_walks.inl"
#include "tracking/batch/batch_far_walks.inl"
#include "tracking/batch/batch_first_simplex.inl"
#include "tracking/batch/batch_remember.inl"
#include "tracking/batch/batch_slice_walks.inl"
#include "tracking/batch/batch_split_steps.inl"
#include "tracking/batch/batch_walk.inl"
#include "tracking/batch/batch_walls.inl"
#include "tracking/batch/simplex_cache.hpp"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {

void step(const BatchScene& scene, const BatchSteps& steps, Counters& counters) {
  if (scene.moved) return Batch<CacheKind::previous_geometry>(scene, steps, counters).run();
  if (steps.caches.empty()) return Batch<CacheKind::none>(scene, steps, counters).run();
  Batch<CacheKind::barycentric>(scene, steps, counters).run();
}

// Whether every number is 0 or between the two magnitudes.
bool all_between(const double* x, std::size_t count, double low, double high) {
  Mask4 between = splat_bits(-1);
  std::size_t i = 0;
#pragma GCC unroll 4
  for (; i + 4 <= count; i += 4) {
    const Double4 numbers = *reinterpret_cast<const UnalignedDouble4*>(x + i);
    const Double4 m = magnitude(numbers);
    between &= ((m >= low) & (m <= high)) | (reinterpret_cast<Mask4>(numbers) == splat_bits(0));
  }
  bool rest = true;
  for (; i < count; ++i)
    rest = rest && (std::bit_cast<std::uint64_t>(x[i]) == 0 || (std::abs(x[i]) >= low && std::abs(x[i]) <= high));
  return rest && lanes_set(between) == 15U;
}

}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
