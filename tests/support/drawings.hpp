// Drawings to decompose: simple rings that neither cross nor touch, by construction.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "base/random.hpp"
#include "dartcast/decompose.hpp"

namespace dartcast::test {

/// n >= 5 points around a middle, at random distances in [near, far]; every direction meets it once.
inline Ring star(Random& random, const Vec3& middle, int n, double near, double far) {
  Ring ring;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.4 * random.uniform()) / n;
    const double r = random.uniform(near, far);
    ring.points.push_back(middle + Vec3{r * std::cos(angle), r * std::sin(angle), 0.0});
  }
  if (random.below(2) == 0) std::reverse(ring.points.begin(), ring.points.end());
  return ring;
}

/// A star with holes, an island in each.
inline std::vector<Ring> star_with_holes(Random& random, int n) {
  std::vector<Ring> rings = {star(random, {0, 0, 0}, n, 10, 20)};
  for (int i = 0; i < 3; ++i) {
    const double angle = 2 * std::numbers::pi * i / 3;
    // A chord of a star of 9 points comes no nearer to the middle than cos(28 degrees) > 0.85 of its ends.
    const Vec3 middle = {4.5 * std::cos(angle), 4.5 * std::sin(angle), 0};
    rings.push_back(star(random, middle, 9 + n / 8, 2, 3));
    rings.push_back(star(random, middle, 9, 0.5, 1.5));
    rings.back().name = "island";
  }
  rings[0].name = "shore";
  return rings;
}

/// Points from left to right and back, above and below a line: long thin triangles.
inline Ring monotone(Random& random, int n) {
  Ring ring;
  for (int i = 0; i < n; ++i) ring.points.push_back({i + 0.5 * random.uniform(), 0.1 + 5 * random.uniform(), 0});
  for (int i = n; i-- > 0;) ring.points.push_back({i + 0.5 * random.uniform(), -0.1 - 5 * random.uniform(), 0});
  return ring;
}

/// Random points joined in a random order, then two edges that cross swapped until none do: edges short and long. In
/// doubles: no three points are nearly on a line.
inline Ring untangled(Random& random, std::size_t n) {
  Ring ring;
  for (std::size_t i = 0; i < n; ++i) ring.points.push_back({random.uniform(), random.uniform(), 0});
  auto& p = ring.points;
  const auto left = [](const Vec3& a, const Vec3& b, const Vec3& c) { return cross(b - a, c - a).z > 0; };
  const auto cross_each_other = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return left(a, b, c) != left(a, b, d) && left(c, d, a) != left(c, d, b);
  };
  for (bool tangled = true; tangled;) {
    tangled = false;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = i + 2; j < n && j + 1 < n + i; ++j) {
        if (!cross_each_other(p[i], p[i + 1], p[j], p[(j + 1) % n])) continue;
        std::reverse(p.begin() + static_cast<std::ptrdiff_t>(i + 1), p.begin() + static_cast<std::ptrdiff_t>(j + 1));
        tangled = true;
      }
    }
  }
  return ring;
}

/// The same drawing of integers, crushed to a line but for the last bits: what lay on a line still does, exactly.
inline std::vector<Ring> flattened(std::vector<Ring> rings) {
  constexpr double k = 0x1p+25;  // k k - (k + 1) (k - 1) = 1
  for (Ring& ring : rings) {
    for (Vec3& p : ring.points) p = {k * p.x + (k + 1) * p.y, (k - 1) * p.x + k * p.y, 0};
  }
  return rings;
}

/// Teeth of lattice points; with `all`, every lattice point along the ring is a corner.
inline Ring comb(Random& random, int teeth, int length, bool all) {
  std::vector<Vec3> corners = {{0, -1, 0}, {2.0 * teeth - 1, -1, 0}};
  for (int i = teeth; i-- > 0;) {
    const double height = 1.0 + random.below(static_cast<std::uint32_t>(length));
    corners.push_back({2.0 * i + 1, height, 0});
    corners.push_back({2.0 * i, height, 0});
    if (i > 0) corners.insert(corners.end(), {{2.0 * i, 0, 0}, {2.0 * i - 1, 0, 0}});
  }
  if (!all) return {corners, ""};
  Ring ring;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 along = corners[(i + 1) % corners.size()] - corners[i];
    const int steps = static_cast<int>(norm(along));
    for (int k = 0; k < steps; ++k) ring.points.push_back(corners[i] + along * (1.0 / steps) * k);
  }
  for (Vec3& p : ring.points) p = {std::round(p.x), std::round(p.y), 0};
  return ring;
}

/// A band that winds around the origin.
inline Ring spiral(int turns, int n) {
  Ring ring;
  const auto at = [&](int i, double off) {
    const double angle = 2 * std::numbers::pi * turns * i / n;
    const double r = 1 + angle + off;
    return Vec3{r * std::cos(angle), r * std::sin(angle), 0};
  };
  for (int i = 0; i < n; ++i) ring.points.push_back(at(i, 0));
  for (int i = n; i-- > 0;) ring.points.push_back(at(i, 2));
  ring.name = "band";
  return ring;
}

/// Squares within squares, `per_side` edges along each side, in both directions.
inline std::vector<Ring> nested(int depth, int per_side) {
  std::vector<Ring> rings;
  for (int d = depth; d > 0; --d) {
    const double r = d * per_side;
    Ring ring;
    const Vec3 corners[5] = {{-r, -r, 0}, {r, -r, 0}, {r, r, 0}, {-r, r, 0}, {-r, -r, 0}};
    for (int s = 0; s < 4; ++s) {
      for (int k = 0; k < per_side; ++k)
        ring.points.push_back(corners[s] + (corners[s + 1] - corners[s]) * (static_cast<double>(k) / per_side));
    }
    if (d % 2 == 0) std::reverse(ring.points.begin(), ring.points.end());
    ring.name = d % 3 == 0 ? "third" : "";
    rings.push_back(ring);
  }
  return rings;
}

/// A long needle, and specks on both sides of it: its edges cross many edges between them.
inline std::vector<Ring> needle(Random& random, int n) {
  std::vector<Ring> rings = {{{{0, 0, 0}, {3.0 * n, 1.0 * n, 0}, {0, 0.01, 0}}, "needle"}};
  for (int i = 0; i < 3 * n; ++i) {
    for (int j = -2; j < 3; ++j) {
      const Vec3 middle = {i + 0.5, std::round(i / 3.0) + j + random.uniform(0, 0.5), 0};
      if (std::abs(middle.y - middle.x / 3) < 0.35) continue;
      rings.push_back(star(random, middle, 5, 0.01, 0.2));
    }
  }
  return rings;
}

/// The same on integers: rows of squares along a needle, with corners on one line.
inline std::vector<Ring> needle_between_squares(int n) {
  const double end = 4.0 * n;
  std::vector<Ring> rings = {{{{-1, 0, 0}, {end, 0, 0}, {end, 1, 0}}, "needle"}};
  for (int i = 0; i < n; ++i) {
    for (const double y : {-3.0, 2.0}) {
      const double x = 4.0 * i;
      rings.push_back({{{x, y, 0}, {x + 2, y, 0}, {x + 2, y + 2, 0}, {x, y + 2, 0}}, ""});
    }
  }
  return rings;
}

}  // namespace dartcast::test
