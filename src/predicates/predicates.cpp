// Signs of determinants in stages: a filter, cases in which doubles are exact, double-doubles, expansions.
#include "dartcast/predicates.hpp"

#include <algorithm>
#include <limits>

#include "predicates/expansion.hpp"

namespace dartcast {

namespace {

template <class... Points>
bool all_in_range(const Points&... points) {
  return (in_exact_range(points) && ...);
}

Sign sign(double x) { return x > 0.0 ? Sign::positive : x < 0.0 ? Sign::negative : Sign::zero; }

// Differences as expansions of N components each: 2, or 1 if none of them is rounded.
template <std::size_t N>
struct ExactVector {
  Expansion<N> x, y, z;
};

template <std::size_t N>
ExactVector<N> exact_difference(const Vec3& a, const Vec3& b) {
  if constexpr (N == 2) {
    return {difference(a.x, b.x), difference(a.y, b.y), difference(a.z, b.z)};
  } else {
    ExactVector<N> d;
    d.x.push(a.x - b.x);
    d.y.push(a.y - b.y);
    d.z.push(a.z - b.z);
    return d;
  }
}

bool rounds_difference(const Vec3& a, const Vec3& b) {
  return detail::two_sum(a.x, -b.x).low != 0.0 || detail::two_sum(a.y, -b.y).low != 0.0 ||
         detail::two_sum(a.z, -b.z).low != 0.0;
}

template <std::size_t N>
ExactVector<4 * N * N> exact_cross(const ExactVector<N>& u, const ExactVector<N>& v) {
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

template <std::size_t N, std::size_t M>
auto exact_dot(const ExactVector<N>& u, const ExactVector<M>& v) {
  return u.x * v.x + u.y * v.y + u.z * v.z;
}

// det[b - a, c - a, d - a], expanded along the coordinates of a - d.
template <std::size_t N>
auto exact_determinant(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return exact_dot(exact_difference<N>(a, d), exact_cross(exact_difference<N>(c, d), exact_difference<N>(b, d)));
}

// Two equal points: the determinant is 0. At a vertex this is the usual case that the filter leaves open.
bool has_equal(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return a == d || b == d || c == d || a == b || a == c || b == c;
}

// Calls use(determinant) with an expansion that is no longer than necessary.
template <class Use>
auto with_exact_determinant(const Vec3& a0, const Vec3& b0, const Vec3& c0, const Vec3& d0, Use&& use) {
  const Vec3 a = flushed(a0);
  const Vec3 b = flushed(b0);
  const Vec3 c = flushed(c0);
  const Vec3 d = flushed(d0);
  if (rounds_difference(a, d) || rounds_difference(b, d) || rounds_difference(c, d))
    return use(exact_determinant<2>(a, b, c, d));
  return use(exact_determinant<1>(a, b, c, d));
}

// The determinant in doubles and a bound of its error.
struct Filtered {
  double value;
  double m;
  Vec3 extent;

  /// Whether the value exceeds this multiple of its bound.
  [[nodiscard]] bool exceeds(double times) const { return std::abs(value) > times * (determinant_error * m); }
};

Filtered filtered_determinant(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = a - d;
  const Vec3 v = c - d;
  const Vec3 w = b - d;
  const Vec3 extent = extent_of(u, v, w);
  return {dot(u, cross(v, w)), extent.x * extent.y * extent.z, extent};
}

// Sums and products of double-doubles. Each is off by a few 2^-106 of the magnitudes of its terms.
using detail::TwoTerms;

// a b - c d
TwoTerms paired_minor(double a, double b, double c, double d) {
  const TwoTerms p = detail::two_product(a, b);
  const TwoTerms q = detail::two_product(c, d);
  const TwoTerms sum = detail::two_sum(p.high, -q.high);
  return detail::two_sum(sum.high, sum.low + (p.low - q.low));
}
TwoTerms paired_product(double a, const TwoTerms& b) {
  const TwoTerms p = detail::two_product(a, b.high);
  return {p.high, p.low + a * b.low};
}

// The determinant as a double-double, if differences round nothing. It is off by less than 2^-97 m, where m is the
// product of the extents. A minor of v and w is off by 3 2^-106 of the sum of its products' magnitudes. Each of the
// three products with u is off by 3 2^-106 of itself more, and their sum by 24 2^-106 of all. In all this is less than
// 2^-101 of the permanent, which is at most 6 m. Within the exact range nothing under- or overflows.
double paired_determinant(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = a - d;
  const Vec3 v = c - d;
  const Vec3 w = b - d;
  const TwoTerms x = paired_product(u.x, paired_minor(v.y, w.z, v.z, w.y));
  const TwoTerms y = paired_product(u.y, paired_minor(v.z, w.x, v.x, w.z));
  const TwoTerms z = paired_product(u.z, paired_minor(v.x, w.y, v.y, w.x));
  const TwoTerms xy = detail::two_sum(x.high, y.high);
  const TwoTerms xyz = detail::two_sum(xy.high, z.high);
  return xyz.high + (xyz.low + (xy.low + ((x.low + y.low) + z.low)));
}

}  // namespace

Sign orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  std::uint64_t exact = 0;
  return orient3d(a, b, c, d, exact);
}

Sign orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, std::uint64_t& exact) {
  const Filtered f = filtered_determinant(a, b, c, d);
  if (f.exceeds(1.0) && filter_applies(f.extent)) return sign(f.value);
  ++exact;
  return orient3d_exact(a, b, c, d);
}

Sign orient3d_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  if (!all_in_range(a, b, c, d)) return Sign::undecidable;
  const Filtered f = filtered_determinant(a, b, c, d);
  // Points of a plane perpendicular to an axis: a rounded difference is 0 only if the exact one is.
  if (f.extent.x == 0.0 || f.extent.y == 0.0 || f.extent.z == 0.0 || has_equal(a, b, c, d)) return Sign::zero;
  if (bound_holds(f.extent) && rounds_nothing(f.extent, a, b, c, d)) return sign(f.value);
  return with_exact_determinant(a, b, c, d, [](const auto& value) { return static_cast<Sign>(value.sign()); });
}

double orient3d_value(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Filtered f = filtered_determinant(a, b, c, d);
  constexpr double enough = 0x1p+49;
  if (f.exceeds(enough) && filter_applies(f.extent)) return f.value;
  if (!all_in_range(a, b, c, d)) return std::numeric_limits<double>::quiet_NaN();
  if (has_equal(a, b, c, d)) return 0.0;
  const bool bounded = bound_holds(f.extent);
  if (bounded && (f.exceeds(enough) || rounds_nothing(f.extent, a, b, c, d))) return f.value;
  if (bounded && !rounds_difference(a, d) && !rounds_difference(b, d) && !rounds_difference(c, d)) {
    const double value = paired_determinant(flushed(a), flushed(b), flushed(c), flushed(d));
    if (std::abs(value) >= 0x1p-47 * f.m) return value;  // accurate to 2^-50 of itself, and then rounded once
  }
  return with_exact_determinant(a, b, c, d, [](const auto& value) { return value.estimate(); });
}

namespace {

struct PlaneFiltered {
  double value;
  double x, y;  // the largest differences

  [[nodiscard]] bool exceeds(double times) const { return std::abs(value) > times * (plane_error * (x * y)); }
};

PlaneFiltered plane_determinant(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double ux = a.x - c.x;
  const double uy = a.y - c.y;
  const double vx = b.x - c.x;
  const double vy = b.y - c.y;
  const double x = std::max(std::abs(ux), std::abs(vx));
  const double y = std::max(std::abs(uy), std::abs(vy));
  return {ux * vy - uy * vx, x, y};
}

template <class... Points>
bool all_in_plane_range(const Points&... points) {
  return (in_exact_range({points.x, points.y, 0.0}) && ...);
}

// The exact determinant as an expansion of at most 16 components.
auto exact_plane_determinant(const Vec3& a0, const Vec3& b0, const Vec3& c0) {
  const Vec3 a = flushed(a0);
  const Vec3 b = flushed(b0);
  const Vec3 c = flushed(c0);
  return difference(a.x, c.x) * difference(b.y, c.y) - difference(a.y, c.y) * difference(b.x, c.x);
}

}  // namespace

Sign orient2d(const Vec3& a, const Vec3& b, const Vec3& c) {
  std::uint64_t exact = 0;
  return orient2d(a, b, c, exact);
}

Sign orient2d(const Vec3& a, const Vec3& b, const Vec3& c, std::uint64_t& exact) {
  const PlaneFiltered f = plane_determinant(a, b, c);
  if (f.exceeds(1.0) && plane_filter_applies(f.x, f.y)) return sign(f.value);
  ++exact;
  return orient2d_exact(a, b, c);
}

Sign orient2d_exact(const Vec3& a, const Vec3& b, const Vec3& c) {
  if (!all_in_plane_range(a, b, c)) return Sign::undecidable;
  const PlaneFiltered f = plane_determinant(a, b, c);
  if (f.x == 0.0 || f.y == 0.0) return Sign::zero;  // on a line perpendicular to an axis
  return static_cast<Sign>(exact_plane_determinant(a, b, c).sign());
}

double orient2d_value(const Vec3& a, const Vec3& b, const Vec3& c) {
  const PlaneFiltered f = plane_determinant(a, b, c);
  constexpr double enough = 0x1p+49;
  if (f.exceeds(enough) && plane_filter_applies(f.x, f.y)) return f.value;
  if (!all_in_plane_range(a, b, c)) return std::numeric_limits<double>::quiet_NaN();
  if (f.exceeds(enough) && plane_bound_holds(f.x, f.y)) return f.value;
  return exact_plane_determinant(a, b, c).estimate();
}

SymbolicPerturbation::SymbolicPerturbation(const Vec3& p, std::span<const Vec3> opposite) : p_(p) {
  opposite_.fill(p);
  std::copy(opposite.begin(), opposite.end(), opposite_.begin());
}

// With n = (q - p) x (b - a), the terms are n.w, n.x, n.y and n.z.
Sign SymbolicPerturbation::of_line(const Vec3& a, const Vec3& b, const Vec3& q) const {
  const auto& [o0, o1, o2] = opposite_;
  const Vec3 extent = extent_of(q - p_, b - a, o0 - p_, o1 - p_, o2 - p_);
  const Vec3 n = cross(q - p_, b - a);
  const double along = dot(n, (o0 - p_) + (o1 - p_) + (o2 - p_));
  // There are four roundings in a component of n, three in one of w, one in their product and two in the sum. The
  // total is 10 e for each of 18 products, each at most m. The last factor is that of determinant_error.
  constexpr double error = 180.0 * 0x1p-53 * (1.0 + 0x1p-10);
  const double m = extent.x * extent.y * extent.z;
  if (filter_applies(extent) && std::abs(along) > error * m) return sign(along);
  const auto in_range = [](double e) { return e == 0.0 || (e >= 0x1p-250 && e <= 0x1p+301); };
  if (!in_range(extent.x) || !in_range(extent.y) || !in_range(extent.z) ||
      !rounds_nothing(extent, p_, q, a, b, o0, o1, o2))
    return of_line_exact(a, b, q);
  for (const double term : {along, n.x, n.y, n.z}) {
    if (term != 0.0) return sign(term);
  }
  return Sign::zero;
}

Sign SymbolicPerturbation::of_line_exact(const Vec3& a, const Vec3& b, const Vec3& q) const {
  if (!all_in_range(p_, opposite_[0], opposite_[1], opposite_[2], a, b, q)) return Sign::undecidable;
  const auto difference_of = [](const Vec3& u, const Vec3& v) { return exact_difference<2>(flushed(u), flushed(v)); };
  const auto n = exact_cross(difference_of(q, p_), difference_of(b, a));
  const auto along = exact_dot(n, difference_of(opposite_[0], p_)) + exact_dot(n, difference_of(opposite_[1], p_)) +
                     exact_dot(n, difference_of(opposite_[2], p_));
  for (const int term : {along.sign(), n.x.sign(), n.y.sign(), n.z.sign()}) {
    if (term != 0) return static_cast<Sign>(term);
  }
  return Sign::zero;
}

PlanarSymbolicPerturbation::PlanarSymbolicPerturbation(const Vec3& p, std::span<const Vec3> opposite) : p_(flushed(p)) {
  opposite_.fill(p_);
  std::copy(opposite.begin(), opposite.end(), opposite_.begin());
}

// With d = q - p the terms are w x d, d.y and -d.x; (o - p) x (q - p) is that of o, q and p.
Sign PlanarSymbolicPerturbation::of_line(const Vec3& q0) const {
  const Vec3 q = flushed(q0);
  if (!all_in_plane_range(p_, q, opposite_[0], opposite_[1])) return Sign::undecidable;
  const auto along = exact_plane_determinant(opposite_[0], q, p_) + exact_plane_determinant(opposite_[1], q, p_);
  if (along.sign() != 0) return static_cast<Sign>(along.sign());
  if (q.y != p_.y) return sign(q.y > p_.y ? 1.0 : -1.0);
  return q.x < p_.x ? Sign::positive : q.x > p_.x ? Sign::negative : Sign::zero;
}

}  // namespace dartcast
