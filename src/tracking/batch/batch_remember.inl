// Keeps for the next step what is known of the simplices in which steps end. Part of the batch's kernel
// (tracking/batch/batch_kernel.inl).
#pragma once

#include <algorithm>
#include <cstdint>

#include "tracking/batch/batch_steps.inl"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// For particles that have no caches of this kind: previous geometry, of their places before the move, or coordinates.
template <CacheKind kind>
inline void Batch<kind>::make_caches() {
  const Vec3* positions = moved ? before_ : now_;
  for (std::uint32_t first = 0; first < size_; first += 4) {
    for (std::uint32_t i = first + block; i < std::min(first + block + 4, size_); ++i)
      prefetch(positions, vertices_[i]);
    const Index4 i = index4_from(first, size_);
    const Vec3x4 p = places_of(i);
    const BatchDeterminants d(simplices_of(positions, i), p);
    if constexpr (moved) store_previous_geometry(d, caches_[first / 4]);
    if constexpr (kind == CacheKind::barycentric) store_barycentric<false>(d, p, caches_[first / 4]);
  }
  if constexpr (kind == CacheKind::barycentric) std::fill_n(flags_, size_, CacheFlags{0});
}

// A particle that passes many simplices in one step is likely to leave the last one in the next step: it gets none.
template <CacheKind kind>
inline bool Batch<kind>::needs_coordinates(const WalkCursor& cursor) {
  const std::uint32_t i = cursor.particle;
  if (cursor.place == no_facet && has_coordinates(caches_, i)) {
    flags_[i] &= exact_flag;
    return false;
  }
  flags_[i] = 0;
  if (cursor.tests <= short_tests) return true;
  forget(caches_, flags_, i);
  return false;
}

// The target is on facets of the simplex. The next target is likely to be on some, too: only exact coordinates help.
template <CacheKind kind>
void Batch<kind>::arrive_on_facets(const WalkCursor& cursor, const VertexNumbers& corners, std::size_t k, unsigned on) {
  if constexpr (kind != CacheKind::barycentric) return arrive(cursor, corners, k);
  const std::uint32_t i = cursor.particle;
  end(cursor);
  vertices_[i] = corners;
  if (cursor.place != no_facet || !has_coordinates(caches_, i)) forget(caches_, flags_, i);
  if ((flags_[i] & exact_flag) != 0)
    flags_[i] = static_cast<CacheFlags>(exact_flag | on);
  else if (cursor.tests <= short_tests)
    facet_arrival_[facet_arrivals_++] = {i, static_cast<CacheFlags>(on)};
}

// For the walks of the block that have arrived.
template <CacheKind kind>
inline void Batch<kind>::cache_arrivals() {
  SimplexCache4 four;
  for (std::uint32_t a = 0; a < arrivals_;) {
    const std::uint32_t k = arrival_[a].place / 4;
    if constexpr (moved) store_previous_geometry(determinants_[k], four);
    if constexpr (kind == CacheKind::barycentric) store_barycentric<false>(determinants_[k], ends_[k], four);
    for (; a < arrivals_ && arrival_[a].place / 4 == k; ++a) {
      const std::uint32_t i = arrival_[a].particle;
      caches_[i / 4].put(i % 4, four.of(arrival_[a].place % 4));
    }
  }
}

// For the walks of the batch whose targets are on facets. A block has few of them, so they wait until there are four.
template <CacheKind kind>
void Batch<kind>::cache_exact_coordinates() {
  SimplexCache4 four;
  for (std::uint32_t a = 0; a < facet_arrivals_; a += 4) {
    const Index4 at = index4_from(a, facet_arrivals_);
    const Index4 i = particles_of(facet_arrival_.data(), at);
    const Vec3x4 q = targets_of(i);
    const unsigned exact = store_barycentric<true>(BatchDeterminants(simplices_of(now_, i), q), q, four);
    for (std::uint32_t l = 0; l < 4; ++l) {
      if (((exact >> l) & 1U) == 0) continue;
      caches_[i.at[l] / 4].put(i.at[l] % 4, four.of(l));
      flags_[i.at[l]] = exact_flag | facet_arrival_[at.at[l]].on;
    }
  }
}

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
