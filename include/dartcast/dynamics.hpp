// What spheres, bodies and catheters share.
#pragma once

#include <cstdint>

namespace dartcast {

/// What one step's collisions of spheres, with each other and with walls, were.
struct CollisionCounts {
  std::uint64_t pairs_tested = 0;    ///< pairs whose swept boxes met
  std::uint64_t pairs_near = 0;      ///< pairs given to the solver
  std::uint64_t pairs_touching = 0;  ///< pairs given an impulse
  std::uint64_t walls_touching = 0;  ///< contacts with walls that were given an impulse
  std::uint64_t overlaps = 0;        ///< pairs closer than the sum of their radii at the start of the step
  double deepest = 0.0;              ///< the deepest of these overlaps

  CollisionCounts& operator+=(const CollisionCounts& other);
};

}  // namespace dartcast
