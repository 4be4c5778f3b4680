// The record that all stages of a batch share: its scene, its steps, and how steps end. It has the lists of walks that
// one stage leaves to another. Part of the batch's kernel (tracking/batch/batch_kernel.inl).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tracking/batch/batch.hpp"
#include "tracking/batch/batch_caches.inl"
#include "tracking/batch/batch_records.inl"
#include "tracking/batch/batch_simplex.inl"
#include "tracking/carry.hpp"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

inline constexpr std::uint32_t block =
    32;  // steps or walks that a stage tests one after another; a mask has a bit for each
// Of four simplices. A particle that passes more in one step is likely to leave the last one in the next step: it gets no
// barycentric cache.
inline constexpr std::uint16_t short_tests = 16;

// There is one type for scenes at rest and one for scenes that move: functions that are called once are inlined.
template <bool moved>
struct Batch {
  Batch(const BatchScene& scene, const BatchSteps& steps, Counters& counts)
      : map(scene.complex->map()),
        now(scene.now()),
        before(scene.complex->previous_positions().data()),
        simplex_count(scene.complex->simplex_count()),
        size(static_cast<std::uint32_t>(steps.states.size())),
        states(steps.states.data()),
        vertices(steps.vertices.data()),
        caches(steps.caches.fours.data()),
        flags(steps.caches.flags.data()),
        targets(steps.targets.data()),
        status(steps.status.data()),
        partial(steps.partial),
        counters(counts) {}

  // Four particles at a time.
  Vec3x4 targets_of(const Index4& i) const {
    return load_vec3x4(targets[i.at[0]], targets[i.at[1]], targets[i.at[2]], targets[i.at[3]]);
  }
  Vec3x4 places_of(const Index4& i) const {
    return load_vec3x4(states[i.at[0]].position, states[i.at[1]].position, states[i.at[2]].position,
                       states[i.at[3]].position);
  }
  [[gnu::always_inline]] Corners4 simplices_of(const Vec3* positions, const Index4& i) const {
    return Corners4(positions, vertices[i.at[0]], vertices[i.at[1]], vertices[i.at[2]], vertices[i.at[3]]);
  }
  // Where their walks start: in simplices that have these corners now.
  Vec3x4 starts_of(const Index4& i, const Corners4& corners) const {
    if constexpr (!moved) return places_of(i);
    return carry_along(determinants_of(old_determinants.data(), i).of_corner, corners);
  }
  // The same of one. Computed again where it is needed: few walks come to a wall, or have several facets that the target
  // is behind.
  [[nodiscard]] Vec3 start_of(std::uint32_t i) const {
    if constexpr (!moved) return states[i].position;
    const Weights w = determinants_of(old_determinants.data(), i);
    return flushed(combine(corners_of(now, vertices[i]), shares_of(w)));
  }

  // The ends of steps here. All return false: no walk goes on.

  // At the target, in this simplex. `on`: bits of its facets that the target is proved to lie on. Returns whether a cache
  // is to be made for it.
  bool arrive(const WalkCursor& cursor, const VertexNumbers& corners, unsigned on = 0) {
    end(cursor);
    const std::uint32_t i = cursor.particle;
    vertices[i] = corners;
    if constexpr (moved) return true;
    const bool is_near = cursor.tests <= short_tests;
    if (cursor.place == no_facet && has_coordinates(caches, i)) {
      const bool is_exact = (flags[i] & exact_flag) != 0;
      flags[i] = is_exact ? static_cast<CacheFlags>(exact_flag | on) : CacheFlags{0};
      return on != 0 && !is_exact && is_near;
    }
    flags[i] = 0;
    if (on != 0 || !is_near) forget(caches, flags, i);
    return is_near;
  }
  // The same of a step that has a cache already.
  bool end(const WalkCursor& cursor) {
    const std::uint32_t i = cursor.particle;
    states[i].put({Cell(cursor.cell), cursor.index}, targets[i]);
    states[i].touching_count = 0;
    count_step(cursor, counters);
    if (moved && cursor.place != no_facet) counters.updated_by_deformation += left_behind[i] ? 1 : 0;
    return false;
  }
  // At its start: Stepper takes the whole step.
  bool defer(std::uint32_t i) {
    status[i] = step_untouched;
    return false;
  }
  // At a wall's facet that the target is beyond: Stepper goes on from there.
  [[gnu::cold, gnu::noinline]] bool end_at_wall(const WalkCursor& cursor, const VertexNumbers& corners,
                                                unsigned facet) {
    Walk walk;
    walk.end = WalkEnd::wall;
    walk.simplex = walk.wall_simplex = {Cell(cursor.cell), cursor.index};
    walk.wall_facet = static_cast<std::uint8_t>(facet);
    walls.add({cursor.particle, static_cast<StepStatus>(partial.size()), walk.wall_facet, corners});
    return defer_at_wall(cursor, walk);
  }
  // At a wall that the target is on; it lies on these facets of the simplex. Returns true if there is no such wall.
  bool is_off_walls(const WalkCursor& cursor, const VertexNumbers& corners, unsigned on) {
    const auto wall = find_touched_wall(map, cursor, corners, on);
    return !wall || end_on_wall(cursor, on, *wall);
  }

  const CombinatorialMap& map;
  const Vec3* now;     // vertices
  const Vec3* before;  // the move
  std::uint64_t simplex_count;
  // The steps, as in BatchSteps.
  std::uint32_t size;
  ParticleState* states;
  VertexNumbers* vertices;
  SimplexCache4* caches;
  CacheFlags* flags;
  const Vec3* targets;
  StepStatus* status;
  std::vector<StepState>& partial;
  Counters& counters;
  BatchList<AtWall> walls;     // where steps have ended at walls that their targets are beyond
  BatchList<Arrival> arrived;  // steps whose ends are to be cached
  // If the mesh has moved, by particle:
  std::array<SimplexCache4::Table<double>, max_batch / 4> old_determinants;  // in its simplex before the move
  std::array<bool, max_batch> left_behind;  // as Counters::updated_by_deformation means it

 private:
  [[gnu::cold, gnu::noinline]] bool end_on_wall(const WalkCursor& cursor, unsigned on, const SimplexFacet& wall) {
    Walk walk;
    walk.end = WalkEnd::wall;
    walk.simplex = {Cell(cursor.cell), cursor.index};
    walk.zeros = static_cast<std::uint8_t>(on);
    walk.wall_simplex = wall.simplex;
    walk.wall_facet = static_cast<std::uint8_t>(wall.facet);
    walk.at_end = true;
    return defer_at_wall(cursor, walk);
  }
  bool defer_at_wall(const WalkCursor& cursor, const Walk& walk) {
    const std::uint32_t i = cursor.particle;
    if constexpr (moved) {  // Stepper will ask how the wall has moved
      const CellView cell = map.view(walk.wall_simplex.cell);
      for (const std::uint16_t local : cell.shape().simplices()[walk.wall_simplex.simplex].vertex)
        __builtin_prefetch(before + cell.vertex(local).value);
    }
    status[i] = static_cast<StepStatus>(partial.size());
    partial.emplace_back(start_of(i), walk, TestCounts{cursor.tests, cursor.exact});
    return false;
  }
};

// Walks that a stage leaves to later ones, by that stage.
struct WalkLists {
  BatchList<ExitCandidate> exits;  // proved to leave their first simplex, to targets near by
  BatchList<WalkStart> far;        // to targets some simplices away
  BatchList<WalkStart> farther;    // some cells away, if cells are known to be positive
  BatchList<SliceWalk> apart;      // far ones in the first of several slices, or from walls
  BatchList<WalkCursor> rounds;    // in any simplex
};

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
