// The cost of a step of colliding spheres, part by part.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace dartcast::bench {

/// Nanoseconds are per sphere and step, on one thread.
struct SphereRow {
  std::size_t spheres = 0;
  std::size_t cells = 0;
  std::size_t steps = 0;  ///< timed
  double contacts = 0.0;  ///< pairs given to the solver, per sphere
  bool by_lists = false;  ///< how pairs were found
  double lists_ns = 0.0;  ///< keeping up each cell's particles
  double pairs_ns = 0.0;  ///< finding pairs
  double touch_ns = 0.0;  ///< when and where they touch
  double impulses_ns = 0.0;
  double walls_ns = 0.0;           ///< accelerating, and finding walls within reach
  double advance_ns = 0.0;         ///< contacts with walls on the way, the walk
  double pairs_by_lists_ns = 0.0;  ///< the same pairs, found in each of the two ways; 0: not tried
  double pairs_by_grid_ns = 0.0;
  double steps_per_second = 0.0;
  double steps_per_second_all = 0.0;  ///< of the next steps, on all threads of the machine
  double deepest = 0.0;               ///< largest overlap of a pair, as a share of the radius
};

/// A heap of `count` spheres on the floor of a box, each with about 5 neighbours. First it comes to rest for some
/// steps. Then the cost of the next steps is measured. Cells hold about three spheres each; or, crowded, there are 8
/// cells in all.
SphereRow heap(std::size_t count, bool crowded);

std::string spheres_text(std::span<const SphereRow> rows);
std::string spheres_json(std::span<const SphereRow> rows);

}  // namespace dartcast::bench
