// The audit of solids: intersections of triangles, edges and points against CGAL's exact constructions, and walls of a
// scene that elements pierce.
#include "solids/audit_solids.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <gtest/gtest.h>

#include <random>

#include "dartcast/environment.hpp"
#include "support/meshes.hpp"
#include "support/tier.hpp"

namespace dartcast::audit_solids_test {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Corners3 = std::array<Vec3, 3>;

Kernel::Point_3 exact(const Vec3& p) { return {p.x, p.y, p.z}; }

// The triangle, or the segment or the point that is left of it.
struct Part {
  unsigned dimension = 0;
  Kernel::Point_3 point;
  Kernel::Segment_3 segment;
  Kernel::Triangle_3 triangle;

  explicit Part(const Corners3& t) : point(exact(t[0])), triangle(exact(t[0]), exact(t[1]), exact(t[2])) {
    if (!triangle.is_degenerate()) {
      dimension = 2;
      return;
    }
    for (unsigned i = 0; i < 3; ++i) {  // the longest side
      const Kernel::Segment_3 side(exact(t[i]), exact(t[(i + 1) % 3]));
      if (i == 0 || side.squared_length() > segment.squared_length()) segment = side;
    }
    dimension = segment.is_degenerate() ? 0 : 1;
  }
};

template <class A>
bool meets(const A& a, const Part& b) {
  if (b.dimension == 2) return CGAL::do_intersect(a, b.triangle);
  if (b.dimension == 1) return CGAL::do_intersect(a, b.segment);
  return a.has_on(b.point);
}

bool expected(const Corners3& s, const Corners3& t) {
  const Part a(s);
  const Part b(t);
  if (a.dimension == 2) return meets(a.triangle, b);
  if (a.dimension == 1) return meets(a.segment, b);
  if (b.dimension == 2) return b.triangle.has_on(a.point);
  if (b.dimension == 1) return b.segment.has_on(a.point);
  return a.point == b.point;
}

TEST(AuditSolids, MeetsAsExactConstructionsSay) {
  std::mt19937 random(5);
  std::array<int, 2> met{};
  const int rounds = test::scaled(20000, 400000);
  for (int round = 0; round < rounds; ++round) {
    // Few places, so that points, edges and planes coincide often, and triangles are flat.
    const unsigned width = 2 + random() % 4;
    const auto point = [&] {
      const auto coordinate = [&] { return static_cast<double>(random() % width); };
      const Vec3 p = {coordinate(), coordinate(), round % 3 == 0 ? 0.0 : coordinate()};
      return round % 7 == 0 ? p * 0.1 + Vec3{1e-17 * static_cast<double>(random() % 3), 0.0, 0.3} : p;
    };
    Corners3 a = {point(), point(), point()};
    const Corners3 b = {point(), point(), point()};
    if (round % 5 == 0) a[2] = a[1];
    if (round % 25 == 0) a[1] = a[2] = a[0];
    const bool meet = expected(a, b);
    ++met[meet ? 1 : 0];
    ASSERT_EQ(audit_meet(a, b), meet) << round;
    ASSERT_EQ(audit_meet(b, a), meet) << round;
  }
  EXPECT_GT(met[0], rounds / 8);
  EXPECT_GT(met[1], rounds / 8);
}

// An edge and a triangle through an obstacle that has none of their corners inside.
TEST(AuditSolids, FindsWhatPassesThroughAWall) {
  MeshData mesh = test::cubes(5);
  mesh.free.assign(mesh.cell_count(), 1);
  mesh.free[62] = 0;  // the cube in the middle, from 2 to 3
  const Environment environment(mesh);
  const WallAudit audit(environment.complex());
  const std::vector<Vec3> points = {{1.5, 2.5, 2.5}, {3.5, 2.5, 2.5}, {2.5, 4.5, 2.5}, {1.5, 1.5, 1.5},
                                    {2.0, 2.5, 2.5}, {0.5, 0.5, 4.5}, {4.5, 0.5, 0.5}, {0.5, 4.5, 0.5}};
  EXPECT_TRUE(audit.meets_wall(points, {{0, 1, 1}, 2}));
  EXPECT_TRUE(audit.meets_wall(points, {{0, 1, 2}, 3}));
  EXPECT_FALSE(audit.meets_wall(points, {{0, 3, 3}, 2}));
  EXPECT_FALSE(audit.meets_wall(points, {{0, 2, 2}, 2}));
  EXPECT_TRUE(audit.meets_wall(points, {{0, 4, 4}, 2})) << "touches the wall with an end";
  EXPECT_TRUE(audit.meets_wall(points, {{4, 4, 4}, 1}));
  EXPECT_FALSE(audit.meets_wall(points, {{0, 0, 0}, 1}));
  EXPECT_FALSE(audit.meets_wall(points, {{5, 6, 7}, 3})) << "passes beside the obstacle";
}

}  // namespace dartcast::audit_solids_test
