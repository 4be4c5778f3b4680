// Holes with borders at random, and triangles at random around them, against all ways to close them.
#include "meshing/fill_hole.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "base/random.hpp"

namespace dartcast::fill_hole_test {

using Triangles = std::vector<TriangleCorners>;

// All ways to divide the polygon of these corners into triangles.
std::vector<Triangles> all_ways(const std::vector<std::uint32_t>& corners) {
  if (corners.size() < 3) return {{}};
  std::vector<Triangles> ways;
  for (std::size_t j = 1; j + 1 < corners.size(); ++j) {
    const auto middle = corners.begin() + static_cast<std::ptrdiff_t>(j);
    for (const Triangles& left : all_ways({corners.begin(), middle + 1})) {
      for (const Triangles& right : all_ways({middle, corners.end()})) {
        Triangles way = left;
        way.insert(way.end(), right.begin(), right.end());
        way.push_back({corners.front(), *middle, corners.back()});
        ways.push_back(std::move(way));
      }
    }
  }
  return ways;
}

double area(const std::vector<Vec3>& points, const Triangles& triangles) {
  double sum = 0.0;
  for (const TriangleCorners& t : triangles)
    sum += 0.5 * norm(cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]]));
  return sum;
}

bool is_clear(const std::vector<Vec3>& points, const Triangles& surface, const Triangles& fill) {
  for (std::size_t i = 0; i < fill.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (cross_or_touch(points, fill[i], fill[k])) return false;
    }
    if (std::any_of(surface.begin(), surface.end(), [&](const auto& t) { return cross_or_touch(points, fill[i], t); }))
      return false;
  }
  return true;
}

// Each edge of the border is one of one triangle, in its sense; each other edge is one of two, once in each sense.
void expect_to_close(const std::vector<std::uint32_t>& corners, const Triangles& fill) {
  ASSERT_EQ(fill.size(), corners.size() - 2);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (const TriangleCorners& t : fill) {
    for (std::size_t k = 0; k < 3; ++k) ++uses[{t[k], t[(k + 1) % 3]}];
  }
  for (std::size_t i = 0; i < corners.size(); ++i) --uses[{corners[i], corners[(i + 1) % corners.size()]}];
  for (const auto& [edge, count] : uses) EXPECT_EQ(count, (uses[{edge.second, edge.first}]));
}

TEST(FillHole, FindsTheLeastAreaThatIsClear) {
  Random random(5);
  unsigned filled = 0, possible = 0, hindered = 0;
  for (int round = 0; round < 300; ++round) {
    const auto n = static_cast<std::uint32_t>(4 + round % 5);
    std::vector<Vec3> points;
    for (std::uint32_t i = 0; i < n + 12; ++i)
      points.push_back({random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0),
                        i < n ? random.uniform(-0.4, 0.4) : random.uniform(-1.0, 1.0)});
    const auto angle = [](const Vec3& x) {
      return x.y > 0.0 ? -x.x / norm({x.x, x.y, 0}) : 2.0 + x.x / norm({x.x, x.y, 0});
    };
    std::sort(points.begin(), points.begin() + n, [&](const Vec3& a, const Vec3& b) { return angle(a) < angle(b); });
    std::vector<std::uint32_t> corners(n);
    std::iota(corners.begin(), corners.end(), 0U);
    Triangles surface;
    for (std::uint32_t t = 0; t < static_cast<std::uint32_t>(round % 3); ++t)
      surface.push_back({n + 3 * t, n + 3 * t + 1, n + 3 * t + 2});
    double least = -1.0, least_clear = -1.0;
    for (const Triangles& way : all_ways(corners)) {
      const double a = area(points, way);
      if (least < 0.0 || a < least) least = a;
      if (is_clear(points, surface, way) && (least_clear < 0.0 || a < least_clear)) least_clear = a;
    }
    const Triangles fill = fill_hole(points, corners, surface);
    possible += least_clear >= 0.0 ? 1 : 0;
    if (fill.empty()) continue;
    ++filled;
    hindered += least_clear > least ? 1 : 0;
    EXPECT_TRUE(is_clear(points, surface, fill)) << round;
    expect_to_close(corners, fill);
    EXPECT_NEAR(area(points, fill), least_clear, 1e-12) << round;
  }
  EXPECT_EQ(filled, possible);
  EXPECT_GT(filled, 150U);
  EXPECT_GT(hindered, 5U);
}

// An edge that the surface has already would get a third triangle.
TEST(FillHole, LeavesEdgesOfTheSurface) {
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, -1}, {1, 1, 0}, {0, 1, -1}, {0.5, 0.5, 2}, {0.5, 0.5, -2}};
  const std::vector<std::uint32_t> corners = {0, 1, 2, 3};
  const auto has = [](const Triangles& all, std::uint32_t a, std::uint32_t b) {
    return std::any_of(all.begin(), all.end(), [&](const TriangleCorners& t) {
      return std::count(t.begin(), t.end(), a) + std::count(t.begin(), t.end(), b) == 2;
    });
  };
  const Triangles with_02 = {{0, 2, 4}}, with_13 = {{1, 3, 5}};
  EXPECT_TRUE(has(fill_hole(points, corners, with_02), 1, 3));
  EXPECT_TRUE(has(fill_hole(points, corners, with_13), 0, 2));
  EXPECT_TRUE(fill_hole(points, corners, Triangles{{0, 2, 4}, {1, 3, 5}}).empty());
}

}  // namespace dartcast::fill_hole_test
