// Coordinates in four simplices, values there, and maps between simplices, one in each lane. The operations are those of
// detail::barycentric() and of VectorField::at(), in their order.
#pragma once

#include "base/double4.inl"
#include "tracking/batch/batch_simplex.inl"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

struct Weights4 {
  Double4 at[4];
};

// The barycentric coordinates that the determinants prove.
inline Weights4 weights_of(const BatchDeterminants& d) {
  Weights4 w;
  for (unsigned i = 0; i < 4; ++i) w.at[i] = choose(d.value[i] < splat(0.0), splat(0.0), d.value[i]);
  const Double4 sum = ((w.at[0] + w.at[1]) + w.at[2]) + w.at[3];
  for (Double4& c : w.at) c /= sum;
  return w;
}

inline Vec3x4 combine(const Corners4& v, const Weights4& w) {
  return (v.corner[0] * w.at[0] + v.corner[1] * w.at[1]) + (v.corner[2] * w.at[2] + v.corner[3] * w.at[3]);
}

// The linear map that takes the edges of one simplex to those of another, applied to u.
inline Vec3x4 mapped(const Corners4& from, const Corners4& to, const Vec3x4& u) {
  const Vec3x4 a = from.corner[1] - from.corner[0];
  const Vec3x4 b = from.corner[2] - from.corner[0];
  const Vec3x4 c = from.corner[3] - from.corner[0];
  const Vec3x4 across = cross(b, c);
  const Double4 volume = dot(a, across);
  const Vec3x4 moved = (to.corner[1] - to.corner[0]) * dot(across, u) +
                       (to.corner[2] - to.corner[0]) * dot(cross(c, a), u) +
                       (to.corner[3] - to.corner[0]) * dot(cross(a, b), u);
  return choose(volume > splat(0.0), moved * (splat(1.0) / volume), u);
}

// As raised() of cell_complex.hpp.
inline void raise(Corners4& v) {
  for (unsigned i = 0; i < 3; ++i) v.corner[i].z = splat(0.0);
  v.corner[3] = {v.corner[0].x, v.corner[0].y, splat(1.0)};
}

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
