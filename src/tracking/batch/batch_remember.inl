// Keeps for the next step what is known of the simplices in which steps end. Part of the batch's kernel
// (tracking/batch/batch_kernel.inl).
#pragma once

#include <algorithm>
#include <cstdint>

#include "tracking/batch/batch_steps.inl"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// Caches that are not of the states before this step, and of this kind, are made: if the mesh has moved, of the places
// before.
template <bool moved>
inline void prepare_caches(Batch<moved>& b, const BatchScene& scene) {
  if (!moved && !(scene.caches_match && scene.walls_match)) std::fill_n(b.flags, b.size, CacheFlags{0});
  if (scene.caches_match) return;
  const Vec3* const positions = moved ? b.before : b.now;
  for (std::uint32_t first = 0; first < b.size; first += 4) {
    for (std::uint32_t i = first + block; i < std::min(first + block + 4, b.size); ++i)
      prefetch_corners(positions, b.vertices[i]);
    const Index4 i = index4_from(first, b.size);
    const Vec3x4 p = b.places_of(i);
    store_cache<moved>(BatchDeterminants(b.simplices_of(positions, i), p), p, b.caches[first / 4]);
  }
}

// Caches the ends of steps, four at a time. If targets lie on facets, only exact coordinates help: the next target is
// likely to lie on some, too.
template <bool moved>
inline void cache_arrivals(Batch<moved>& b) {
  SimplexCache4 four;
  for (std::uint32_t a = 0; a < b.arrived.count; a += 4) {
    const Index4 i = b.arrived.particles(a);
    const Vec3x4 q = b.targets_of(i);
    const BatchDeterminants d(b.simplices_of(b.now, i), q);
    const auto on = [&](std::uint32_t l) { return b.arrived.at[std::min(a + l, b.arrived.count - 1)].on; };
    unsigned exact = 0;
    if (moved || (on(0) | on(1) | on(2) | on(3)) == 0)
      store_cache<moved>(d, q, four);
    else
      exact = store_barycentric<true>(d, q, four);
    for (std::uint32_t l = 0; l < std::min(4U, b.arrived.count - a); ++l) {
      const bool is_exact = ((exact >> l) & 1U) != 0;
      if (on(l) != 0 && !is_exact) continue;
      b.caches[i.at[l] / 4].put(i.at[l] % 4, four.of(l));
      if (on(l) != 0) b.flags[i.at[l]] = static_cast<CacheFlags>(exact_flag | on(l));
    }
  }
}

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
