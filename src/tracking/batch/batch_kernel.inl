// The kernel of the batch (tracking/batch/batch.hpp): its stages, in order (run()). All have the record of the batch
// (batch_steps.inl). "Ends" stands for its parts that say how steps end: states, vertices, status, partial steps, walls,
// arrivals, counts. A stage leaves its other walks to later ones in a list of WalkLists.
//
// stage (file)                            reads                                leaves behind
// prepare_caches (batch_remember)         places, vertices before the move     caches
// FirstSimplexMoved (batch_first_simplex) targets, caches, all vertices        ends; caches; exits, far, apart
// FirstSimplexAtRest                      targets, caches                      ends; exits, far, farther, rounds
// FarWalks (batch_far_walks)              far; vertices on the way             ends; rounds, if a sign is not proved
// SliceWalks (batch_slice_walks)          apart; vertices before and after     ends
// WalksToCells (batch_cell_walks)         farther; vertices on the way         ends; rounds, if a sign is not proved
// leave_first_simplices (batch_walk)      exits                                ends; rounds
// Rounds (batch_walk)                     rounds; vertices on the way          ends; caches of those that arrive
// compute_impacts (batch_walls)           walls                                impacts of partial steps; caches
// cache_arrivals (batch_remember)         arrivals                             caches
//
// Below these: batch_simplex.inl (determinants and signs), batch_caches.inl, batch_line_walks.inl (along a line),
// batch_cell_lanes.inl (through a cell), batch_impacts.inl, batch_slice_starts.inl, and batch_records.inl.
#pragma once

#include <algorithm>
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
#include "tracking/batch/batch_walk.inl"
#include "tracking/batch/batch_walls.inl"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// Walks to far targets.
template <bool moved>
[[gnu::noinline]] void walk_lines(Batch<moved>& b, WalkLists& walks) {
  FarWalks<moved> far(b, walks.far, walks.rounds);
  LineLoop<moved, FarWalks<moved>>(b, far).run();
  if constexpr (moved) {
    SliceWalks apart(b, walks.apart);
    LineLoop<moved, SliceWalks>(b, apart).run();
  } else if (walks.farther.count != 0) {
    WalksToCells(b, walks.farther, walks.rounds).run();
  }
}

template <bool moved>
void run(const BatchScene& scene, const BatchSteps& steps, Counters& counters) {
  Batch<moved> b(scene, steps, counters);
  WalkLists walks;
  prepare_caches(b, scene);
  std::fill_n(b.status, b.size, step_complete);
  if constexpr (moved)
    FirstSimplexMoved(b, scene.options, walks).run();
  else
    FirstSimplexAtRest(b, are_known_positive(*scene.complex), walks).run();
  if ((walks.far.count | walks.farther.count | walks.apart.count) != 0) walk_lines(b, walks);
  leave_first_simplices(b, walks.exits, walks.rounds);
  Rounds<moved>(b, walks.rounds).run();
  compute_impacts(b, scene.stops);
  cache_arrivals(b);
}

}  // namespace

void step(const BatchScene& scene, const BatchSteps& steps, Counters& counters) {
  scene.moved ? run<true>(scene, steps, counters) : run<false>(scene, steps, counters);
}

// Whether every number is 0 or between the two magnitudes.
bool all_between(const double* x, std::size_t count, double low, double high) {
  Mask4 between = splat_bits(-1);
  std::size_t i = 0;
#pragma GCC unroll 4
  for (; i + 4 <= count; i += 4) {
    const Double4 numbers = load_doubles(x + i);
    const Double4 m = magnitude(numbers);
    between &= ((m >= low) & (m <= high)) | (bits_as<Mask4>(numbers) == splat_bits(0));
  }
  bool rest = true;
  for (; i < count; ++i)
    rest = rest && (std::bit_cast<std::uint64_t>(x[i]) == 0 || (std::abs(x[i]) >= low && std::abs(x[i]) <= high));
  return rest && lanes_set(between) == 15U;
}

}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
