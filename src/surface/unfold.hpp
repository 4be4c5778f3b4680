// A triangle of space laid out in the plane, and the way that a ray takes through it.
#pragma once

#include <array>

#include "dartcast/vec3.hpp"

namespace dartcast::detail {

/// A direction in the plane of a triangle, of length 1: along its base, and across it to the side of the apex.
struct Heading {
  double along = 1.0;
  double across = 0.0;
};

/// The base from (0, 0) to (length, 0), the apex at (x, height), height > 0; scaled by a power of two, so that the
/// longest edge is about 1: nothing under- or overflows for corners in the exact range.
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

/// Lays out a triangle with an area, base from a to b. Each number is right to a few units in the last place of the
/// longest edge; the height to a relative 2^-44, however thin the triangle.
Unfolded unfold(const Vec3& a, const Vec3& b, const Vec3& c);

Frame frame_of(const Vec3& a, const Vec3& b, const Vec3& c);

/// The heading relative to another edge of the triangle: that from corner 1 (the base's end) to corner 2 (the apex), or
/// from 2 to 0; `edge` is the number of the corner where the edge starts.
Heading turned_to(const Unfolded& t, unsigned edge, const Heading& h);

/// The angle at corner 0, in (0, pi).
double angle_at_base(const Unfolded& t);

/// Barycentric coordinates, none negative; a point of an edge has one that is exactly 0, a corner two. Corner 0 is the
/// base's start, 1 its end, 2 the apex.
using TriangleWeights = std::array<double, 3>;

/// What is left of rounding: coordinates below 2^-200 become 0, and the largest is 1 less the others.
TriangleWeights normalized(TriangleWeights w);

/// Whether they are such: in [0, 1], none between 0 and 2^-200, their sum 1 up to rounding.
bool are_weights(const TriangleWeights& w);

/// Where a ray leaves a triangle: on an edge (one weight is 0) or at a corner (two are).
struct Exit {
  TriangleWeights weights;
  double length = 0.0;  ///< of the way, scaled
};

/// The way out from a point of the triangle. Preconditions: the heading points into the triangle or along an edge where
/// the point is on the border: on an edge that is the base, and across >= 0; at a corner it is corner 0, or corner 1
/// and the heading runs back along the base, exactly.
///
/// Weights change along a ray at constant rates; the first to reach 0 tells the edge. Which of two is first is the sign
/// of a determinant of two weights and two rates: exact, though the rates are rounded. The way out is then on that edge
/// by construction: its weight is 0, the others are not negative.
Exit way_out(const Unfolded& t, const TriangleWeights& from, const Heading& h);

}  // namespace dartcast::detail
