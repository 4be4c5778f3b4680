// The first touch of a moving sphere and triangle: intervals are proved clear, or divided.
#include "dynamics/swept_sphere.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "dynamics/triangle_gap.hpp"

namespace dartcast {

namespace {

using detail::DoubleDouble;
using detail::NearestTo;
using detail::TriangleOf;
using detail::Vector;

constexpr double finest = 0x1p-40;     // intervals are not divided further
constexpr double time_grid = 0x1p-45;  // times are multiples of this: 1 - t is exact
constexpr unsigned max_divisions = 4096;
constexpr std::size_t max_open = 64;  // intervals that wait

// The error of each computed number is at most this share of M, the largest length. A difference to the centre is off
// by e = 2^-53 of itself. A corner at a time t is off by 4 e M along each axis. So it is off by 7 e M in a product with
// a unit vector. The product's own rounding adds 3 e M, the mean of two e M, the vector's length 4 e r. The sum is less
// than 16 e M for a coefficient. A distance: 7 e M from the corners, 9 e M from their weights and the sum, 3 e M from
// its length. (In double-double, the same with DoubleDouble::rounding.) The rest covers M's own rounding, and
// coordinates that scaling takes below the smallest double.
template <class Real>
constexpr double rounding_share = 32.0 * 0x1p-53;
template <>
constexpr double rounding_share<DoubleDouble> = 32.0 * DoubleDouble::rounding;

// Scaled by a power of two, so that no product leaves the range: M is in [1, 4).
struct Scaled {
  MovingSphere sphere;
  MovingTriangle triangle;
  double slack;
  double largest;  // M
};

double largest_coordinate(const MovingSphere& s, const MovingTriangle& t) {
  double largest = s.radius;
  const auto include = [&](const Vec3& a, const Vec3& b) {
    largest = std::max({largest, std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
  };
  for (unsigned i = 0; i < 3; ++i) {
    include(t.from[i], s.from);
    include(t.to[i], s.to);
  }
  return largest;
}

Scaled scaled_to_one(MovingSphere s, MovingTriangle t, double slack) {
  const double largest = largest_coordinate(s, t);
  int exponent = 0;
  std::frexp(largest, &exponent);
  const double factor = std::ldexp(1.0, std::clamp(1 - exponent, -1000, 1000));
  s = {s.from * factor, s.to * factor, s.radius * factor};
  for (unsigned i = 0; i < 3; ++i) {
    t.from[i] *= factor;
    t.to[i] *= factor;
  }
  double square = s.radius * s.radius;
  for (unsigned i = 0; i < 3; ++i) {
    const Vec3 before = t.from[i] - s.from;
    const Vec3 after = t.to[i] - s.to;
    square = std::max({square, dot(before, before), dot(after, after)});
  }
  return {s, t, slack * factor, std::sqrt(square)};
}

template <class Real>
Vector<Real> seen_from(const Vec3& centre, const Vec3& x) {
  using detail::exact_difference;
  return {exact_difference<Real>(x.x, centre.x), exact_difference<Real>(x.y, centre.y),
          exact_difference<Real>(x.z, centre.z)};
}

// How a search ended.
struct TouchCandidate {
  enum class End : std::uint8_t { apart, touch, open } end = End::apart;
  double time = 0.0;   // the distance is proved to be above the level until then
  double until = 0.0;  // touch: it is proved to be below, or at, the level then
  double contact = 0.0;
};

template <class Real>
class TouchSearch {
 public:
  TouchSearch(const MovingSphere& s, const MovingTriangle& t, double largest) : error_(rounding_share<Real> * largest) {
    for (unsigned i = 0; i < 3; ++i) {
      from_[i] = seen_from<Real>(s.from, t.from[i]);
      to_[i] = seen_from<Real>(s.to, t.to[i]);
    }
  }

  struct Instant {
    double time = 0.0;
    TriangleOf<Real> corners;
    NearestTo<Real> nearest;
  };

  [[nodiscard]] Instant at(double t) const { return instant(t, corners_at(t)); }
  [[nodiscard]] double error() const { return error_; }

  // The first time in [first, last] at which the distance is not proved to be above `level`.
  [[nodiscard]] TouchCandidate run(Instant first, double last, const Real& level, double resolution) const {
    const TriangleOf<Real> end = corners_at(last);
    if (all_beyond(first.nearest.direction, first.corners, level) && all_beyond(first.nearest.direction, end, level))
      return {TouchCandidate::End::apart, last, last, last};
    std::array<Instant, max_open> open;  // the ends of intervals, the first one last
    std::size_t count = 0;
    open[count++] = instant(last, end);
    bool guided = false;
    for (unsigned divisions = 0; divisions < max_divisions && count < max_open; ++divisions) {
      while (stay_apart(first, open[count - 1], level)) {
        first = open[--count];
        if (count == 0) return {TouchCandidate::End::apart, last, last, last};
      }
      const Instant& next = open[count - 1];
      const double width = next.time - first.time;
      const bool inside = next.nearest.distance + Real(error_) <= level;
      if (inside && width <= sphere_time_bound / 2) return touch(first, next, level);
      if (is_settled(first, next, level, width, resolution))
        return {TouchCandidate::End::open, first.time, next.time, first.time};
      guided = (inside || count == 1) && !guided;
      open[count] = at(guided ? guess(first, next, level) : middle(first, next));
      ++count;
    }
    return {TouchCandidate::End::open, first.time, open[count - 1].time, first.time};
  }

 private:
  [[nodiscard]] TriangleOf<Real> corners_at(double t) const {
    if (t == 0.0) return from_;
    if (t == 1.0) return to_;
    TriangleOf<Real> corners;
    for (unsigned i = 0; i < 3; ++i) corners[i] = from_[i] * Real(1.0 - t) + to_[i] * Real(t);
    return corners;
  }
  [[nodiscard]] Instant instant(double t, const TriangleOf<Real>& corners) const {
    return {t, corners, detail::nearest_to_origin(corners)};
  }

  // Whether all corners are proved to be beyond the level along a direction.
  [[nodiscard]] bool all_beyond(const Vector<Real>& n, const TriangleOf<Real>& d, const Real& level) const {
    const Real bound = level + Real(error_);
    return dot(n, d[0]) > bound && dot(n, d[1]) > bound && dot(n, d[2]) > bound;
  }

  // Whether an interval without a proof stays undivided: in doubles if it is short, with twice the digits if it
  // grazes.
  [[nodiscard]] bool is_settled(const Instant& a, const Instant& b, const Real& level, double width,
                                double resolution) const {
    if (width > resolution) return false;
    const Real grazing = level + Real(error_) + Real(grazing_bound / 8.0 * (error_ / rounding_share<Real>));
    return std::is_same_v<Real, double> || width <= time_grid || a.nearest.distance <= grazing ||
           b.nearest.distance <= grazing;
  }

  // The proof of the header: Bernstein's coefficients for each corner.
  [[nodiscard]] bool stay_apart(const Instant& a, const Instant& b, const Real& level) const {
    const Vector<Real>& m = a.nearest.direction;
    const Vector<Real>& n = b.nearest.direction;
    const Real bound = level + Real(error_);
    for (unsigned i = 0; i < 3; ++i) {
      if (!(dot(m, a.corners[i]) > bound) || !(dot(n, b.corners[i]) > bound) ||
          !((dot(m, b.corners[i]) + dot(n, a.corners[i])) * Real(0.5) > bound))
        return false;
    }
    return true;
  }

  // The growth of the distance over the whole motion, at the rate of this instant.
  [[nodiscard]] double rate(const Instant& x) const {
    double sum = 0.0;
    for (unsigned i = 0; i < 3; ++i)
      sum += double(x.nearest.weights[i]) * double(dot(x.nearest.direction, to_[i] - from_[i]));
    return sum;
  }

  [[nodiscard]] static double on_grid(double t) { return std::floor(t / time_grid) * time_grid; }
  [[nodiscard]] static double middle(const Instant& a, const Instant& b) { return on_grid(0.5 * (a.time + b.time)); }

  // The time to divide at: just before the distance reaches the level at its current rate; near the level, just
  // after.
  [[nodiscard]] double guess(const Instant& a, const Instant& b, const Real& level) const {
    constexpr double step = sphere_time_bound / 16;
    const double fall = -rate(a);
    const double gap = double(a.nearest.distance - level);
    if (!(fall > 0.0) || !(gap < fall * (b.time - a.time))) return middle(a, b);
    const double way = std::max(gap / fall, 0.0);
    const double t = on_grid(a.time + (way > 2.0 * step ? way - step : way + 4.0 * step));
    return t > a.time && t < b.time ? t : middle(a, b);
  }

  // Between the two the distance changes almost linearly.
  [[nodiscard]] static TouchCandidate touch(const Instant& a, const Instant& b, const Real& level) {
    const double before = double(a.nearest.distance - level);
    const double after = double(b.nearest.distance - level);
    const double share = before > after ? std::clamp(before / (before - after), 0.0, 1.0) : 0.0;
    return {TouchCandidate::End::touch, a.time, b.time, a.time + share * (b.time - a.time)};
  }

  TriangleOf<Real> from_;
  TriangleOf<Real> to_;
  double error_;
};

// Searches from `begin` in doubles, and in double-double from the time at which doubles prove no more.
template <class Real>
TouchCandidate first_at_level(const Scaled& s, const TouchSearch<Real>& search,
                              const typename TouchSearch<Real>::Instant& begin, double until, const Real& level) {
  if constexpr (std::is_same_v<Real, DoubleDouble>) {
    return search.run(begin, until, level, finest);
  } else {
    const TouchCandidate found = search.run(begin, until, level, sphere_time_bound / 2);
    if (found.end != TouchCandidate::End::open) return found;
    const TouchSearch<DoubleDouble> fine(s.sphere, s.triangle, s.largest);
    return fine.run(fine.at(found.time), until, DoubleDouble(level), finest);
  }
}

std::optional<SphereTouch> touch_of(const TouchCandidate& found) {
  if (found.end == TouchCandidate::End::apart) return {};
  return SphereTouch{found.time, found.contact, false};
}

template <class Real>
std::optional<SphereTouch> touch_from(const Scaled& s, const TouchSearch<Real>& search,
                                      const typename TouchSearch<Real>::Instant& start, double slack, double until) {
  const Real radius(s.sphere.radius);
  const Real touching = radius + Real(slack);
  if (start.nearest.distance > touching) {
    if (s.slack > 0.0) {  // grazing is the usual case: a sphere on a floor, and the floor's next triangle
      const TouchCandidate deep = first_at_level(s, search, start, until, radius - Real(s.slack));
      if (deep.end == TouchCandidate::End::apart) return {};
      if (deep.end == TouchCandidate::End::touch) until = deep.until;
    }
    return touch_of(first_at_level(s, search, start, until, radius));
  }
  const Real level = start.nearest.distance - Real(slack);
  if (!(level > Real(0.0))) return {};
  const TouchCandidate nearer = first_at_level(s, search, start, until, level);
  if (nearer.end == TouchCandidate::End::apart) return {};
  const auto halfway = search.at(std::floor(0.5 * nearer.time / time_grid) * time_grid);
  if (nearer.time > sphere_time_bound && halfway.nearest.distance > touching)
    return touch_of(first_at_level(s, search, halfway, until, radius));
  return SphereTouch{0.0, 0.0, true};
}

}  // namespace

NearestOnTriangle nearest_on_triangle(const std::array<Vec3, 3>& corners, const Vec3& centre) {
  const MovingSphere sphere{centre, centre, 0.0};
  const double largest = largest_coordinate(sphere, {corners, corners});
  int exponent = 0;
  std::frexp(largest, &exponent);
  const double factor = std::ldexp(1.0, std::clamp(-exponent, -1000, 1000));
  TriangleOf<double> d;
  for (unsigned i = 0; i < 3; ++i) d[i] = seen_from<double>(centre, corners[i]) * factor;
  const NearestTo<double> nearest = detail::nearest_to_origin(d);
  const Vec3 normal = {-nearest.direction.x, -nearest.direction.y, -nearest.direction.z};
  const double distance = nearest.distance / factor;
  return {centre - normal * distance, normal, distance, nearest.weights, nearest.corners};
}

std::optional<SphereTouch> first_touch(const MovingSphere& sphere, const MovingTriangle& triangle, double slack,
                                       double until) {
  const Scaled s = scaled_to_one(sphere, triangle, slack);
  until = std::min(std::ceil(until / time_grid) * time_grid, 1.0);
  const TouchSearch<double> search(s.sphere, s.triangle, s.largest);
  const auto start = search.at(0.0);
  const double held = 2.0 * search.error();
  if (s.slack >= held || start.nearest.distance > s.sphere.radius + held)
    return touch_from(s, search, start, s.slack, until);
  const TouchSearch<DoubleDouble> fine(s.sphere, s.triangle, s.largest);
  return touch_from(s, fine, fine.at(0.0), std::max(s.slack, 2.0 * fine.error()), until);
}

}  // namespace dartcast
