// The first touch of two moving spheres: a filtered quadratic, exact where rounding leaves it open.
#include "dynamics/sphere_touch.hpp"

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>
#include <limits>

namespace dartcast {

namespace {

using boost::multiprecision::cpp_int;

constexpr double infinity = std::numeric_limits<double>::infinity();

double largest_part(const Vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

// The second sphere as seen from the first: a point that meets a ball of the sum of the radii, when
// a t^2 + 2 b t + c <= 0. Lengths are scaled by a power of two, so that nothing overflows.
struct Relative {
  Vec3 place;
  Vec3 motion;
  double radius;
  double scale = 1.0;  // times this is the true length
  double distance;
  double a;
  double b;
  double c;

  Relative(const SphereMotion& first, const SphereMotion& second)
      : place(second.centre - first.centre),
        motion(second.displacement - first.displacement),
        radius(first.radius + second.radius) {
    const double size = std::max({largest_part(place), largest_part(motion), radius});
    if (size > 0.0 && !(size > 0x1p-100 && size < 0x1p+100)) {
      scale = std::ldexp(1.0, std::ilogb(size));
      place *= 1.0 / scale;
      motion *= 1.0 / scale;
      radius /= scale;
    }
    distance = norm(place);
    a = dot(motion, motion);
    b = dot(place, motion);
    c = (distance - radius) * (distance + radius);
  }

  [[nodiscard]] Vec3 at(double t) const { return place + motion * t; }

  // From the first centre to the second at time t.
  [[nodiscard]] Vec3 normal(double t) const {
    for (const Vec3& along : {at(t), motion}) {
      const double size = largest_part(along);
      if (!(size > 0.0)) continue;
      const Vec3 v = along * (1.0 / size);  // squares of lengths that are small beside the scale vanish
      return v * (1.0 / norm(v));
    }
    return {1.0, 0.0, 0.0};
  }
};

// The first root of a t^2 + 2 b t + c, where c > 0; infinite where there is none.
double first_root(double a, double b, double c) {
  if (!(b < 0.0)) return infinity;
  const double square = b * b - a * c;
  return square < 0.0 ? infinity : c / (std::sqrt(square) - b);
}

// The exact quadratic, in integers of one unit.
struct Quadratic {
  cpp_int a;
  cpp_int b;
  cpp_int c;
};

// A double over 2^exponent. Precondition: it is a multiple of that.
cpp_int units(double x, int exponent) {
  if (x == 0.0) return 0;
  int e = 0;
  const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &e), 53));
  const int shift = e - 53 - exponent;
  return shift >= 0 ? cpp_int(mantissa) << shift : cpp_int(mantissa >> -shift);  // only zeros are shifted out
}

// The exponent of the largest power of two that divides all numbers, or a lower one.
int common_exponent(const SphereMotion& s, int lowest) {
  for (const double x :
       {s.centre.x, s.centre.y, s.centre.z, s.displacement.x, s.displacement.y, s.displacement.z, s.radius}) {
    if (x != 0.0) lowest = std::min(lowest, std::ilogb(x) - 52);
  }
  return lowest;
}

Quadratic exact_quadratic(const SphereMotion& first, const SphereMotion& second) {
  const int e = common_exponent(first, common_exponent(second, std::numeric_limits<int>::max()));
  const auto difference = [e](const Vec3& x, const Vec3& y) {
    return std::array<cpp_int, 3>{units(y.x, e) - units(x.x, e), units(y.y, e) - units(x.y, e),
                                  units(y.z, e) - units(x.z, e)};
  };
  const auto product = [](const std::array<cpp_int, 3>& x, const std::array<cpp_int, 3>& y) {
    return cpp_int(x[0] * y[0] + x[1] * y[1] + x[2] * y[2]);
  };
  const auto place = difference(first.centre, second.centre);
  const auto motion = difference(first.displacement, second.displacement);
  const cpp_int radius = units(first.radius, e) + units(second.radius, e);
  return {product(motion, motion), product(place, motion), product(place, place) - radius * radius};
}

constexpr int time_bits = 31;  // of the grid that exact times are on: half of pair_time_bound

// The last time of the grid before the first root; infinite where there is no root in [0, 1]. Precondition: c > 0.
double exact_root(const Quadratic& q) {
  if (q.b >= 0) return infinity;
  const bool turns_within = q.a + q.b >= 0;
  const bool touches = turns_within ? q.b * q.b >= q.a * q.c : q.a + 2 * q.b + q.c <= 0;
  if (!touches) return infinity;
  const auto before = [&](std::int64_t k) {
    const cpp_int slope = q.a * k + (q.b << time_bits);
    return slope < 0 && (slope + (q.b << time_bits)) * k + (q.c << (2 * time_bits)) > 0;
  };
  std::int64_t low = 0;
  std::int64_t high = std::int64_t{1} << time_bits;
  while (high - low > 1) {
    const std::int64_t middle = (low + high) / 2;
    (before(middle) ? low : high) = middle;
  }
  return std::ldexp(static_cast<double>(low), -time_bits);
}

std::optional<PairTouch> touch_at(const Relative& r, double time) {
  if (!(time <= 1.0)) return std::nullopt;
  return PairTouch{time, false, 0.0, r.normal(time)};
}

PairTouch overlapping(const Relative& r) {
  return {0.0, true, std::max(0.0, r.radius - r.distance) * r.scale, r.normal(0.0)};
}

std::optional<PairTouch> exact_touch(const Relative& r, const SphereMotion& first, const SphereMotion& second) {
  const Quadratic q = exact_quadratic(first, second);
  if (q.c < 0) return overlapping(r);
  if (q.c == 0) return touch_at(r, 0.0);
  return touch_at(r, exact_root(q));
}

}  // namespace

// With u = 2^-53 and s = distance + radius + |motion|: place, motion and radius are off by u of themselves, so that c
// is off by at most 12 u s^2, 2 b t by 12 u s^2 and a t^2 by 6 u s^2, for t in [0, 1]; the rounding of b^2 - a c, at
// most 4 u (b^2 + a |c|), is that of c moved by 8 u s^2, as b^2 <= a s^2. So the true quadratic lies between those
// with c - e and c + e, e = 64 u s^2 (which leaves room for the rounding of s and of c -+ e), and so do the roots,
// apart from 4 u in the last operations. Exact arithmetic decides numbers so small that they may have lost digits to
// underflow.
std::optional<PairTouch> first_meeting(const SphereMotion& a, const SphereMotion& b) {
  const Relative r(a, b);
  const double s = r.distance + r.radius + norm(r.motion);
  const double e = 0x1p-47 * s * s;
  if (r.c < -e) return overlapping(r);
  if (r.c <= e || (r.a > 0.0 && r.a < 0x1p-400)) return exact_touch(r, a, b);
  const double low = first_root(r.a, r.b, r.c - e) - 0x1p-50;
  if (low > 1.0) return std::nullopt;
  const double high = first_root(r.a, r.b, r.c + e) + 0x1p-50;
  if (!(high <= 1.0) || high - low > pair_time_bound) return exact_touch(r, a, b);
  return touch_at(r, std::max(0.0, low));
}

Approach approach(const SphereMotion& a, const SphereMotion& b) {
  const Relative r(a, b);
  Approach result;
  double time = 0.0;
  if (r.c > 0.0 && r.b < 0.0) {
    time = std::min(1.0, -r.b / r.a);
    result.distance = std::max(0.0, norm(r.at(time)) - r.radius);
    if (result.distance == 0.0) time = std::min(time, first_root(r.a, r.b, r.c));
  } else {
    result.distance = r.distance - r.radius;
  }
  result.normal = r.normal(time);
  result.gap = (r.c > 0.0 ? dot(r.place, result.normal) : r.distance) - r.radius;
  result.gap *= r.scale;
  result.distance *= r.scale;
  return result;
}

}  // namespace dartcast
