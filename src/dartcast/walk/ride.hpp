// Riding along: a particle keeps its barycentric coordinates while the vertices of its simplex move.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "dartcast/walk/settle.hpp"
#include "dartcast/walk/step.hpp"

namespace dartcast::detail {

/// x's barycentric coordinates in a simplex, negative ones counted as 0; they sum to 1 up to rounding.
inline Weights barycentric(const Corners& v, const Vec3& x) {
  const Determinants d(v, x);
  Weights w = d.value;
  if (!d.proves_coordinates()) {  // a sliver: the filter's values are mostly rounding
    for (unsigned i = 0; i < 4; ++i) {
      const auto& f = facet_corners[i];
      w[i] = orient3d_value(v[f[0]], v[f[1]], v[f[2]], x);
    }
  }
  double sum = 0.0;
  for (double& c : w) {
    c = std::max(c, 0.0);
    sum += c;
  }
  if (!(sum > 0.0)) return {0.25, 0.25, 0.25, 0.25};  // flat: any point of it will do
  for (double& c : w) c /= sum;
  return w;
}

inline Vec3 combine(const Corners& v, const Weights& w) {
  return (v[0] * w[0] + v[1] * w[1]) + (v[2] * w[2] + v[3] * w[3]);
}

/// The particle with coordinates w, in the moved simplex; settled where rounding put it outside. Precondition: the
/// moved simplex is positive.
template <class Positions>
Settled ridden(const Space<Positions>& space, SimplexId simplex, const Weights& w) {
  const Corners v = space.corners(simplex);
  return settle(space, simplex, v, combine(v, w));
}

/// Frobenius norm of the gradient of the displacement that takes simplex v to simplex w, and v's shortest edge.
struct Deformation {
  double gradient;
  double edge;
};
inline Deformation deformation(const Corners& v, const Corners& w) {
  const std::array<Vec3, 3> e = {v[1] - v[0], v[2] - v[0], v[3] - v[0]};
  const Vec3 u0 = w[0] - v[0];
  const std::array<Vec3, 3> u = {(w[1] - v[1]) - u0, (w[2] - v[2]) - u0, (w[3] - v[3]) - u0};
  const std::array<Vec3, 3> dual = {cross(e[1], e[2]), cross(e[2], e[0]), cross(e[0], e[1])};
  const double volume = dot(e[0], dual[0]);
  double sum = 0.0;  // A = sum of u_i dual_i^T / volume
  for (unsigned row = 0; row < 3; ++row) {
    const auto at = [row](const Vec3& x) { return row == 0 ? x.x : row == 1 ? x.y : x.z; };
    const Vec3 a = (dual[0] * at(u[0]) + dual[1] * at(u[1]) + dual[2] * at(u[2])) * (1.0 / volume);
    sum += dot(a, a);
  }
  double shortest = std::numeric_limits<double>::max();
  for (unsigned i = 0; i < 4; ++i) {
    for (unsigned j = i + 1; j < 4; ++j) shortest = std::min(shortest, dot(v[j] - v[i], v[j] - v[i]));
  }
  return {std::sqrt(sum), std::sqrt(shortest)};
}

}  // namespace dartcast::detail
