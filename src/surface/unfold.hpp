// A triangle of space laid out in the plane, and the path of a ray through it.
#pragma once

#include <array>

#include "dartcast/vec3.hpp"

namespace dartcast::detail {

/// A direction in the plane of a triangle, of length 1: along its base, and across it to the side of the apex.
struct Heading {
  double along = 1.0;
  double across = 0.0;
};

/// The base is from (0, 0) to (length, 0), the apex at (x, height), height > 0. Lengths are scaled by a power of two,
/// so that the longest edge is about 1. So nothing under- or overflows for corners in the exact range.
struct Unfolded {
  double length = 0.0;
  double x = 0.0;
  double height = 0.0;
  double scale = 1.0;  ///< lengths here over those in space
};

/// Unit vectors along the base, across it in the plane of the triangle, and normal to it.
struct Frame {
  Vec3 along;
  Vec3 across;
  Vec3 normal;
};

/// Whether a triangle has an area, exactly. Precondition of all: corners in the exact range.
bool has_area(const Vec3& a, const Vec3& b, const Vec3& c);

/// Lays out a triangle with an area, with the base from a to b. Each number is accurate to a few units in the last
/// place of the longest edge. The height is accurate to a relative 2^-44, however thin the triangle is.
Unfolded unfold(const Vec3& a, const Vec3& b, const Vec3& c);

Frame frame_of(const Vec3& a, const Vec3& b, const Vec3& c);

/// The heading relative to another edge of the triangle: that from corner 1 (the base's end) to corner 2 (the apex), or
/// from 2 to 0. `edge` is the number of the corner where the edge starts.
Heading turned_to(const Unfolded& t, unsigned edge, const Heading& h);

/// The angle at corner 0, in (0, pi).
double angle_at_base(const Unfolded& t);

/// Barycentric coordinates, none negative; a point of an edge has one that is exactly 0, a corner two. Corner 0 is the
/// base's start, 1 its end, 2 the apex.
using TriangleWeights = std::array<double, 3>;

/// Removes rounding: coordinates below 2^-200 become 0, and the largest becomes 1 minus the others.
TriangleWeights normalized(TriangleWeights w);

/// Whether weights are valid: in [0, 1], none between 0 and 2^-200, with sum 1 up to rounding.
bool are_weights(const TriangleWeights& w);

/// The place where a ray leaves a triangle: on an edge (one weight is 0) or at a corner (two are).
struct Exit {
  TriangleWeights weights;
  double length = 0.0;  ///< of the path, scaled
};

/// The exit of a ray from a point of the triangle. Preconditions: the heading points into the triangle or along an
/// edge. A point on the border lies on the base, with across >= 0. A point at a corner is at corner 0, or at corner 1
/// with a heading that runs back along the base, exactly.
///
/// Weights change along a ray at constant rates. The first weight that reaches 0 decides the edge. The sign of a
/// determinant of two weights and two rates decides which of two is first. This sign is exact, although the rates are
/// rounded. The exit is on that edge by construction: its weight is 0, and the others are not negative.
Exit way_out(const Unfolded& t, const TriangleWeights& from, const Heading& h);

}  // namespace dartcast::detail
