#include "support/element_checks.hpp"

#include <algorithm>
#include <cmath>

#include "dartcast/predicates.hpp"
#include "predicates/moving_pair.hpp"

namespace dartcast::test {

std::vector<std::array<unsigned, 2>> sides_of(unsigned corners) {
  if (corners < 3)
    return corners == 2 ? std::vector<std::array<unsigned, 2>>{{0, 1}} : std::vector<std::array<unsigned, 2>>{};
  return {{0, 1}, {1, 2}, {2, 0}};
}

std::optional<double> first_touch_of(const MovingElement& e, const MovingTriangle& w) {
  using detail::MovingPair;
  using detail::PairKind;
  std::optional<double> first;
  const auto ask = [&](const MovingPair& pair, PairKind kind) {
    const auto time = detail::first_touch(pair, kind);
    if (time && (!first || *time < *first)) first = time;
  };
  for (unsigned i = 0; i < e.count; ++i)
    ask({{e.from[i], w.from[0], w.from[1], w.from[2]}, {e.to[i], w.to[0], w.to[1], w.to[2]}}, PairKind::vertex_face);
  for (const auto& [i, j] : sides_of(e.count)) {
    for (unsigned k = 0; k < 3; ++k) {
      const unsigned l = (k + 1) % 3;
      ask({{e.from[i], e.from[j], w.from[k], w.from[l]}, {e.to[i], e.to[j], w.to[k], w.to[l]}}, PairKind::edge_edge);
    }
  }
  for (unsigned k = 0; k < 3 && e.count == 3; ++k)
    ask({{w.from[k], e.from[0], e.from[1], e.from[2]}, {w.to[k], e.to[0], e.to[1], e.to[2]}}, PairKind::vertex_face);
  return first;
}

bool boxes_meet(const MovingElement& e, const MovingTriangle& w) {
  const auto apart = [&](double Vec3::*axis) {
    double low = e.from[0].*axis;
    double high = low;
    for (unsigned i = 0; i < e.count; ++i) {
      low = std::min({low, e.from[i].*axis, e.to[i].*axis});
      high = std::max({high, e.from[i].*axis, e.to[i].*axis});
    }
    double low_wall = w.from[0].*axis;
    double high_wall = low_wall;
    for (unsigned i = 0; i < 3; ++i) {
      low_wall = std::min({low_wall, w.from[i].*axis, w.to[i].*axis});
      high_wall = std::max({high_wall, w.from[i].*axis, w.to[i].*axis});
    }
    return high < low_wall || high_wall < low;
  };
  return !apart(&Vec3::x) && !apart(&Vec3::y) && !apart(&Vec3::z);
}

std::optional<double> first_touch_of(const MovingElement& e, std::span<const MovingTriangle> walls) {
  std::optional<double> first;
  for (const MovingTriangle& w : walls) {
    const auto time = boxes_meet(e, w) ? first_touch_of(e, w) : std::nullopt;
    if (time && (!first || *time < *first)) first = time;
  }
  return first;
}

bool passes(const Vec3& a, const Vec3& b, const std::array<Vec3, 3>& v) {
  const auto opposite = [](Sign s, Sign t) { return static_cast<int>(s) * static_cast<int>(t) < 0; };
  if (!opposite(orient3d(v[0], v[1], v[2], a), orient3d(v[0], v[1], v[2], b))) return false;
  const Sign first = orient3d(a, b, v[0], v[1]);
  return first != Sign::zero && first == orient3d(a, b, v[1], v[2]) && first == orient3d(a, b, v[2], v[0]);
}

bool meets_at_start(MovingElement e, std::span<const MovingTriangle> walls) {
  e.to = e.from;
  for (MovingTriangle w : walls) {
    w.to = w.from;
    if (!boxes_meet(e, w)) continue;
    if (first_touch_of(e, w)) return true;
    for (const auto& [i, j] : sides_of(e.count)) {
      if (passes(e.from[i], e.from[j], w.from)) return true;
    }
    for (unsigned k = 0; k < 3 && e.count == 3; ++k) {
      if (passes(w.from[k], w.from[(k + 1) % 3], e.from)) return true;
    }
  }
  return false;
}

MovingElement element_at(Random& random, const Vec3& at, unsigned count, double size) {
  MovingElement e;
  e.count = count;
  for (unsigned i = 0; i < count; ++i) {
    Vec3 way = random_vector(random);
    way = norm(way) > 0.0 ? way * (size / norm(way)) : Vec3{size, 0.0, 0.0};
    e.from[i] = i == 0 ? at : at + way;
    e.to[i] = e.from[i];
  }
  return e;
}

std::vector<Vec3> waved(std::span<const Vec3> positions, double by, double unit) {
  std::vector<Vec3> moved(positions.begin(), positions.end());
  for (Vec3& p : moved) {
    const Vec3 x = p * (1.0 / unit);
    p += Vec3{by * std::sin(0.8 * x.y + 0.3), by * std::sin(0.7 * x.z + 1.1), by * std::sin(0.9 * x.x - 0.4)};
  }
  return moved;
}

}  // namespace dartcast::test
