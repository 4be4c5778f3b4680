// The first touch of a moving sphere and a moving triangle.
//
// No equation is solved: intervals of time are proved free of contact. Let a direction turn from m to n (of lengths at
// most 1) between two instants a and b. The triangle stays clear of the sphere if all three corners d_i, seen from the
// centre, are further than the radius along it. The corners are linear in time, so this is a quadratic for each. Its
// coefficients in Bernstein's form are m.d_i(a), (m.d_i(b) + n.d_i(a)) / 2 and n.d_i(b). m and n are the directions to
// the nearest points. Their rounding makes the proof weaker, never wrong, for any triangle. If the proof fails the
// interval is divided, the earlier part first. If doubles do not decide, double-double does.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "dartcast/dynamics.hpp"

namespace dartcast {

/// Its corners move on straight lines, t in [0, 1]. It may be flat, a segment or a point (equal corners).
struct MovingTriangle {
  std::array<Vec3, 3> from;
  std::array<Vec3, 3> to;
};

/// Its centre moves on a straight line, t in [0, 1].
struct MovingSphere {
  Vec3 from;
  Vec3 to;
  double radius = 0.0;
};

/// The point of a triangle that is nearest to a centre.
struct NearestOnTriangle {
  Vec3 point;
  Vec3 normal;  ///< unit, from the point to the centre; zero if the two are equal
  double distance = 0.0;
  std::array<double, 3> weights{};  ///< of the corners; not negative, they sum to 1
  std::uint8_t corners = 0;  ///< bit i: corner i has a weight. One is a corner of the triangle, two an edge, three its
                             ///< inside
};

/// Rounded to a few units in the last place of the largest distance between the centre and a corner. In a triangle that
/// is nearly flat the point may be off along it. Cost: about 0.1 us.
NearestOnTriangle nearest_on_triangle(const std::array<Vec3, 3>& corners, const Vec3& centre);

struct SphereTouch {
  double time = 0.0;      ///< never after the sphere first touches the triangle; before by at most sphere_time_bound
  double contact = 0.0;   ///< at or after `time`, by no more than that bound: where the distance is next to the radius
  bool at_start = false;  ///< they touch or overlap at the time 0 already, and the distance then gets smaller
};

/// A sphere that passes at more than its radius may count as touching, if the difference is at most this share of
/// M. M is the largest of the radius and the distances between the centre and a corner, before and after. The
/// opposite never happens.
inline constexpr double grazing_bound = 0x1p-60;

/// The first touch within [0, until]: the first time at which the distance is at most the radius; nothing if there
/// is none.
///
/// `slack`: the length that counts as rounding. A sphere that comes no nearer than radius - slack does not touch.
/// If the distance is at most radius + slack (at least 2^-94 M) at the time 0 already, a touch is where it falls
/// below that distance less slack. So a sphere that rests on the triangle, or is held off it, can slide and leave.
/// The touch is reported as at 0 (at_start) unless the sphere was farther than radius + slack in between.
///
/// Errors: `time` as in SphereTouch. Intervals are divided at most 4096 times. If that were not enough (never seen),
/// the touch is reported where the proof ended: early, never late.
///
/// Preconditions: radius > 0, slack >= 0, until in [0, 1], all finite and below 2^300 in magnitude. Cost: 0.25 us if
/// one direction keeps them apart, 2 to 3 us for a touch. It is tens of us if the touch is grazing, or if the sphere
/// starts on the triangle with a slack below 2^-47 M.
std::optional<SphereTouch> first_touch(const MovingSphere& sphere, const MovingTriangle& triangle, double slack = 0.0,
                                       double until = 1.0);

}  // namespace dartcast
