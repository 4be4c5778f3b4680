// The first root of a moving simplex's volume, by filters and then by integers.
#include "complex/volume_cubic.hpp"

#include <boost/multiprecision/cpp_int.hpp>
#include <limits>

namespace dartcast::detail {

namespace {

using Bernstein = std::array<double, 4>;

// The cubic on [0, t] and on [t, 1], by de Casteljau's algorithm.
struct BernsteinHalves {
  Bernstein left;
  Bernstein right;
};

template <class Mix>
BernsteinHalves split(const Bernstein& b, Mix&& mix) {
  const std::array<double, 3> u = {mix(b[0], b[1]), mix(b[1], b[2]), mix(b[2], b[3])};
  const std::array<double, 2> v = {mix(u[0], u[1]), mix(u[1], u[2])};
  const double middle = mix(v[0], v[1]);
  return {{b[0], u[0], v[0], middle}, {middle, v[1], u[2], b[3]}};
}

bool proves_positive(const Bernstein& b, double bound, int halvings) {
  if (all_above(b, bound)) return true;
  if (halvings == 0 || !(b[0] > bound) || !(b[3] > bound)) return false;
  const BernsteinHalves parts = split(b, [](double x, double y) { return 0.5 * (x + y); });
  return proves_positive(parts.left, bound, halvings - 1) && proves_positive(parts.right, bound, halvings - 1);
}

// Integers of any size. This many bits are stored in place, which is usually enough.
using CubicInteger =
    boost::multiprecision::number<boost::multiprecision::cpp_int_backend<512>, boost::multiprecision::et_off>;
using IntegerVec3 = std::array<CubicInteger, 3>;

// Coordinates of one axis, before and after, as integers over one power of two. The power only scales the volume.
using AxisNumbers = std::array<double, 8>;

std::array<CubicInteger, 8> to_integers(const AxisNumbers& numbers) {
  std::array<std::int64_t, 8> digits;
  std::array<int, 8> exponent;
  int lowest = std::numeric_limits<int>::max();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    digits[i] = static_cast<std::int64_t>(std::ldexp(std::frexp(numbers[i], &exponent[i]), 53));
    if (digits[i] != 0) lowest = std::min(lowest, exponent[i]);
  }
  std::array<CubicInteger, 8> integers;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (digits[i] != 0) integers[i] = CubicInteger(digits[i]) << static_cast<unsigned>(exponent[i] - lowest);
  }
  return integers;
}

IntegerVec3 cross(const IntegerVec3& a, const IntegerVec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

CubicInteger dot(const IntegerVec3& a, const IntegerVec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

IntegerVec3 operator+(const IntegerVec3& a, const IntegerVec3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }

// VolumeCubic without rounding.
class ExactCubic {
 public:
  ExactCubic(const Corners& before, const Corners& after) {
    std::array<IntegerVec3, 3> p;
    std::array<IntegerVec3, 3> q;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto at = [axis](const Vec3& v) {
        const Vec3 x = flushed(v);
        return axis == 0 ? x.x : axis == 1 ? x.y : x.z;
      };
      const auto x = to_integers({at(before[0]), at(before[1]), at(before[2]), at(before[3]), at(after[0]),
                                  at(after[1]), at(after[2]), at(after[3])});
      for (std::size_t i = 0; i < 3; ++i) {
        p[i][axis] = x[i + 1] - x[0];
        q[i][axis] = x[i + 5] - x[4];
      }
    }
    const IntegerVec3 n = cross(p[1], p[2]);
    const IntegerVec3 o = cross(q[1], q[2]);
    const IntegerVec3 mixed = cross(p[1], q[2]) + cross(q[1], p[2]);
    c_ = {dot(p[0], n), dot(q[0], n) + dot(p[0], mixed), dot(p[0], o) + dot(q[0], mixed), dot(q[0], o)};
    const auto& [c0, c1, c2, c3] = c_;
    has_three_roots_ =
        c1 * c1 * c2 * c2 - 4 * (c0 * c2 * c2 * c2 + c1 * c1 * c1 * c3) + c0 * c3 * (18 * c1 * c2 - 27 * c0 * c3) >= 0;
  }

  [[nodiscard]] bool starts_positive() const { return c_[0] > 0; }

  // Whether there is a root in (0, t], t = `units` time units. Precondition: starts_positive().
  //
  // On [0, t] the coefficients are d0 = c0, d1, d2 and d3 = V(t). If d0 and d3 are positive, roots in (0, t) are the
  // positive ones of d0 + d1 x + d2 x^2 + d3 x^3. With a negative discriminant this has one real root, which is
  // negative, since the product of all is -d0 / d3. Else all are real, and as many are positive as there are changes of
  // sign (Descartes): two if d1 or d2 is negative, else none. The discriminant is that of the c times t^6.
  [[nodiscard]] bool reaches_zero_by(std::int64_t units) const {
    const CubicInteger t = units;
    const CubicInteger s = whole - units;
    const auto& [c0, c1, c2, c3] = c_;
    const CubicInteger two = s * (s * c0 + t * c1) + t * t * c2;  // c0 s^2 + c1 s t + c2 t^2
    if (s * two + t * t * t * c3 <= 0) return true;
    if (!has_three_roots_) return false;
    return 3 * s * c0 + t * c1 < 0 || two + s * (2 * s * c0 + t * c1) < 0;
  }

  static constexpr std::int64_t whole = std::int64_t{1} << 40;  // time units in a step
  static_assert(static_cast<double>(whole) * time_unit == 1.0);

 private:
  std::array<CubicInteger, 4> c_;
  bool has_three_roots_;  // counted with multiplicity
};

bool all_in_exact_range(const Corners& v) { return std::all_of(v.begin(), v.end(), in_exact_range); }

}  // namespace

// In Bernstein's form the coefficients b are at most 6 m. In units of e m, e = 2^-53, they are off by 180 / 3, and by 6
// from the division by 3. A split at t rounds three times by 2 * 6, a halving three times by 6.
bool VolumeCubic::proves_positive_until(double t) const {
  constexpr int halvings = 8;
  constexpr double error = (66.0 + 36.0 + 18.0 * halvings) * 0x1p-53 * (1.0 + 0x1p-10);
  const double s = 1.0 - t;
  const Bernstein b = {c[0], c[1] / 3.0, c[2] / 3.0, c[3]};
  const BernsteinHalves parts = split(b, [s, t](double x, double y) { return s * x + t * y; });
  return applies && detail::proves_positive(parts.left, error * m, halvings);
}

VolumeRoot first_root(const Corners& before, const Corners& after, double until) {
  using Outcome = VolumeRoot::Outcome;
  if (!all_in_exact_range(before) || !all_in_exact_range(after)) return {Outcome::undecidable};
  const ExactCubic cubic(before, after);
  if (!cubic.starts_positive()) return {Outcome::never_positive};
  std::int64_t zero_by = static_cast<std::int64_t>(until / time_unit);
  if (!cubic.reaches_zero_by(zero_by)) return {Outcome::stays_positive};
  std::int64_t positive_until = 0;
  while (zero_by - positive_until > 1) {
    const std::int64_t middle = positive_until + (zero_by - positive_until) / 2;
    (cubic.reaches_zero_by(middle) ? zero_by : positive_until) = middle;
  }
  return {Outcome::reaches_zero, static_cast<double>(positive_until) * time_unit};
}

}  // namespace dartcast::detail
