// Carrying along: a particle keeps its barycentric coordinates while the vertices of its simplex move.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tracking/place_in_simplex.hpp"
#include "tracking/step_state.hpp"

namespace dartcast::detail {

/// x's barycentric coordinates in a simplex, negative ones counted as 0; they sum to 1 up to rounding. In the plane
/// the fourth is 0.
template <std::size_t N>
Weights barycentric(const std::array<Vec3, N>& v, const Vec3& x) {
  const Determinants d(v, x);
  Weights w{};
  std::copy(d.value.begin(), d.value.end(), w.begin());
  if (!d.proves_coordinates()) {  // a sliver: the filter's values are mostly rounding
    for (unsigned i = 0; i < N; ++i) w[i] = orient_facet_value(v, i, x);
  }
  double sum = 0.0;
  for (double& c : w) {
    c = std::max(c, 0.0);
    sum += c;
  }
  if (!(sum > 0.0)) {  // flat: any point of it is as good
    std::fill_n(w.begin(), N, 1.0 / N);
    return w;
  }
  for (double& c : w) c /= sum;
  return w;
}

inline Vec3 combine(const Corners& v, const Weights& w) {
  return (v[0] * w[0] + v[1] * w[1]) + (v[2] * w[2] + v[3] * w[3]);
}
inline Vec3 combine(const PlaneCorners& v, const Weights& w) { return (v[0] * w[0] + v[1] * w[1]) + v[2] * w[2]; }

/// The particle with coordinates w, in the moved simplex; placed in the simplex if rounding put it outside.
/// Precondition: the moved simplex is positive.
template <class Positions, std::size_t N>
SimplexPlacement carried(const Space<Positions, N>& space, SimplexId simplex, const Weights& w) {
  const std::array<Vec3, N> v = space.corners(simplex);
  return place_in_simplex(space, simplex, v, combine(v, w));
}

/// The same in a complex as it is now, of space or of the plane.
inline SimplexPlacement carried(const CellComplex& complex, SimplexId simplex, const Weights& w) {
  return complex.map().dimension() == 2 ? carried(current_space<3>(complex), simplex, w)
                                        : carried(current_space<4>(complex), simplex, w);
}

/// The dual basis of the edges from a simplex's first corner, times its volume (in the plane its area).
inline std::array<Vec3, 3> duals(const std::array<Vec3, 3>& e) {
  return {cross(e[1], e[2]), cross(e[2], e[0]), cross(e[0], e[1])};
}
inline std::array<Vec3, 2> duals(const std::array<Vec3, 2>& e) {
  return {Vec3{e[1].y, -e[1].x, 0.0}, Vec3{-e[0].y, e[0].x, 0.0}};
}

/// Frobenius norm of the gradient of the displacement that takes simplex v to simplex w, and v's shortest edge.
struct DisplacementGradient {
  double gradient;
  double edge;
};
template <std::size_t N>
DisplacementGradient displacement_gradient(const std::array<Vec3, N>& v, const std::array<Vec3, N>& w) {
  std::array<Vec3, N - 1> e;
  std::array<Vec3, N - 1> u;
  for (unsigned i = 0; i + 1 < N; ++i) {
    e[i] = v[i + 1] - v[0];
    u[i] = (w[i + 1] - v[i + 1]) - (w[0] - v[0]);
  }
  const auto dual = duals(e);
  const double volume = dot(e[0], dual[0]);
  double sum = 0.0;  // A = sum of u_i dual_i^T / volume
  for (unsigned row = 0; row < 3; ++row) {
    const auto at = [row](const Vec3& x) { return row == 0 ? x.x : row == 1 ? x.y : x.z; };
    Vec3 a = dual[0] * at(u[0]);
    for (unsigned i = 1; i + 1 < N; ++i) a = a + dual[i] * at(u[i]);
    a = a * (1.0 / volume);
    sum += dot(a, a);
  }
  double shortest = std::numeric_limits<double>::max();
  for (unsigned i = 0; i < N; ++i) {
    for (unsigned j = i + 1; j < N; ++j) shortest = std::min(shortest, dot(v[j] - v[i], v[j] - v[i]));
  }
  return {std::sqrt(sum), std::sqrt(shortest)};
}

/// The slices that a step to `target` is split in, of a particle with coordinates `weights`, whose simplex moves.
template <std::size_t N>
unsigned slice_count(const std::array<Vec3, N>& before, const std::array<Vec3, N>& after, const Weights& weights,
                     const Vec3& target, const StepOptions& options) {
  const auto [gradient, edge] = displacement_gradient(before, after);
  const double own = norm(target - combine(after, weights));
  const double slices = std::ceil(std::sqrt(gradient * own / (2.0 * options.tolerance * edge)));
  if (!(slices > 1.0)) return 1;
  return slices < options.max_slices ? static_cast<unsigned>(slices) : options.max_slices;
}

/// The share that the next of `remaining` slices has of the displacement that is planned for all of them, and its target.
struct PartOfWay {
  Vec3 share;
  Vec3 target;
};
inline PartOfWay next_slice(const Vec3& here, const Vec3& planned, unsigned remaining) {
  const Vec3 share = planned * (1.0 / remaining);
  return {share, flushed(here + share)};
}

}  // namespace dartcast::detail
