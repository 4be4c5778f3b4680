// Scratch records of one batch, all left uninitialized on purpose: there is room for many, and few are used. Part of
// the batch's kernel.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>

#include "base/double4.inl"
#include "dartcast/combinatorial_map.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/step.hpp"
#include "tracking/batch/batch.hpp"
#include "tracking/batch/batch_caches.inl"
#include "tracking/batch/batch_simplex.inl"
#include "tracking/star.hpp"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// Room for one entry of each particle.
template <class T>
struct BatchList {
  std::array<T, max_batch> at;
  std::uint32_t count = 0;

  void add(const T& entry) { at[count++] = entry; }
  // Those of four entries from number k on; at the end the last one again in the remaining lanes.
  [[nodiscard]] Index4 particles(std::uint32_t k) const {
    const Index4 i = index4_from(k, count);
    return {{at[i.at[0]].particle, at[i.at[1]].particle, at[i.at[2]].particle, at[i.at[3]].particle}};
  }
};

// A simplex that a walk has come to. Before it is entered: `face` and `place` are those of ExitTable::entry().
struct WalkCursor {
  std::uint32_t particle;
  std::uint32_t cell;           // its value
  std::uint16_t index;          // of the simplex
  std::uint16_t place;          // facet that was entered by (no_facet: none)
  std::uint32_t tests;          // so far
  std::uint32_t exact;          // of these, those that the filter left open
  std::uint16_t face;           // `entered`: index and place are known
  const std::uint32_t* record;  // of the cell
};

inline constexpr std::uint8_t no_facet = 4;
inline constexpr std::uint16_t entered = 0xffff;

// In the simplex where a step starts.
inline WalkCursor first_cursor(std::uint32_t particle, const ParticleState& s, const std::uint32_t* record,
                               std::uint32_t tests, unsigned exact) {
  return {particle, s.cell.value, s.simplex, no_facet, tests, exact, entered, record};
}

// The wall that a target is on, if the target is on these facets of its simplex.
inline std::optional<SimplexFacet> find_touched_wall(const CombinatorialMap& map, const WalkCursor& cursor,
                                                     const VertexNumbers& corners, unsigned on) {
  Feature feature;
  for (unsigned i = 0; i < 4; ++i) feature.add_if(((on >> i) & 1U) == 0, Vertex{corners[i]});
  return find_wall(map, {Cell(cursor.cell), cursor.index}, on, feature);
}

// A walk that is proved to leave its first simplex.
struct ExitCandidate {
  std::uint32_t particle;
  std::uint16_t behind;         // bits of the facets that its target is behind
  std::uint16_t exact;          // of the four tests
  const std::uint32_t* record;  // of its cell
};
inline ExitCandidate exit_candidate(std::uint32_t particle, unsigned behind, unsigned exact,
                                    const std::uint32_t* record) {
  return {particle, static_cast<std::uint16_t>(behind), static_cast<std::uint16_t>(std::popcount(exact)), record};
}
// A walk in its first simplex.
struct WalkStart {
  std::uint32_t particle;
  const std::uint32_t* record;  // of its cell
};
// A walk in the first slice of a step of several.
struct SliceWalk {
  std::uint32_t particle;
  std::uint32_t slices;
  const std::uint32_t* record;  // of its cell
  double start[3];              // carried along

  [[nodiscard]] Vec3 start_point() const { return {start[0], start[1], start[2]}; }
};
// A walk that leaves its cell with its first simplex.
struct CellExit {
  std::uint32_t particle;
  Across across;
  std::uint32_t facet;
  std::uint32_t tests;
  std::uint32_t exact;
  const std::uint32_t* record;
};
// A step that has ended at its target.
struct Arrival {
  std::uint32_t particle;
  std::uint32_t on;  // bits of the facets of the simplex that the target is proved to lie on
};
struct PlacedArrival {
  std::uint32_t particle;
  std::uint32_t place;  // in the block
};
// A walk that has come to a wall's facet; its target is beyond.
struct AtWall {
  std::uint32_t particle;
  std::uint16_t partial;  // its number
  std::uint16_t facet;
  VertexNumbers corners;  // of the simplex at the wall

  [[nodiscard]] std::uint32_t corner(unsigned i) const { return corners[facet_corners[facet][i]]; }
};

inline void count_step(const WalkCursor& cursor, Counters& counters) {
  ++counters.particle_steps;
  counters.orientation.tests += cursor.tests;
  counters.orientation.exact += cursor.exact;
  ++counters.histogram[std::min<std::size_t>(cursor.tests, Counters::histogram_size - 1)];
  counters.forecast_kept += cursor.place == no_facet ? 1 : 0;
}

// Inlined: the compiler would drop a call that only prefetches.
[[gnu::always_inline]] inline void prefetch_corners(const Vec3* positions, const VertexNumbers& v) {
  for (unsigned i = 0; i < 4; ++i) {
    __builtin_prefetch(positions + v[i]);
    __builtin_prefetch(&(positions + v[i])->z);
  }
}

[[gnu::always_inline]] inline VertexNumbers corners_of_simplex(const CellView& cell, unsigned index) {
  const auto& local = cell.shape().simplices()[index].vertex;
  return {cell.vertex(local[0]).value, cell.vertex(local[1]).value, cell.vertex(local[2]).value,
          cell.vertex(local[3]).value};
}

// Determinants kept in caches, of one particle, and of four.
inline Weights determinants_of(const SimplexCache4::Table<double>* w, std::uint32_t i) {
  Weights of_corner;
  for (unsigned c = 0; c < 4; ++c) of_corner[c] = w[i / 4][c][i % 4];
  return of_corner;
}
struct KeptDeterminants4 {
  Double4 of_corner[4];
};
inline KeptDeterminants4 determinants_of(const SimplexCache4::Table<double>* w, const Index4& i) {
  const auto of = [&](unsigned corner, unsigned l) { return w[i.at[l] / 4][corner][i.at[l] % 4]; };
  KeptDeterminants4 d;
  for (unsigned c = 0; c < 4; ++c) d.of_corner[c] = Double4{of(c, 0), of(c, 1), of(c, 2), of(c, 3)};
  return d;
}

inline bool any_flag(const CacheFlags* of_four) {
  std::uint32_t four;
  std::memcpy(&four, of_four, sizeof four);
  return four != 0;
}

// Sets the facets that those of four particles in the mask `which` lie on. Without branches, which would mispredict.
inline void set_facet_flags(const Mask4& zeros, std::uint32_t which, CacheFlags* of_four) {
  for (std::uint32_t j = 0; j < 4; ++j) {
    const auto flags = static_cast<std::uint32_t>(of_four[j]);
    const std::uint32_t next = (flags & exact_flag) | static_cast<std::uint32_t>(zeros[j]);
    of_four[j] = static_cast<CacheFlags>(flags ^ ((flags ^ next) & (0U - ((which >> j) & 1U))));
  }
}

// A bit for each of so many particles that is held or touches a wall.
inline std::uint32_t held_or_touching(const ParticleState* states, std::uint32_t count) {
  std::uint32_t bits = 0;
  for (std::uint32_t k = 0; k < count; ++k) {
    const unsigned either = (states[k].held ? 1U : 0U) | states[k].touching_count;
    bits |= (either != 0 ? 1U : 0U) << k;
  }
  return bits;
}

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
