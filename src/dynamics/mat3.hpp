// Arithmetic of 3 by 3 matrices and of rotations: the part that shape matching needs.
#pragma once

#include <cmath>

#include "dartcast/dynamics.hpp"

namespace dartcast {

constexpr Mat3 operator+(const Mat3& a, const Mat3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Mat3 operator-(const Mat3& a, const Mat3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Mat3 operator*(const Mat3& a, double s) { return {a.x * s, a.y * s, a.z * s}; }
constexpr Vec3 operator*(const Mat3& a, const Vec3& v) { return (a.x * v.x + a.y * v.y) + a.z * v.z; }
constexpr Mat3 operator*(const Mat3& a, const Mat3& b) { return {a * b.x, a * b.y, a * b.z}; }

constexpr Mat3 zero_matrix() { return {{}, {}, {}}; }
/// a b^T.
constexpr Mat3 outer(const Vec3& a, const Vec3& b) { return {a * b.x, a * b.y, a * b.z}; }
constexpr double determinant(const Mat3& a) { return dot(a.x, cross(a.y, a.z)); }
/// Sum of the products of entries: the trace of a^T b.
constexpr double dot(const Mat3& a, const Mat3& b) { return (dot(a.x, b.x) + dot(a.y, b.y)) + dot(a.z, b.z); }

constexpr Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  return {a.w * b.w - dot(a.v, b.v), (b.v * a.w + a.v * b.w) + cross(a.v, b.v)};
}

/// The quaternion scaled to length 1. Precondition: it is not 0.
inline Quaternion normalized(const Quaternion& q) {
  const double s = 1.0 / std::sqrt(q.w * q.w + dot(q.v, q.v));
  return {q.w * s, q.v * s};
}

/// The rotation's matrix. Precondition: of length 1.
constexpr Mat3 matrix(const Quaternion& q) {
  const Vec3 d = q.v + q.v;
  const Vec3 w = d * q.w;
  const double xx = q.v.x * d.x;
  const double yy = q.v.y * d.y;
  const double zz = q.v.z * d.z;
  const double xy = q.v.x * d.y;
  const double xz = q.v.x * d.z;
  const double yz = q.v.y * d.z;
  return {{1.0 - (yy + zz), xy + w.z, xz - w.y},
          {xy - w.z, 1.0 - (xx + zz), yz + w.x},
          {xz + w.y, yz - w.x, 1.0 - (xx + yy)}};
}

}  // namespace dartcast
