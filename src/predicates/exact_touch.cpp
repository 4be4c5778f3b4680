// The exact part of first_touch(): candidates for the time of the first touch, and a closed test of each by signs alone.
//
// Phases: coordinates become integers; the volume of the four points is a cubic, and a touch is at a root of it. If it
// is 0 throughout, all points stay in one plane, and the candidates are the roots of everything that the test asks for.
// The times of contact are a closed set that signs of these forms describe, so its first time is one of the candidates.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "predicates/exact_form.hpp"
#include "predicates/moving_pair.hpp"

namespace dartcast::detail {

namespace {

// Points in integers: [point][axis], each a form of degree 1. Each axis is scaled by a power of two. This changes no sign.
using ExactPoints = std::array<std::array<ExactForm, 3>, 4>;
using PointIndex = std::size_t;

struct ScaledDouble {
  std::int64_t mantissa = 0;
  int exponent = 0;
};

ScaledDouble scaled(double x) {
  if (x == 0.0) return {};
  int exponent = 0;
  const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &exponent), 53));
  const int zeros = std::countr_zero(static_cast<std::uint64_t>(mantissa));
  return {mantissa >> zeros, exponent + zeros};
}

double coordinate(const Vec3& p, std::size_t axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

void set_axis(ExactPoints& points, const MovingPair& pair, std::size_t axis) {
  std::array<std::array<ScaledDouble, 2>, 4> values;
  int lowest = std::numeric_limits<int>::max();
  for (PointIndex i = 0; i < 4; ++i) {
    values[i] = {scaled(coordinate(pair.from[i], axis)), scaled(coordinate(pair.to[i], axis))};
    for (const ScaledDouble& v : values[i]) {
      if (v.mantissa != 0) lowest = std::min(lowest, v.exponent);
    }
  }
  const auto integer = [lowest](const ScaledDouble& v) {
    return v.mantissa == 0 ? ExactInteger(0) : ExactInteger(v.mantissa) << static_cast<unsigned>(v.exponent - lowest);
  };
  for (PointIndex i = 0; i < 4; ++i) points[i][axis] = {1, {integer(values[i][0]), integer(values[i][1]), 0, 0}};
}

class ExactPair {
 public:
  ExactPair(const MovingPair& pair, PairKind kind) : kind_(kind) {
    for (std::size_t axis = 0; axis < 3; ++axis) set_axis(points_, pair, axis);
  }

  [[nodiscard]] ExactForm volume() const {
    ExactForm sum;
    sum.degree = 3;
    for (std::size_t k = 0; k < 3; ++k) sum = sum + orient(1, 2, 3, k) * difference(0, 1, k);
    return sum;
  }

  /// Whether the elements touch at a time at which the four points lie in one plane.
  [[nodiscard]] bool touch_at(ExactTime& time) const {
    return kind_ == PairKind::vertex_face ? vertex_meets_face(time) : edges_meet(time);
  }

  /// All that touch_at() asks the sign of.
  [[nodiscard]] std::vector<ExactForm> asked() const {
    std::vector<ExactForm> forms;
    constexpr std::array<std::array<PointIndex, 3>, 4> triples{{{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}}};
    for (std::size_t k = 0; k < 3; ++k) {
      for (const auto& t : triples) forms.push_back(orient(t[0], t[1], t[2], k));
      if (kind_ == PairKind::edge_edge) forms.push_back(directions(k));
      for (PointIndex i = 0; i < 4; ++i) {
        for (PointIndex j = 0; j < i; ++j) forms.push_back(difference(i, j, k));
      }
    }
    std::erase_if(forms, [](const ExactForm& f) { return f.is_zero(); });
    return forms;
  }

 private:
  [[nodiscard]] ExactForm difference(PointIndex i, PointIndex j, std::size_t k) const {
    return points_[i][k] - points_[j][k];
  }

  // (j - i) x (n - m), its component along axis k.
  [[nodiscard]] ExactForm product(PointIndex i, PointIndex j, PointIndex m, PointIndex n, std::size_t k) const {
    const std::size_t x = (k + 1) % 3;
    const std::size_t y = (k + 2) % 3;
    return difference(j, i, x) * difference(n, m, y) - difference(j, i, y) * difference(n, m, x);
  }
  [[nodiscard]] ExactForm orient(PointIndex i, PointIndex j, PointIndex l, std::size_t k) const {
    return product(i, j, i, l, k);
  }
  [[nodiscard]] ExactForm directions(std::size_t k) const { return product(0, 1, 2, 3, k); }

  // Whether point i lies on the closed segment from j to l.
  [[nodiscard]] bool on_segment(PointIndex i, PointIndex j, PointIndex l, ExactTime& time) const {
    for (std::size_t k = 0; k < 3; ++k) {
      if (time.sign_of(orient(j, l, i, k)) != 0) return false;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      if (time.sign_of(difference(i, j, k)) * time.sign_of(difference(i, l, k)) > 0) return false;
    }
    return true;
  }

  [[nodiscard]] bool vertex_meets_face(ExactTime& time) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const int face = time.sign_of(orient(1, 2, 3, k));
      if (face == 0) continue;
      return time.sign_of(orient(0, 1, 2, k)) * face >= 0 && time.sign_of(orient(0, 2, 3, k)) * face >= 0 &&
             time.sign_of(orient(0, 3, 1, k)) * face >= 0;
    }
    return on_segment(0, 1, 2, time) || on_segment(0, 2, 3, time) || on_segment(0, 3, 1, time);
  }

  [[nodiscard]] bool edges_meet(ExactTime& time) const {
    for (std::size_t k = 0; k < 3; ++k) {
      if (time.sign_of(directions(k)) == 0) continue;
      return time.sign_of(orient(2, 3, 0, k)) * time.sign_of(orient(2, 3, 1, k)) <= 0 &&
             time.sign_of(orient(0, 1, 2, k)) * time.sign_of(orient(0, 1, 3, k)) <= 0;
    }
    return on_segment(0, 2, 3, time) || on_segment(1, 2, 3, time) || on_segment(2, 0, 1, time) ||
           on_segment(3, 0, 1, time);
  }

  PairKind kind_;
  ExactPoints points_;
};

}  // namespace

std::optional<double> exact_touch(const MovingPair& pair, PairKind kind) {
  const ExactPair exact(pair, kind);
  const ExactForm volume = exact.volume();
  const bool coplanar = volume.is_zero();

  ExactTime start = ExactTime::start();
  if (volume.c[0] == 0 && exact.touch_at(start)) return 0.0;
  std::optional<double> first;
  for (const ExactForm& form : coplanar ? exact.asked() : std::vector<ExactForm>{volume}) {
    for (ExactTime& time : roots_inside(form)) {
      if (!exact.touch_at(time)) continue;
      first = std::min(first.value_or(1.0), time.rounded_down());
      break;
    }
  }
  if (first) return first;
  ExactTime end = ExactTime::end();
  if (volume.c[3] == 0 && exact.touch_at(end)) return 1.0;
  return std::nullopt;
}

}  // namespace dartcast::detail
