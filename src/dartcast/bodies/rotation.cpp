#include "dartcast/bodies/rotation.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

namespace dartcast {

namespace {

// Squares of entries, and their products, neither overflow nor vanish for norms within these.
constexpr double smallest_norm2 = 0x1p-300;
constexpr double largest_norm2 = 0x1p+300;

// A pivot of the second derivative below this share of the norm says that the maximum is not unique, or hardly so.
constexpr double pivot_share = 0x1p-40;

// Solves H w = t for the symmetric H by Cholesky's method; nothing where H is not positive definite.
std::optional<Vec3> solve_positive(double xx, double xy, double xz, double yy, double yz, double zz, const Vec3& t,
                                   double least) {
  if (!(xx > least)) return std::nullopt;
  const double lyx = xy / xx;
  const double lzx = xz / xx;
  const double dy = yy - lyx * xy;
  if (!(dy > least)) return std::nullopt;
  const double r = yz - lyx * xz;
  const double lzy = r / dy;
  const double dz = (zz - lzx * xz) - lzy * r;
  if (!(dz > least)) return std::nullopt;
  const double y = t.y - lyx * t.x;
  const double z = ((t.z - lzx * t.x) - lzy * y) / dz;
  const double wy = y / dy - lzy * z;
  return Vec3{(t.x / xx - lyx * wy) - lzx * z, wy, z};
}

// Newton's method for the maximum of trace(R^T A) over rotations R exp(w): with M = R^T A the first derivative is the
// axial vector of M, the second -(trace(M) 1 - sym(M)). That it is negative definite proves a maximum that is unique:
// its eigenvalues are sums of two singular values, the least one with the sign of det A.
std::optional<Quaternion> newton(const Mat3& a, Quaternion q, double norm) {
  for (int i = 0; i < rotation_iterations; ++i) {
    const Mat3 r = matrix(q);
    const double xx = dot(r.x, a.x);
    const double yy = dot(r.y, a.y);
    const double zz = dot(r.z, a.z);
    const double xy = dot(r.x, a.y);
    const double yx = dot(r.y, a.x);
    const double xz = dot(r.x, a.z);
    const double zx = dot(r.z, a.x);
    const double yz = dot(r.y, a.z);
    const double zy = dot(r.z, a.y);
    const Vec3 t = {zy - yz, xz - zx, yx - xy};
    const auto w = solve_positive(yy + zz, -0.5 * (xy + yx), -0.5 * (xz + zx), xx + zz, -0.5 * (yz + zy), xx + yy, t,
                                  pivot_share * norm);
    if (!w) return std::nullopt;
    if (dot(t, t) <= (rotation_residual * norm) * (rotation_residual * norm)) return q;
    q = normalized(q * Quaternion{1.0, *w * 0.5});
  }
  return std::nullopt;
}

// U V^T, with the least singular value's direction turned round where that is a reflection.
Quaternion by_svd(const Mat3& a) {
  Eigen::Matrix3d m;
  m << a.x.x, a.y.x, a.z.x, a.x.y, a.y.y, a.z.y, a.x.z, a.y.z, a.z.z;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0.0) u.col(2) = -u.col(2);
  const Eigen::Quaterniond q(Eigen::Matrix3d(u * svd.matrixV().transpose()));
  return normalized({q.w(), {q.x(), q.y(), q.z()}});
}

double largest_entry(const Mat3& a) {
  double largest = 0.0;
  for (const Vec3& c : {a.x, a.y, a.z}) largest = std::max({largest, std::abs(c.x), std::abs(c.y), std::abs(c.z)});
  return largest;
}

// Precondition: the squared norm is in range.
Rotation nearest_in_range(const Mat3& a, const Quaternion& start) {
  if (const auto q = newton(a, start, std::sqrt(dot(a, a)))) return {*q, false};
  return {by_svd(a), true};
}

}  // namespace

Rotation nearest_rotation(const Mat3& a, const Quaternion& start) {
  const double norm2 = dot(a, a);
  if (norm2 >= smallest_norm2 && norm2 <= largest_norm2) return nearest_in_range(a, start);
  const double largest = largest_entry(a);
  if (largest == 0.0) return {start, false};
  const double scale = std::ldexp(1.0, -std::ilogb(largest) / 2);  // in two halves: the whole may overflow
  const double rest = std::ldexp(1.0, -std::ilogb(largest * scale));
  return nearest_in_range((a * scale) * rest, start);
}

}  // namespace dartcast
