// Two spheres that move on straight lines: the time of their first touch, and the constraint that keeps them apart.
#pragma once

#include <optional>

#include "dartcast/dynamics.hpp"

namespace dartcast {

/// A sphere whose centre is at centre + t displacement, t in [0, 1].
struct SphereMotion {
  Vec3 centre;
  Vec3 displacement;
  double radius = 0.0;
};

struct PairTouch {
  double time = 0.0;     ///< fraction of the step, in [0, 1]; 0 where they overlap at the start
  bool overlap = false;  ///< at the start they are closer than the sum of the radii
  double depth = 0.0;    ///< the sum of the radii less the distance, of an overlap; rounded
  Vec3 normal;           ///< unit, from the first centre to the second, at that time; rounded
};

/// The time of a touch is never after the true one, and before it by at most this share of the step.
inline constexpr double pair_time_bound = 0x1p-30;  // 9.4e-10

/// The first touch of two spheres (distance <= sum of the radii); nothing where they do not touch within the step.
/// The decision is exact for the numbers as stored. Where the centres coincide, the normal is opposite to the first's
/// motion relative to the second, or along x where there is none. Preconditions: coordinates are 0 or between 2^-300
/// and 2^300 in magnitude; radii likewise, not negative. Cost: some 20 ns; where rounding leaves the time open by
/// more than the bound (grazing, or motion by less than some 1e-7 of the distance), exact arithmetic: microseconds.
std::optional<PairTouch> first_meeting(const SphereMotion& a, const SphereMotion& b);

/// The pair's constraint in a solver: a bound of the relative motion along a normal.
struct Approach {
  Vec3 normal;  ///< unit, from a to b where they first touch; where they do not, where they come closest
  double gap =
      0.0;  ///< room along the normal at the start: (b - a) . normal - radii; negative: the depth of an overlap
  double distance = 0.0;  ///< between the surfaces there, >= 0; of an overlap: the gap
};

/// The half-space of motions that keep the spheres apart: their relative displacement along the normal is not below
/// -gap. It is tangent to the forbidden ball where the straight motion touches it, so that a motion that touches
/// nothing satisfies it, however near it passes. Plain rounded arithmetic: normals and gaps are right to a few units
/// in the last place of the positions. Cost: some 20 ns.
Approach approach(const SphereMotion& a, const SphereMotion& b);

}  // namespace dartcast
