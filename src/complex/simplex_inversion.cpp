// The first inversion of one simplex, and the features that meet.
#include <bit>
#include <cmath>

#include "complex/volume_cubic.hpp"
#include "dartcast/validity.hpp"

namespace dartcast {

namespace {

static_assert(inversion_resolution == detail::time_unit);

using SimplexEdges = std::array<Vec3, 3>;

SimplexEdges edges_of(const Corners& v) { return {v[1] - v[0], v[2] - v[0], v[3] - v[0]}; }

// The edges from corner 0 at the time t. Each axis is measured in its largest difference, so no coordinate is above 1
// by more than rounding. They are off by at most 2^-39 (1 + 2^-10) from their values at any time until t + 2^-40. An
// edge moves by 2 in a step, and four operations are rounded.
SimplexEdges scaled_edges(const Corners& before, const Corners& after, double t) {
  const SimplexEdges p = edges_of(before);
  const SimplexEdges q = edges_of(after);
  const Vec3 extent = extent_of(p[0], p[1], p[2], q[0], q[1], q[2]);
  SimplexEdges edges;
  for (unsigned i = 0; i < 3; ++i) {
    const Vec3 e = (1.0 - t) * p[i] + t * q[i];
    edges[i] = {e.x / extent.x, e.y / extent.y, e.z / extent.z};
  }
  return edges;
}

struct DependenceParts {
  unsigned positive = 0;
  unsigned negative = 0;
};

// The signs of the corners' coefficients in their affine dependence. At the root, the facets' area vectors are
// multiples of one vector by just these coefficients. Along an axis each is a sum of at most three differences of two
// products. It is off by at most 3 (4 2^-39 (1 + 2^-9)), and rounding, in all less than 2^-35.
DependenceParts dependence(const SimplexEdges& e) {
  const Vec3 w1 = cross(e[1], e[2]);
  const Vec3 w2 = cross(e[2], e[0]);
  const Vec3 w3 = cross(e[0], e[1]);
  const Vec3 w0 = -(w1 + w2 + w3);
  const std::array<std::array<double, 4>, 3> along = {
      {{w0.x, w1.x, w2.x, w3.x}, {w0.y, w1.y, w2.y, w3.y}, {w0.z, w1.z, w2.z, w3.z}}};
  const auto sum = [](const std::array<double, 4>& w) {
    return std::abs(w[0]) + std::abs(w[1]) + std::abs(w[2]) + std::abs(w[3]);
  };
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (sum(along[k]) > sum(along[axis])) axis = k;
  }
  constexpr double error = 0x1p-35;
  DependenceParts parts;
  for (unsigned i = 0; i < 4; ++i) {
    parts.positive |= along[axis][i] > error ? 1U << i : 0U;
    parts.negative |= along[axis][i] < -error ? 1U << i : 0U;
  }
  return parts;
}

InversionKind kind_of(int fewer, int more) {
  if (fewer == 1 && more == 3) return InversionKind::vertex_face;
  if (fewer == 2 && more == 2) return InversionKind::edge_edge;
  if (fewer == 1 && more == 2) return InversionKind::vertex_edge;
  if (fewer == 1 && more == 1) return InversionKind::vertex_vertex;
  return InversionKind::line;
}

SimplexInversion inversion_at(const Corners& before, const Corners& after, double time) {
  const auto [positive, negative] = dependence(scaled_edges(before, after, time));
  const int above = std::popcount(positive);
  const int below = std::popcount(negative);
  // If the parts are equal, the one with the lowest corner is the first.
  const bool positive_first = above != below ? above < below : std::countr_zero(positive) < std::countr_zero(negative);
  const InversionKind kind = positive_first ? kind_of(above, below) : kind_of(below, above);
  if (kind == InversionKind::line) return {time, kind};
  const auto [one, other] = positive_first ? DependenceParts{positive, negative} : DependenceParts{negative, positive};
  return {time, kind, static_cast<std::uint8_t>(one), static_cast<std::uint8_t>(other)};
}

}  // namespace

std::optional<SimplexInversion> find_inversion(const Corners& before, const Corners& after, double until) {
  const detail::VolumeCubic cubic(before, after);
  if (cubic.proves_positive()) return {};
  until = std::floor(until / inversion_resolution) * inversion_resolution;
  if (cubic.proves_positive_until(until)) return {};
  const detail::VolumeRoot root = detail::first_root(before, after, until);
  using Outcome = detail::VolumeRoot::Outcome;
  switch (root.fate) {
    case Outcome::stays_positive: return {};
    case Outcome::never_positive: return SimplexInversion{0.0, InversionKind::from_the_start};
    case Outcome::undecidable: return SimplexInversion{0.0, InversionKind::undecidable};
    case Outcome::reaches_zero: break;
  }
  return inversion_at(before, after, root.safe_time);
}

}  // namespace dartcast
