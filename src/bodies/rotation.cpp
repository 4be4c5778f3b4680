// The nearest rotation: Newton's method from a guess, else Eigen's JacobiSVD.
#include "bodies/rotation.hpp"

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

// A symmetric matrix.
struct Symmetric {
  double xx, xy, xz, yy, yz, zz;
};

// Leading minors above this share of the norm's powers prove a matrix positive definite. Its pivots are far above
// pivot_share: entries are at most 2 norms, so pivots are quotients above 2^-23 norms. The rounding of the entries and
// of the minors, of at most some 50 products of three, is less than 2^-44.
constexpr double minor_share = 0x1p-20;

// Solves H w = t by Cholesky's method; nothing if H is not positive definite.
std::optional<Vec3> solve_positive(const Symmetric& h, const Vec3& t, double lowest) {
  if (!(h.xx > lowest)) return std::nullopt;
  const double lyx = h.xy / h.xx;
  const double lzx = h.xz / h.xx;
  const double dy = h.yy - lyx * h.xy;
  if (!(dy > lowest)) return std::nullopt;
  const double r = h.yz - lyx * h.xz;
  const double lzy = r / dy;
  const double dz = (h.zz - lzx * h.xz) - lzy * r;
  if (!(dz > lowest)) return std::nullopt;
  const double y = t.y - lyx * t.x;
  const double z = ((t.z - lzx * t.x) - lzy * y) / dz;
  const double wy = y / dy - lzy * z;
  return Vec3{(t.x / h.xx - lyx * wy) - lzx * z, wy, z};
}

// The adjugate and the determinant avoid a division, because quaternions are normalized later. For norms within the
// bounds above, determinants and their squares neither overflow nor vanish.
struct Adjugate {
  double xx, xy, xz, yy, yz, zz;
  double determinant;
  bool proves_positive;  // by the leading minors; false: unknown

  Adjugate(const Symmetric& h, double norm)
      : xx(h.yy * h.zz - h.yz * h.yz),
        xy(h.xz * h.yz - h.xy * h.zz),
        xz(h.xy * h.yz - h.xz * h.yy),
        yy(h.xx * h.zz - h.xz * h.xz),
        yz(h.xy * h.xz - h.xx * h.yz),
        zz(h.xx * h.yy - h.xy * h.xy),
        determinant((h.xx * xx + h.xy * xy) + h.xz * xz) {
    const double lowest = minor_share * norm;
    proves_positive = h.xx > lowest && zz > lowest * norm && determinant > lowest * norm * norm;
  }

  // The determinant times the w that solves H w = t.
  [[nodiscard]] Vec3 times(const Vec3& t) const {
    return {(xx * t.x + xy * t.y) + xz * t.z, (xy * t.x + yy * t.y) + yz * t.z, (xz * t.x + yz * t.y) + zz * t.z};
  }
};

// Newton's method for the maximum of trace(R^T A) over rotations R exp(w). Let M = R^T A. The first derivative is the
// axial vector of M, the second is -(trace(M) 1 - sym(M)). If the second is negative definite the maximum is unique.
// Its eigenvalues are sums of two singular values, the least one with the sign of det A.
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
    const Symmetric h = {yy + zz, -0.5 * (xy + yx), -0.5 * (xz + zx), xx + zz, -0.5 * (yz + zy), xx + yy};
    const Adjugate adjugate(h, norm);
    const bool done = dot(t, t) <= (rotation_residual * norm) * (rotation_residual * norm);
    if (done && adjugate.proves_positive) return q;
    Quaternion turn = {adjugate.determinant, adjugate.times(t) * 0.5};
    if (!adjugate.proves_positive) {
      const auto w = solve_positive(h, t, pivot_share * norm);
      if (!w) return std::nullopt;
      if (done) return q;
      turn = {1.0, *w * 0.5};
    }
    q = normalized(q * turn);
  }
  return std::nullopt;
}

// U V^T, with the direction of the least singular value reversed if that product is a reflection.
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
  const double scale =
      std::ldexp(1.0, -std::ilogb(largest) / 2);  // applied twice, because the whole factor may overflow
  const double rest = std::ldexp(1.0, -std::ilogb(largest * scale));
  return nearest_in_range((a * scale) * rest, start);
}

}  // namespace dartcast
