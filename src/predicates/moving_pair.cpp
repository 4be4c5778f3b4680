// The filter of moving pairs, in doubles with proved bounds. Pairs that it leaves open are filtered again in double-doubles:
// points that rest on walls are nearer to them than a double can show.
//
// Phases: an axis that separates; the cubic of the volume, if it has one sign; else [0, 1] is halved, the earlier part
// first. Forms are kept as Bernstein's coefficients. A part is
// - free, if the volume has one sign. It is free, too, if in some projection two minors of a vertex and a face have
//   opposite signs throughout. So it is if both ends of an edge lie on one side of the other edge. Both hold for flat
//   triangles and parallel edges, too;
// - a touch, if the volume has proved and opposite signs at its ends, and in some projection all points that are coplanar
//   would touch. Then the volume alone is halved further, to find the time.
//
// Bounds, with n halvings, and e = 2^-53, or DoubleDouble::rounding. An exact coefficient of the volume differs from
// the computed one by at most (66 + 18 n) e m, one of a minor by (10 + 4 n) e m_k. Here m is the product of the largest
// |x|, |y| and |z| among the differences of points, and m_k of two of these. The factor 1 + 2^-10 covers terms of
// second order. Products that underflow are far below the bound in the range that in_range() admits.
#include "predicates/moving_pair.hpp"

#include <algorithm>
#include <cmath>

#include "predicates/double_double.hpp"

namespace dartcast::detail {

namespace {

template <class Real>
constexpr double rounding = 0x1p-53 * (1 + 0x1p-10);
template <>
constexpr double rounding<DoubleDouble> = DoubleDouble::rounding*(1 + 0x1p-10);
constexpr int most_halvings = 36;
constexpr int most_parts = 200;
// An interval of time that needs no further halving, and the widest one of a touch; wider ones are left to integers. Those of
// double-doubles give the very time that integers give.
template <class Real>
constexpr double narrow = 0x1p-30;
template <>
constexpr double narrow<DoubleDouble> = 0x1p-40;
template <class Real>
constexpr double widest_answer = 0x1p-20;
template <>
constexpr double widest_answer<DoubleDouble> = 0x1p-40;

template <class Real>
using CubicCoefficients = std::array<Real, 4>;
template <class Real>
using QuadraticCoefficients = std::array<Real, 3>;

double half(double x) { return 0.5 * x; }
DoubleDouble half(DoubleDouble x) {
  x.high *= 0.5;
  x.low *= 0.5;
  return x;
}

template <class Real>
int sign_beyond(const Real& x, double bound) {
  return x > Real(bound) ? 1 : x < Real(-bound) ? -1 : 0;
}

template <class Real, std::size_t N>
int common_sign(const std::array<Real, N>& b, double bound) {
  const int sign = sign_beyond(b[0], bound);
  for (std::size_t i = 1; i < N; ++i) {
    if (sign_beyond(b[i], bound) != sign) return 0;
  }
  return sign;
}

template <class Real>
void halve(const CubicCoefficients<Real>& f, CubicCoefficients<Real>& left, CubicCoefficients<Real>& right) {
  const Real a = half(f[0] + f[1]);
  const Real b = half(f[1] + f[2]);
  const Real c = half(f[2] + f[3]);
  const Real u = half(a + b);
  const Real v = half(b + c);
  const Real middle = half(u + v);
  left = {f[0], a, u, middle};
  right = {middle, v, c, f[3]};
}

template <class Real>
void halve(const QuadraticCoefficients<Real>& f, QuadraticCoefficients<Real>& left,
           QuadraticCoefficients<Real>& right) {
  const Real a = half(f[0] + f[1]);
  const Real b = half(f[1] + f[2]);
  const Real middle = half(a + b);
  left = {f[0], a, middle};
  right = {middle, b, f[2]};
}

template <class Real>
struct RealVector {
  Real x, y, z;
};
template <class Real>
RealVector<Real> operator+(const RealVector<Real>& a, const RealVector<Real>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class Real>
RealVector<Real> cross(const RealVector<Real>& a, const RealVector<Real>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class Real>
Real dot(const RealVector<Real>& a, const RealVector<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

// A difference of two points at both ends of the step.
template <class Real>
struct EndVectors {
  RealVector<Real> from, to;
};

template <class Real>
struct CrossForm {
  RealVector<Real> c0, c1, c2;  // of s^2, s t and t^2
};

template <class Real>
CrossForm<Real> cross_form(const EndVectors<Real>& a, const EndVectors<Real>& b) {
  return {cross(a.from, b.from), cross(a.from, b.to) + cross(a.to, b.from), cross(a.to, b.to)};
}

// N differences of points: 3 for a vertex and a face, to its corners; 4 for edges, from the ends of the first one.
template <class Real, std::size_t N>
using Differences = std::array<EndVectors<Real>, N>;

template <class Real, std::size_t N>
Differences<Real, N> differences(const MovingPair& q) {
  const auto less = [](const Vec3& a, const Vec3& b) {
    return RealVector<Real>{exact_difference<Real>(a.x, b.x), exact_difference<Real>(a.y, b.y),
                            exact_difference<Real>(a.z, b.z)};
  };
  const auto between = [&](std::size_t i, std::size_t j) {
    return EndVectors<Real>{less(q.from[j], q.from[i]), less(q.to[j], q.to[i])};
  };
  if constexpr (N == 3) {
    return {between(0, 1), between(0, 2), between(0, 3)};
  } else {
    return {between(0, 2), between(0, 3), between(1, 2), between(1, 3)};
  }
}

struct Extent {
  Vec3 largest;  // of the magnitudes, on each axis
  bool apart = false;
};

// The sign of a rounded difference is exact.
template <std::size_t N>
Extent extent_of(const Differences<double, N>& d) {
  Vec3 low = {d[0].from.x, d[0].from.y, d[0].from.z};
  Vec3 high = low;
  for (const auto& v : d) {
    for (const auto& p : {v.from, v.to}) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  return {{std::max(-low.x, high.x), std::max(-low.y, high.y), std::max(-low.z, high.z)},
          low.x > 0 || low.y > 0 || low.z > 0 || high.x < 0 || high.y < 0 || high.z < 0};
}

// The bounds are multiples of these.
struct Magnitudes {
  double volume = 0.0;
  std::array<double, 3> minor{};
};

bool in_range(const Vec3& largest, const Magnitudes& m) {
  return std::max({largest.x, largest.y, largest.z}) < 0x1p300 && m.volume > 0x1p-700 &&
         std::min({m.minor[0], m.minor[1], m.minor[2]}) > 0x1p-900;
}

// One part of the step.
template <class Real, std::size_t N>
struct TimePart {
  CubicCoefficients<Real> volume;
  std::array<std::array<QuadraticCoefficients<Real>, N>, 3> minors;  // [projection][minor]
  double start, end;
  int halvings;
};

enum class PartFate : std::uint8_t { apart, touching, undecided };

// Vertex and face: whether p is on no side, or on opposite sides, of two sides of the triangle.
PartFate minors_fate(const std::array<int, 3>& sign) {
  if (sign[0] != 0 && sign[0] == sign[1] && sign[1] == sign[2]) return PartFate::touching;
  const bool positive = sign[0] > 0 || sign[1] > 0 || sign[2] > 0;
  const bool negative = sign[0] < 0 || sign[1] < 0 || sign[2] < 0;
  return positive && negative ? PartFate::apart : PartFate::undecided;
}

// Edges: the sides of the second edge's line on which the ends of the first lie, and the other way round.
PartFate minors_fate(const std::array<int, 4>& sign) {
  if (sign[0] * sign[1] > 0 || sign[2] * sign[3] > 0) return PartFate::apart;
  return sign[0] * sign[1] < 0 && sign[2] * sign[3] < 0 ? PartFate::touching : PartFate::undecided;
}

template <class Real, std::size_t N>
class PairFilter {
 public:
  PairFilter(const Differences<Real, N>& d, const Magnitudes& m, const CubicCoefficients<Real>& volume) : m_(m) {
    TimePart<Real, N>& whole = stack_[0];
    whole.volume = {volume[0], volume[1] / Real(3.0), volume[2] / Real(3.0), volume[3]};
    whole.start = 0.0;
    whole.end = 1.0;
    whole.halvings = 0;
    constexpr std::size_t pairs[2][4][2] = {{{0, 1}, {1, 2}, {2, 0}, {0, 0}}, {{0, 1}, {2, 3}, {0, 2}, {1, 3}}};
    for (std::size_t i = 0; i < N; ++i) {
      const auto& [a, b] = pairs[N - 3][i];
      const CrossForm<Real> c = cross_form(d[a], d[b]);
      whole.minors[0][i] = {c.c0.x, half(c.c1.x), c.c2.x};
      whole.minors[1][i] = {c.c0.y, half(c.c1.y), c.c2.y};
      whole.minors[2][i] = {c.c0.z, half(c.c1.z), c.c2.z};
    }
  }

  FilteredTouch run(bool timed) {
    int parts = 0;
    for (std::size_t size = 1; size > 0;) {
      const TimePart<Real, N>& part = stack_[size - 1];
      ++parts;
      const PartFate fate = fate_of(part);
      if (fate == PartFate::touching) return timed ? narrowed(part) : FilteredTouch{FilterAnswer::touching, part.start};
      if (fate == PartFate::apart) {
        --size;
        continue;
      }
      if (part.halvings >= most_halvings || parts >= most_parts) return {};
      halve_last(size);
      ++size;
    }
    return {FilterAnswer::apart};
  }

 private:
  [[nodiscard]] double volume_bound(int halvings) const { return (66 + 18.0 * halvings) * rounding<Real> * m_.volume; }

  [[nodiscard]] PartFate fate_of(const TimePart<Real, N>& part) const {
    const double bound = volume_bound(part.halvings);
    if (common_sign(part.volume, bound) != 0) return PartFate::apart;
    PartFate fate = PartFate::undecided;
    for (std::size_t k = 0; k < 3 && fate == PartFate::undecided; ++k) {
      const double minor_bound = (10 + 4.0 * part.halvings) * rounding<Real> * m_.minor[k];
      std::array<int, N> signs;
      for (std::size_t i = 0; i < N; ++i) signs[i] = common_sign(part.minors[k][i], minor_bound);
      fate = minors_fate(signs);
    }
    if (fate != PartFate::touching) return fate;
    const bool crosses = sign_beyond(part.volume[0], bound) * sign_beyond(part.volume[3], bound) < 0;
    return crosses ? PartFate::touching : PartFate::undecided;
  }

  // Replaces the last part by its halves, the earlier one on top.
  void halve_last(std::size_t size) {
    TimePart<Real, N>& right = stack_[size - 1];
    TimePart<Real, N>& left = stack_[size];
    const CubicCoefficients<Real> volume = right.volume;
    halve(volume, left.volume, right.volume);
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < N; ++i) {
        const QuadraticCoefficients<Real> minor = right.minors[k][i];
        halve(minor, left.minors[k][i], right.minors[k][i]);
      }
    }
    left.start = right.start;
    left.end = right.start = 0.5 * (right.start + right.end);
    left.halvings = ++right.halvings;
  }

  // Any root in the part is a touch: the volume alone decides where the first one is. It is not before `start`, and a
  // root is before `crossed`, if the volume has proved the other sign.
  [[nodiscard]] FilteredTouch narrowed(const TimePart<Real, N>& part) const {
    CubicCoefficients<Real> volume = part.volume;
    double start = part.start;
    double end = part.end;
    double crossed = part.end;
    const int other_sign = volume[3] > Real(0.0) ? 1 : -1;
    for (int halvings = part.halvings + 1; end - start > narrow<Real>; ++halvings) {
      CubicCoefficients<Real> left;
      CubicCoefficients<Real> right;
      halve(volume, left, right);
      const double bound = volume_bound(halvings);
      const double middle = 0.5 * (start + end);
      if (sign_beyond(left[3], bound) == other_sign) crossed = middle;
      const bool free = common_sign(left, bound) == -other_sign;
      volume = free ? right : left;
      (free ? start : end) = middle;
    }
    if (crossed - start > widest_answer<Real>) return {};
    return {FilterAnswer::touching, start};
  }

  Magnitudes m_;
  std::array<TimePart<Real, N>, most_halvings + 2> stack_;
};

// The coefficients of the volume before they are divided by the binomials.
template <class Real, std::size_t N>
CubicCoefficients<Real> volume_of(const Differences<Real, N>& d) {
  const EndVectors<Real>& u = d[N == 3 ? 0 : 2];
  const CrossForm<Real> n = cross_form(d[N == 3 ? 1 : 0], d[N == 3 ? 2 : 1]);
  return {dot(u.from, n.c0), dot(u.to, n.c0) + dot(u.from, n.c1), dot(u.from, n.c2) + dot(u.to, n.c1), dot(u.to, n.c2)};
}

template <class Real, std::size_t N>
FilteredTouch filter(const MovingPair& pair, bool timed = true) {
  const Differences<double, N> rounded = differences<double, N>(pair);
  const Extent extent = extent_of(rounded);
  if (extent.apart) return {FilterAnswer::apart};
  const Vec3& l = extent.largest;
  const Magnitudes m{l.x * l.y * l.z, {l.y * l.z, l.z * l.x, l.x * l.y}};
  if (!in_range(l, m)) return {};

  const Differences<Real, N> d = differences<Real, N>(pair);
  const CubicCoefficients<Real> c = volume_of<Real, N>(d);
  // Up to three times as large as those that are divided, and so are their errors.
  if (common_sign(c, 180 * rounding<Real> * m.volume) != 0) return {FilterAnswer::apart};
  return PairFilter<Real, N>(d, m, c).run(timed);
}

}  // namespace

FilteredTouch filtered_touch(const MovingPair& pair, PairKind kind) {
  return kind == PairKind::vertex_face ? filter<double, 3>(pair) : filter<double, 4>(pair);
}

FilteredTouch finely_filtered_touch(const MovingPair& pair, PairKind kind) {
  return kind == PairKind::vertex_face ? filter<DoubleDouble, 3>(pair) : filter<DoubleDouble, 4>(pair);
}

std::optional<double> first_touch(const MovingPair& pair, PairKind kind) {
  for (const auto filter : {filtered_touch, finely_filtered_touch}) {
    const FilteredTouch filtered = filter(pair, kind);
    if (filtered.answer == FilterAnswer::apart) return std::nullopt;
    if (filtered.answer == FilterAnswer::touching) return filtered.time;
  }
  return exact_touch(pair, kind);
}

bool touches(const MovingPair& pair, PairKind kind) {
  const bool face = kind == PairKind::vertex_face;
  FilterAnswer answer = (face ? filter<double, 3>(pair, false) : filter<double, 4>(pair, false)).answer;
  if (answer == FilterAnswer::undecided)
    answer = (face ? filter<DoubleDouble, 3>(pair, false) : filter<DoubleDouble, 4>(pair, false)).answer;
  return answer == FilterAnswer::undecided ? exact_touch(pair, kind).has_value() : answer == FilterAnswer::touching;
}

}  // namespace dartcast::detail
