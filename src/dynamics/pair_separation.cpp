// The differences of points of two elements are a set whose distance from 0 is that of the elements: for a vertex and a
// triangle another triangle, for two edges a parallelogram, which is two triangles. Their corners move straight, so a
// sphere at 0 that does not move touches them when the elements are near (dynamics/swept_sphere).
//
// Differences are rounded. A corner is off by at most 2^-53 of its length, and so is each point between corners, by at
// most 2^-53 of the longest one. The sphere is larger by more than that.
#include "dynamics/pair_separation.hpp"

#include <algorithm>
#include <cmath>

#include "dynamics/swept_sphere.hpp"

namespace dartcast {

namespace {

using detail::MovingPair;
using detail::PairKind;

// The bound of a corner's error over its length, twice: the length is rounded, too.
constexpr double difference_error = 0x1p-52;

struct CornerPair {
  std::size_t first, second;  // points of the pair; the corner is second - first
};

std::optional<double> triangle_within(const MovingPair& pair, const std::array<CornerPair, 3>& corners,
                                      double separation) {
  MovingTriangle triangle;
  double longest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& [first, second] = corners[i];
    triangle.from[i] = pair.from[second] - pair.from[first];
    triangle.to[i] = pair.to[second] - pair.to[first];
    longest = std::max({longest, norm(triangle.from[i]), norm(triangle.to[i])});
  }
  const auto touch = first_touch(MovingSphere{{}, {}, separation + difference_error * longest}, triangle);
  if (!touch) return std::nullopt;
  return touch->time;
}

}  // namespace

std::optional<double> first_within(const MovingPair& pair, PairKind kind, double separation) {
  if (kind == PairKind::vertex_face) return triangle_within(pair, {{{0, 1}, {0, 2}, {0, 3}}}, separation);
  const auto one = triangle_within(pair, {{{0, 2}, {0, 3}, {1, 3}}}, separation);
  const auto other = triangle_within(pair, {{{0, 2}, {1, 2}, {1, 3}}}, separation);
  return one && other ? std::min(*one, *other) : one ? one : other;
}

}  // namespace dartcast
