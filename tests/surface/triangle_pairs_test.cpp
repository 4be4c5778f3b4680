// Pairs of triangles that cross or touch, against CGAL's exact constructions; polygons as triangles.
#include "surface/triangle_pairs.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "support/closed_surfaces.hpp"
#include "support/tier.hpp"
#include "surface/ears.hpp"

namespace dartcast::triangle_pairs_test {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;

Kernel::Point_3 exact(const Vec3& p) { return {p.x, p.y, p.z}; }

Kernel::Triangle_3 exact(const std::vector<Vec3>& points, const TriangleCorners& t) {
  return {exact(points[t[0]]), exact(points[t[1]]), exact(points[t[2]])};
}

/// Whether all of the part in common lies on what the triangles share by number.
bool expected(const std::vector<Vec3>& points, const TriangleCorners& a, const TriangleCorners& b) {
  std::vector<std::uint32_t> shared;
  for (const std::uint32_t p : a) {
    if (std::find(b.begin(), b.end(), p) != b.end()) shared.push_back(p);
  }
  if (shared.size() == 3) return true;
  const auto common = CGAL::intersection(exact(points, a), exact(points, b));
  if (!common) return false;
  if (shared.empty()) return true;
  if (const auto* point = boost::get<Kernel::Point_3>(&*common))
    return shared.size() != 1 || *point != exact(points[shared[0]]);
  if (const auto* segment = boost::get<Kernel::Segment_3>(&*common)) {
    if (shared.size() != 2) return true;
    const Kernel::Segment_3 edge(exact(points[shared[0]]), exact(points[shared[1]]));
    return *segment != edge && segment->opposite() != edge;
  }
  return true;
}

TEST(TrianglePairs, MeetAsExactConstructionsSay) {
  std::mt19937 random(5);
  int met = 0;
  const int rounds = test::scaled(40000, 1000000);
  for (int round = 0; round < rounds; ++round) {
    // Few places, so that corners, edges and planes coincide often; and some in no plane.
    const int width = 2 + static_cast<int>(random() % 3);
    std::vector<Vec3> points;
    for (int i = 0; i < 6; ++i) {
      const auto coordinate = [&] { return static_cast<double>(random() % static_cast<unsigned>(width)); };
      points.push_back({coordinate(), coordinate(), round % 3 == 0 ? 0.0 : coordinate()});
      if (round % 7 == 0)
        points.back() = points.back() * 0.1 + Vec3{1e-17 * static_cast<double>(random() % 3), 0.0, 0.3};
    }
    const std::size_t shared = random() % 3;
    const TriangleCorners a = {0, 1, 2};
    TriangleCorners b = {3, 4, 5};
    for (std::size_t k = 0; k < shared; ++k) b[k] = static_cast<std::uint32_t>((k + random() % 2) % 3);
    std::shuffle(b.begin(), b.end(), random);
    if (std::set<std::uint32_t>(b.begin(), b.end()).size() != 3) continue;
    if (exact(points, a).is_degenerate() || exact(points, b).is_degenerate()) continue;
    const bool truth = expected(points, a, b);
    met += truth ? 1 : 0;
    ASSERT_EQ(cross_or_touch(points, a, b), truth) << "round " << round;
    ASSERT_EQ(cross_or_touch(points, b, a), truth) << "round " << round;
  }
  EXPECT_GT(met, rounds / 10);
  EXPECT_LT(met, rounds);
}

TEST(TrianglePairs, AllAreFoundOnce) {
  std::mt19937 random(2);
  std::vector<Vec3> points;
  std::vector<TriangleCorners> triangles;
  for (std::uint32_t t = 0; t < 150; ++t) {
    const auto coordinate = [&](double size) { return size * static_cast<double>(random() % 1000) / 1000.0; };
    const Vec3 centre = {coordinate(4.0), coordinate(4.0), coordinate(4.0)};
    for (int k = 0; k < 3; ++k) points.push_back(centre + Vec3{coordinate(1.0), coordinate(1.0), coordinate(1.0)});
    triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> all;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    for (std::uint32_t j = i + 1; j < triangles.size(); ++j) {
      if (expected(points, triangles[i], triangles[j])) all.emplace_back(i, j);
    }
  }
  EXPECT_GT(all.size(), 20U);
  EXPECT_EQ(crossing_pairs(points, triangles, 1000000), all);
  EXPECT_EQ(crossing_pairs(points, triangles, 7).size(), 7U);
}

// Polygons.

double area_of(const std::vector<Vec3>& points, const TriangleCorners& t) {
  return 0.5 * norm(cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]]));
}

void expect_covered(const std::vector<Vec3>& points, double area) {
  std::vector<std::uint32_t> corners;
  for (std::uint32_t i = 0; i < points.size(); ++i) corners.push_back(i);
  for (const bool turned : {false, true}) {
    if (turned) std::reverse(corners.begin(), corners.end());
    const auto triangles = ears(points, corners);
    ASSERT_EQ(triangles.size(), points.size() - 2);
    EXPECT_TRUE(crossing_pairs(points, triangles, 10).empty());
    double sum = 0.0;
    for (const TriangleCorners& t : triangles) {
      sum += area_of(points, t);
      EXPECT_GT(dot(vector_area(points, t), vector_area(points, corners)), 0.0);
    }
    EXPECT_NEAR(sum, area, 1e-12 * area);
  }
}

TEST(Ears, CoverPolygonsThatAreNotConvex) {
  const std::vector<Vec3> comb = {{0, 0, 0}, {5, 0, 0}, {5, 2, 0}, {4, 2, 0}, {4, 1, 0},
                                  {3, 1, 0}, {3, 2, 0}, {2, 2, 0}, {2, 1, 0}, {0, 1, 0}};
  std::vector<Vec3> steep, sideways;
  for (const Vec3& p : comb) {
    steep.push_back({p.x, p.y, 3.0 * p.x + 2.0 * p.y});
    sideways.push_back({0.5, p.x, p.y});
  }
  expect_covered(comb, 7.0);
  expect_covered(steep, 7.0 * std::sqrt(14.0));
  expect_covered(sideways, 7.0);
}

TEST(Ears, CornersOnStraightSides) {
  expect_covered({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {3, 1, 0}, {1.5, 1, 0}, {0, 1, 0}, {0, 0.5, 0}}, 3.0);
}

TEST(Ears, APolygonThatCrossesItselfIsAFan) {
  const std::vector<Vec3> bow = {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_EQ(ears(bow, std::vector<std::uint32_t>{0, 1, 2, 3}).size(), 2U);
}

}  // namespace dartcast::triangle_pairs_test
