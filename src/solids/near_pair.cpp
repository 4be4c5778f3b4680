// A vertex within a margin of a triangle is a sphere that touches it. Two edges are within a margin of each other if the
// parallelogram of the differences of their points is within the margin of 0. Its corners are linear in time, so it is two
// moving triangles, and a sphere at rest.
#include "solids/near_pair.hpp"

#include <algorithm>
#include <array>

#include "dynamics/swept_sphere.hpp"

namespace dartcast {

namespace {

using detail::MovingPair;
using detail::PairKind;

// The triangles, as the centre at `centre` sees them.
struct SeenTriangles {
  Vec3 centre_from, centre_to;
  std::array<MovingTriangle, 2> triangles;
  std::size_t count = 1;
};

SeenTriangles seen(const MovingPair& pair, PairKind kind) {
  const auto& [a, b] = pair;
  if (kind == PairKind::vertex_face) return {a[0], b[0], {{{{a[1], a[2], a[3]}, {b[1], b[2], b[3]}}}}, 1};
  const auto corners = [](const std::array<Vec3, 4>& x, bool other) {
    return std::array<Vec3, 3>{x[2] - x[0], other ? x[2] - x[1] : x[3] - x[0], x[3] - x[1]};
  };
  return {{}, {}, {{{corners(a, false), corners(b, false)}, {corners(a, true), corners(b, true)}}}, 2};
}

}  // namespace

double distance_at_start(const MovingPair& pair, PairKind kind) {
  const SeenTriangles s = seen(pair, kind);
  double least = nearest_on_triangle(s.triangles[0].from, s.centre_from).distance;
  if (s.count == 2) least = std::min(least, nearest_on_triangle(s.triangles[1].from, s.centre_from).distance);
  return least;
}

// A sphere that starts on the triangle may leave it without a proof that they do not touch, so the pair is asked, too.
std::optional<double> first_within(const MovingPair& pair, PairKind kind, double margin) {
  const SeenTriangles s = seen(pair, kind);
  std::optional<double> first = detail::first_touch(pair, kind);
  for (std::size_t i = 0; i < s.count; ++i) {
    const auto touch = first_touch({s.centre_from, s.centre_to, margin}, s.triangles[i], 0.0, first.value_or(1.0));
    if (touch) first = std::min(touch->time, first.value_or(1.0));
  }
  return first;
}

}  // namespace dartcast
