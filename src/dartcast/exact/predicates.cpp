#include "dartcast/exact/predicates.hpp"

#include <algorithm>
#include <limits>

#include "dartcast/exact/expansion.hpp"

namespace dartcast {

namespace {

bool in_exact_range(double x) {
  const double m = std::abs(x);
  return m == 0.0 || (m >= smallest_magnitude && m <= largest_magnitude);  // false for NaN
}

struct ExactVector {
  Expansion<2> x, y, z;
};

ExactVector exact_difference(const Vec3& a, const Vec3& b) {
  return {difference(a.x, b.x), difference(a.y, b.y), difference(a.z, b.z)};
}

// det[b - a, c - a, d - a], expanded along the coordinates of a - d.
Expansion<192> exact_determinant(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const ExactVector u = exact_difference(a, d);
  const ExactVector v = exact_difference(c, d);
  const ExactVector w = exact_difference(b, d);
  return u.x * (v.y * w.z - v.z * w.y) + u.y * (v.z * w.x - v.x * w.z) + u.z * (v.x * w.y - v.y * w.x);
}

bool all_in_range(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return in_exact_range(a) && in_exact_range(b) && in_exact_range(c) && in_exact_range(d);
}

// The determinant in doubles and a bound of its error.
struct Filtered {
  double value;
  double bound;
  bool applies;

  [[nodiscard]] bool decided() const { return applies && std::abs(value) > bound; }
};

Filtered filtered_determinant(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = a - d;
  const Vec3 v = c - d;
  const Vec3 w = b - d;
  const auto largest = [](double p, double q, double r) { return std::max({std::abs(p), std::abs(q), std::abs(r)}); };
  const double x = largest(u.x, v.x, w.x);
  const double y = largest(u.y, v.y, w.y);
  const double z = largest(u.z, v.z, w.z);
  const double m = x * y * z;
  return {dot(u, cross(v, w)), determinant_error * m, filter_applies(std::max({x, y, z}), m)};
}

}  // namespace

bool in_exact_range(const Vec3& p) { return in_exact_range(p.x) && in_exact_range(p.y) && in_exact_range(p.z); }

Sign orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  std::uint64_t exact = 0;
  return orient3d(a, b, c, d, exact);
}

Sign orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, std::uint64_t& exact) {
  const Filtered f = filtered_determinant(a, b, c, d);
  if (f.decided()) return f.value > 0.0 ? Sign::positive : Sign::negative;
  ++exact;
  return orient3d_exact(a, b, c, d);
}

Sign orient3d_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  if (!all_in_range(a, b, c, d)) return Sign::undecidable;
  return static_cast<Sign>(exact_determinant(a, b, c, d).sign());
}

double orient3d_value(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Filtered f = filtered_determinant(a, b, c, d);
  constexpr double enough = 0x1p+49;
  if (f.decided() && std::abs(f.value) > enough * f.bound) return f.value;
  if (!all_in_range(a, b, c, d)) return std::numeric_limits<double>::quiet_NaN();
  return exact_determinant(a, b, c, d).estimate();
}

namespace {

using ExactNormal = std::array<Expansion<16>, 3>;

// Cross product of two differences.
ExactNormal exact_cross(const ExactVector& u, const ExactVector& v) {
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

}  // namespace

Shift::Shift(const Vec3& p, std::span<const Vec3> opposite) : count_(opposite.size()), in_range_(in_exact_range(p)) {
  for (std::size_t i = 0; i < count_; ++i) {
    const ExactVector d = exact_difference(opposite[i], p);
    toward_[i] = {d.x, d.y, d.z};
    in_range_ = in_range_ && in_exact_range(opposite[i]);
  }
}

template <class Normal>
Sign Shift::sign_along(const Normal& n) const {
  Expansion<576> along;
  for (std::size_t i = 0; i < count_; ++i) {
    const auto& w = toward_[i];
    const auto sum = along + (n[0] * w[0] + n[1] * w[1] + n[2] * w[2]);
    along.size = std::min<std::size_t>(sum.size, 576);
    std::copy_n(sum.component.begin(), along.size, along.component.begin());
  }
  if (const int s = along.sign(); s != 0) return static_cast<Sign>(s);
  for (const auto& coordinate : n) {
    if (const int s = coordinate.sign(); s != 0) return static_cast<Sign>(s);
  }
  return Sign::zero;
}

Sign Shift::of_plane(const Vec3& a, const Vec3& b, const Vec3& c) const {
  if (!in_range_ || !in_exact_range(a) || !in_exact_range(b) || !in_exact_range(c)) return Sign::undecidable;
  return sign_along(exact_cross(exact_difference(b, a), exact_difference(c, a)));
}

Sign Shift::of_line(const Vec3& a, const Vec3& b, const Vec3& p, const Vec3& q) const {
  if (!in_range_ || !all_in_range(a, b, p, q)) return Sign::undecidable;
  return sign_along(exact_cross(exact_difference(q, p), exact_difference(b, a)));
}

}  // namespace dartcast
