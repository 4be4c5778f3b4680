// The filter of moving pairs, in doubles with proved bounds.
//
// Phases: an axis that separates; the cubic of the volume, if it has one sign; else [0, 1] is halved, the earlier part
// first. Forms are kept as Bernstein's coefficients. A part is
// - free, if the volume has one sign; or if in some projection two minors of a vertex and a face have opposite signs
//   throughout, or both ends of an edge lie on one side of the other edge. Both hold for flat triangles and parallel
//   edges, too;
// - a touch, if the volume has proved and opposite signs at its ends, and in some projection all points that are coplanar
//   would touch. Then the volume alone is halved further, to find the time.
//
// Bounds, with e = 2^-53 and n halvings: an exact coefficient of the volume differs from the computed one by at most
// (66 + 18 n) e m, one of a minor by (10 + 4 n) e m_k. Here m is the product of the largest |x|, |y| and |z| among the
// differences of points, and m_k of two of these. The factor 1 + 2^-10 covers terms of second order. Products that
// underflow are far below the bound in the range that in_range() admits.
#include "predicates/moving_pair.hpp"

#include <algorithm>
#include <cmath>

namespace dartcast::detail {

namespace {

constexpr double rounding = 0x1p-53 * (1 + 0x1p-10);
constexpr int most_halvings = 36;
constexpr int most_parts = 200;
constexpr double narrow = 0x1p-30;         // an interval of time that needs no further halving
constexpr double widest_answer = 0x1p-20;  // of a touch; wider ones are left to integers

using CubicCoefficients = std::array<double, 4>;
using QuadraticCoefficients = std::array<double, 3>;

int sign_beyond(double x, double bound) { return x > bound ? 1 : x < -bound ? -1 : 0; }

template <std::size_t N>
int common_sign(const std::array<double, N>& b, double bound) {
  const int sign = sign_beyond(b[0], bound);
  for (std::size_t i = 1; i < N; ++i) {
    if (sign_beyond(b[i], bound) != sign) return 0;
  }
  return sign;
}

void halve(const CubicCoefficients& f, CubicCoefficients& left, CubicCoefficients& right) {
  const double a = 0.5 * (f[0] + f[1]);
  const double b = 0.5 * (f[1] + f[2]);
  const double c = 0.5 * (f[2] + f[3]);
  const double u = 0.5 * (a + b);
  const double v = 0.5 * (b + c);
  const double middle = 0.5 * (u + v);
  left = {f[0], a, u, middle};
  right = {middle, v, c, f[3]};
}

void halve(const QuadraticCoefficients& f, QuadraticCoefficients& left, QuadraticCoefficients& right) {
  const double a = 0.5 * (f[0] + f[1]);
  const double b = 0.5 * (f[1] + f[2]);
  const double middle = 0.5 * (a + b);
  left = {f[0], a, middle};
  right = {middle, b, f[2]};
}

// A difference of two points at both ends of the step.
struct EndVectors {
  Vec3 from, to;
};

struct CrossForm {
  Vec3 c0, c1, c2;  // of s^2, s t and t^2
};

CrossForm cross_form(const EndVectors& a, const EndVectors& b) {
  return {cross(a.from, b.from), cross(a.from, b.to) + cross(a.to, b.from), cross(a.to, b.to)};
}

// N differences of points: 3 for a vertex and a face, to its corners; 4 for edges, from the ends of the first one.
template <std::size_t N>
using Differences = std::array<EndVectors, N>;

template <std::size_t N>
Differences<N> differences(const MovingPair& q) {
  const auto between = [&q](std::size_t i, std::size_t j) {
    return EndVectors{q.from[j] - q.from[i], q.to[j] - q.to[i]};
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
Extent extent_of(const Differences<N>& d) {
  Vec3 low = d[0].from;
  Vec3 high = low;
  for (const EndVectors& v : d) {
    for (const Vec3& p : {v.from, v.to}) {
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
template <std::size_t N>
struct TimePart {
  CubicCoefficients volume;
  std::array<std::array<QuadraticCoefficients, N>, 3> minors;  // [projection][minor]
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

template <std::size_t N>
class PairFilter {
 public:
  PairFilter(const Differences<N>& d, const Magnitudes& m, const CubicCoefficients& volume) : m_(m) {
    TimePart<N>& whole = stack_[0];
    whole.volume = {volume[0], volume[1] / 3, volume[2] / 3, volume[3]};
    whole.start = 0.0;
    whole.end = 1.0;
    whole.halvings = 0;
    constexpr std::size_t pairs[2][4][2] = {{{0, 1}, {1, 2}, {2, 0}, {0, 0}}, {{0, 1}, {2, 3}, {0, 2}, {1, 3}}};
    for (std::size_t i = 0; i < N; ++i) {
      const auto& [a, b] = pairs[N - 3][i];
      const CrossForm c = cross_form(d[a], d[b]);
      whole.minors[0][i] = {c.c0.x, 0.5 * c.c1.x, c.c2.x};
      whole.minors[1][i] = {c.c0.y, 0.5 * c.c1.y, c.c2.y};
      whole.minors[2][i] = {c.c0.z, 0.5 * c.c1.z, c.c2.z};
    }
  }

  FilteredTouch run() {
    int parts = 0;
    for (std::size_t size = 1; size > 0;) {
      const TimePart<N>& part = stack_[size - 1];
      ++parts;
      const PartFate fate = fate_of(part);
      if (fate == PartFate::touching) return narrowed(part);
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
  [[nodiscard]] double volume_bound(int halvings) const { return (66 + 18.0 * halvings) * rounding * m_.volume; }

  [[nodiscard]] PartFate fate_of(const TimePart<N>& part) const {
    const double bound = volume_bound(part.halvings);
    if (common_sign(part.volume, bound) != 0) return PartFate::apart;
    PartFate fate = PartFate::undecided;
    for (std::size_t k = 0; k < 3 && fate == PartFate::undecided; ++k) {
      const double minor_bound = (10 + 4.0 * part.halvings) * rounding * m_.minor[k];
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
    TimePart<N>& right = stack_[size - 1];
    TimePart<N>& left = stack_[size];
    const CubicCoefficients volume = right.volume;
    halve(volume, left.volume, right.volume);
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < N; ++i) {
        const QuadraticCoefficients minor = right.minors[k][i];
        halve(minor, left.minors[k][i], right.minors[k][i]);
      }
    }
    left.start = right.start;
    left.end = right.start = 0.5 * (right.start + right.end);
    left.halvings = ++right.halvings;
  }

  // Any root in the part is a touch: the volume alone decides where the first one is. It is not before `start`, and a
  // root is before `crossed`, if the volume has proved the other sign.
  [[nodiscard]] FilteredTouch narrowed(const TimePart<N>& part) const {
    CubicCoefficients volume = part.volume;
    double start = part.start;
    double end = part.end;
    double crossed = part.end;
    const int other_sign = volume[3] > 0 ? 1 : -1;
    for (int halvings = part.halvings + 1; end - start > narrow; ++halvings) {
      CubicCoefficients left;
      CubicCoefficients right;
      halve(volume, left, right);
      const double bound = volume_bound(halvings);
      const double middle = 0.5 * (start + end);
      if (sign_beyond(left[3], bound) == other_sign) crossed = middle;
      const bool free = common_sign(left, bound) == -other_sign;
      volume = free ? right : left;
      (free ? start : end) = middle;
    }
    if (crossed - start > widest_answer) return {};
    return {FilterAnswer::touching, start};
  }

  Magnitudes m_;
  std::array<TimePart<N>, most_halvings + 2> stack_;
};

template <std::size_t N>
FilteredTouch filter(const MovingPair& pair) {
  const Differences<N> d = differences<N>(pair);
  const Extent extent = extent_of(d);
  if (extent.apart) return {FilterAnswer::apart};
  const Vec3& l = extent.largest;
  const Magnitudes m{l.x * l.y * l.z, {l.y * l.z, l.z * l.x, l.x * l.y}};
  if (!in_range(l, m)) return {};

  const EndVectors& u = d[N == 3 ? 0 : 2];
  const CrossForm n = cross_form(d[N == 3 ? 1 : 0], d[N == 3 ? 2 : 1]);
  const CubicCoefficients c{dot(u.from, n.c0), dot(u.to, n.c0) + dot(u.from, n.c1), dot(u.from, n.c2) + dot(u.to, n.c1),
                            dot(u.to, n.c2)};
  // The coefficients before they are divided by the binomials: up to three times as large, and so are their errors.
  if (common_sign(c, 180 * rounding * m.volume) != 0) return {FilterAnswer::apart};
  return PairFilter<N>(d, m, c).run();
}

}  // namespace

FilteredTouch filtered_touch(const MovingPair& pair, PairKind kind) {
  return kind == PairKind::vertex_face ? filter<3>(pair) : filter<4>(pair);
}

std::optional<double> first_touch(const MovingPair& pair, PairKind kind) {
  const FilteredTouch filtered = filtered_touch(pair, kind);
  switch (filtered.answer) {
    case FilterAnswer::apart: return std::nullopt;
    case FilterAnswer::touching: return filtered.time;
    case FilterAnswer::undecided: break;
  }
  return exact_touch(pair, kind);
}

}  // namespace dartcast::detail
