// The volume of a simplex with corners on straight lines: a cubic in time, and its first root.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "complex/simplex.hpp"
#include "dartcast/predicates.hpp"

namespace dartcast::detail {

/// Values before and after a motion, side by side: one register of every processor with vectors.
using Ends = double __attribute__((vector_size(16)));

struct EndsVec3 {
  Ends x, y, z;
};

inline Ends exchanged(Ends a) { return __builtin_shufflevector(a, a, 1, 0); }
inline EndsVec3 exchanged(const EndsVec3& a) { return {exchanged(a.x), exchanged(a.y), exchanged(a.z)}; }
inline EndsVec3 ends_of(const Vec3& before, const Vec3& after) {
  return {Ends{before.x, after.x}, Ends{before.y, after.y}, Ends{before.z, after.z}};
}
inline EndsVec3 operator-(const EndsVec3& a, const EndsVec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline EndsVec3 cross(const EndsVec3& a, const EndsVec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Ends dot(const EndsVec3& a, const EndsVec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

inline double largest_of(Ends a, Ends b, Ends c) {
  const auto magnitude = [](Ends v) {
    using Bits = long long __attribute__((vector_size(16)));
    constexpr long long all_but_sign = 0x7fffffffffffffff;
    return reinterpret_cast<Ends>(reinterpret_cast<Bits>(v) & Bits{all_but_sign, all_but_sign});
  };
  const auto larger = [](Ends v, Ends w) { return v > w ? v : w; };
  const Ends both = larger(larger(magnitude(a), magnitude(b)), magnitude(c));
  return std::max(both[0], both[1]);
}

/// Also false if one is not a number.
inline bool all_above(const std::array<double, 4>& b, double bound) {
  return b[0] > bound && b[1] > bound && b[2] > bound && b[3] > bound;
}

/// Six times the volume is c0 s^3 + c1 s^2 t + c2 s t^2 + c3 t^3 with s = 1 - t, Bernstein's form without its factors
/// of 3: positive in all of [0, 1] if all coefficients are.
struct VolumeCubic {
  std::array<double, 4> c;
  double m;      ///< product of the largest |x|, |y| and |z| among the edges from corner 0, before and after
  bool applies;  ///< whether the bound below holds

  /// Edges: p before, q after. Then c0 = [p1 p2 p3], c1 = [q1 p2 p3] + [p1 q2 p3] + [p1 p2 q3], c2 likewise.
  VolumeCubic(const EndsVec3& v0, const EndsVec3& v1, const EndsVec3& v2, const EndsVec3& v3) {
    const EndsVec3 e1 = v1 - v0;
    const EndsVec3 e2 = v2 - v0;
    const EndsVec3 e3 = v3 - v0;
    const EndsVec3 same = cross(e2, e3);              // (p2 x p3, q2 x q3)
    const EndsVec3 other = cross(e2, exchanged(e3));  // (p2 x q3, q2 x p3)
    const EndsVec3 mixed = {other.x + exchanged(other.x), other.y + exchanged(other.y), other.z + exchanged(other.z)};
    const Ends outer = dot(e1, same);
    const Ends inner = dot(exchanged(e1), same) + dot(e1, mixed);
    c = {outer[0], inner[0], inner[1], outer[1]};
    const double x = largest_of(e1.x, e2.x, e3.x);
    const double y = largest_of(e1.y, e2.y, e3.y);
    const double z = largest_of(e1.z, e2.z, e3.z);
    m = x * y * z;
    applies = filter_applies({x, y, z});
  }

  VolumeCubic(const Corners& before, const Corners& after)
      : VolumeCubic(ends_of(before[0], after[0]), ends_of(before[1], after[1]), ends_of(before[2], after[2]),
                    ends_of(before[3], after[3])) {}

  /// Each coefficient is off by at most this times m. Both c1 and c2 are 18 products of at most m, each rounded ten
  /// times (three differences, product, difference, sum, product, two sums, sum), each by e = 2^-53. Both c0 and c3 are
  /// off by determinant_error. The last factor is that of determinant_error.
  static constexpr double coefficient_error = 180.0 * 0x1p-53 * (1.0 + 0x1p-10);

  [[nodiscard]] bool proves_positive() const { return applies && all_above(c, coefficient_error * m); }
  /// Whether halving [0, t] a few times proves the volume positive there. Precondition: 1 - t is not rounded.
  [[nodiscard]] bool proves_positive_until(double t) const;
};

/// Times are multiples of this: the volume's roots are found between two of them.
inline constexpr double time_unit = 0x1p-40;

struct VolumeRoot {
  enum class Outcome : std::uint8_t {
    stays_positive,
    reaches_zero,
    never_positive,  ///< at the time 0
    undecidable      ///< a coordinate is not finite or outside the exact range
  };
  Outcome fate = Outcome::stays_positive;
  double safe_time = 0.0;  ///< the last multiple of time_unit before the volume first reaches zero
};

/// The first root of the volume in [0, until], without rounding. Precondition: `until` is a multiple of time_unit in
/// [0, 1]. Cost: tens of microseconds. Callers use it if the filters above decide nothing.
VolumeRoot first_root(const Corners& before, const Corners& after, double until);

}  // namespace dartcast::detail
