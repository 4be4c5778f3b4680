// Paths that are known: lattices that unfold to the plane, closed geodesics, flat sheets, and vertices.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "dartcast/surface.hpp"
#include "support/surface_meshes.hpp"
#include "support/tier.hpp"

namespace dartcast::known_paths_test {

using test::gap;

constexpr double pi = std::numbers::pi;

// The tetrahedron rolls over the triangular lattice and marks its points: (i, j) is corner i mod 2 + 2 (j mod 2).
Vec3 on_tetrahedron(const MeshData& mesh, long double u, long double v) {
  const auto i = static_cast<long>(std::floor(u));
  const auto j = static_cast<long>(std::floor(v));
  const auto at = [&](long a, long b) { return mesh.points[static_cast<std::size_t>((a & 1) + 2 * (b & 1))]; };
  const auto x = static_cast<double>(u - static_cast<long double>(i));
  const auto y = static_cast<double>(v - static_cast<long double>(j));
  if (x + y <= 1.0) return at(i, j) * (1.0 - x - y) + at(i + 1, j) * x + at(i, j + 1) * y;
  return at(i + 1, j + 1) * (x + y - 1.0) + at(i + 1, j) * (1.0 - y) + at(i, j + 1) * (1.0 - x);
}

TEST(SurfacePaths, OnTheTetrahedronUnfoldToTheLattice) {
  const MeshData mesh = test::tetrahedron();
  const Surface surface(mesh);
  const SimplexId start = test::triangle_of(surface, 0);
  const auto corners = surface.vertices(start);
  ASSERT_EQ(corners[0].value, 0U);
  ASSERT_EQ(corners[1].value, 1U);
  Random random(1);
  for (int i = 0; i < test::scaled(20, 400); ++i) {
    const double du = random.uniform(-4000.0, 4000.0);
    const double dv = random.uniform(-4000.0, 4000.0);
    const Vec3 displacement = (mesh.points[1] - mesh.points[0]) * du + (mesh.points[2] - mesh.points[0]) * dv;
    SurfacePlace place = surface.place(start, {0.25, 0.25, 0.5});
    const SurfaceStep step = dartcast::step(surface, place, displacement);
    ASSERT_EQ(step.end, SurfaceEnd::arrived);
    EXPECT_NEAR(step.length, norm(displacement), 1e-12 * norm(displacement));
    EXPECT_GT(step.crossings, 1000U);
    // The direction turns by some 2^-53 in each triangle, the same way in all, since all are equal.
    const double bound = 0x1p-53 * step.crossings * step.length;
    EXPECT_LE(gap(surface.point(place), on_tetrahedron(mesh, 0.25L + du, 0.5L + dv)), bound);
  }
}

TEST(SurfacePaths, GoOnStraightInManyShortSteps) {
  const MeshData mesh = test::tetrahedron();
  const Surface surface(mesh);
  const double du = 0.031;
  const double dv = 0.0477;
  Vec3 displacement = (mesh.points[1] - mesh.points[0]) * du + (mesh.points[2] - mesh.points[0]) * dv;
  const double length = norm(displacement);
  SurfacePlace place = surface.place(test::triangle_of(surface, 0), {0.25, 0.25, 0.5});
  for (int i = 1; i <= 3000; ++i) {
    displacement = dartcast::step(surface, place, displacement).direction * length;
    ASSERT_LE(gap(surface.point(place), on_tetrahedron(mesh, 0.25L + i * static_cast<long double>(du),
                                                       0.5L + i * static_cast<long double>(dv))),
              1e-11);
  }
}

TEST(SurfacePaths, OnTheCubeClose) {
  const Surface surface(test::cube());
  const auto around = [&](const Vec3& from, const Vec3& way, std::uint32_t crossings) {
    // The bottom is face 0: 0, 2, 3, 1, a fan from corner 0.
    const bool lower = from.x > from.y;  // the triangle 0, 3, 1
    SurfacePlace place = lower
                             ? surface.place(test::triangle_of(surface, 0, 1), {1.0 - from.x, from.y, from.x - from.y})
                             : surface.place(test::triangle_of(surface, 0, 0), {1.0 - from.y, from.y - from.x, from.x});
    ASSERT_LE(gap(surface.point(place), from), 1e-15);
    const Vec3 start = surface.point(place);
    const SurfacePlace first = place;
    const SurfaceStep step = dartcast::step(surface, place, way);
    EXPECT_EQ(step.crossings, crossings);
    EXPECT_EQ(place.triangle, first.triangle);
    EXPECT_LE(gap(surface.point(place), start), 1e-14);
    EXPECT_LE(gap(step.direction * norm(way), way), 1e-13);
  };
  const double r2 = std::numbers::sqrt2;
  around({0.75, 0.25, 0.0}, {4.0, 0.0, 0.0}, 8);  // four edges, four diagonals of squares
  around({0.25, 0.75, 0.0}, {0.0, -4.0, 0.0}, 8);
  around({0.875, 0.75, 0.0}, Vec3{-1.0, 1.0, 0.0} * 3.0, 6 + 6);  // the hexagon; half of the diagonals run across
  EXPECT_NEAR(norm(Vec3{-1.0, 1.0, 0.0} * 3.0), 3.0 * r2, 1e-15);
}

TEST(SurfacePaths, AreStraightOnTiltedSheets) {
  Random random(3);
  int inside = 0;
  int stopped = 0;
  const int seeds = std::max(2, test::scaled(20, 200));
  for (int seed = 1; seed <= seeds; ++seed) {
    RectangleOptions o;
    o.cells = {7, 6};
    o.size = {2.0, 3.0};
    o.mixed = true;
    o.jitter = 0.2;
    o.seed = static_cast<std::uint64_t>(seed);
    MeshData mesh = generate_rectangle(o);
    const test::Motion motion = test::random_motion(random);
    for (Vec3& p : mesh.points) p = motion(p);
    const Surface surface(mesh);
    for (int i = 0; i < 20; ++i) {
      SurfacePlace place = test::random_place(surface, random);
      const Vec3 start = surface.point(place);
      const Vec3 way = motion.turned({random.uniform(-1, 1), random.uniform(-1, 1), 0.0});
      std::vector<SurfaceContact> contacts;
      const SurfaceStep step = dartcast::step(surface, place, way, {}, {}, {&contacts, nullptr});
      ASSERT_EQ(contacts.size(), step.contacts);
      const double time = contacts.empty() ? 1.0 : contacts[0].time_of_impact;
      ASSERT_LE(gap(surface.point(place), start + way * time), 1e-14);
      ASSERT_LE(gap(step.remaining, way * (1.0 - time)), 1e-14);
      if (contacts.empty()) {
        ++inside;
        continue;
      }
      ++stopped;
      // On a side of the rectangle, whose normal points back in.
      const auto at = [&](const Vec3& axis) { return dot(contacts[0].point - motion.shift, axis); };
      const double x = at(motion.axes[0]);
      const double y = at(motion.axes[1]);
      const double off[] = {x, 2.0 - x, y, 3.0 - y};
      const int side = static_cast<int>(std::min_element(off, off + 4) - off);
      ASSERT_LE(off[side], 1e-14);
      const Vec3 inwards = motion.axes[side / 2U] * (side % 2 == 0 ? 1.0 : -1.0);
      ASSERT_LE(gap(contacts[0].normal, inwards), 1e-12);
      ASSERT_EQ(surface.map().patch_names()[contacts[0].patch.value],
                (std::array{"xmin", "xmax", "ymin", "ymax"}[static_cast<std::size_t>(side)]));
    }
  }
  EXPECT_GT(inside, 4 * seeds);
  EXPECT_GT(stopped, 4 * seeds);
}

TEST(SurfacePaths, AreAsLongAsTheirChords) {
  Random random(5);
  for (int seed = 1; seed <= 5; ++seed) {
    const Surface surface(test::bumpy(3, 0.3, static_cast<std::uint64_t>(seed)));
    for (int i = 0; i < test::scaled(100, 1000); ++i) {
      SurfacePlace place = test::random_place(surface, random);
      const Vec3 n = surface.normal(place.triangle);
      Vec3 way = test::random_vector(random) * 10.0;
      way -= n * dot(n, way);
      std::vector<SurfaceCrossing> crossings;
      Vec3 at = surface.point(place);
      const SurfaceStep step = dartcast::step(surface, place, way, {}, {}, {nullptr, &crossings});
      ASSERT_EQ(crossings.size(), step.crossings);
      double length = 0.0;
      double time = 0.0;
      for (const SurfaceCrossing& c : crossings) {
        length += gap(c.point, at);
        at = c.point;
        ASSERT_GE(c.time, time);
        time = c.time;
        ASSERT_NEAR(time * norm(way), length, 1e-12 * norm(way));
        ASSERT_EQ(c.place.kind(), c.kind);
        ASSERT_EQ(c.dart.cell, c.place.triangle.cell);
      }
      length += gap(surface.point(place), at);
      ASSERT_NEAR(length, norm(way), 1e-12 * norm(way));
      ASSERT_NEAR(step.length, norm(way), 1e-14 * norm(way));
      ASSERT_NEAR(norm(step.direction), 1.0, 1e-15 * 8);
      ASSERT_NEAR(dot(step.direction, surface.normal(place.triangle)), 0.0, 1e-15 * 8);
    }
  }
}

// The squares around a vertex, counterclockwise, by the edges that they have there: from the vertex to their last
// corner and to their next one.
struct SquareAt {
  std::uint32_t next, across, last;
};

std::vector<SquareAt> squares_around(const MeshData& mesh, std::uint32_t v, std::uint32_t first) {
  std::map<std::uint32_t, SquareAt> by_next;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const auto f = mesh.cell(c);
    for (unsigned k = 0; k < 4; ++k) {
      if (f[k] == v) by_next[f[(k + 1) % 4]] = {f[(k + 1) % 4], f[(k + 2) % 4], f[(k + 3) % 4]};
    }
  }
  std::vector<SquareAt> around;
  for (std::uint32_t next = first; around.empty() || next != first; next = around.back().last) {
    around.push_back(by_next.at(next));
  }
  return around;
}

// On surfaces of unit cubes all of this is exact, so that paths do hit vertices: of three, four, five and six squares.
TEST(SurfacePaths, LeaveVerticesWithEqualAnglesOnBothSides) {
  const MeshData mesh = test::castle();
  const Surface surface(mesh);
  std::map<std::size_t, int> seen;
  for (const SimplexId t : surface.triangles()) {
    const auto v = surface.vertices(t);
    const auto x = surface.corners(t);
    for (unsigned k = 0; k < 3; ++k) {
      const unsigned to = (k + 1) % 3;
      if (std::abs(norm(x[to] - x[k]) - 1.0) > 0.1) continue;  // a square's diagonal
      std::array<double, 3> weights = {};
      weights[k] = weights[to] = 0.5;
      SurfacePlace place = surface.place(t, weights);
      std::vector<SurfaceCrossing> crossings;
      const SurfaceStep step = dartcast::step(surface, place, (x[to] - x[k]) * 0.75, {}, {}, {nullptr, &crossings});
      ASSERT_EQ(step.end, SurfaceEnd::arrived);
      ASSERT_EQ(crossings.size(), 1U);
      EXPECT_EQ(crossings[0].kind, Kind::vertex);
      EXPECT_EQ(crossings[0].point, x[to]);
      EXPECT_EQ(surface.map().origin(crossings[0].dart), v[to]);
      const auto around = squares_around(mesh, v[to].value, v[k].value);
      const SquareAt& opposite = around[around.size() / 2];
      const Vec3 out = mesh.points[around.size() % 2 == 0 ? opposite.next : opposite.across] - x[to];
      const Vec3 expected = x[to] + out * (0.25 / norm(out));
      EXPECT_LE(gap(surface.point(place), expected), 1e-15) << "at a vertex of " << around.size() << " squares";
      ++seen[around.size()];
    }
  }
  for (const std::size_t squares : {3U, 4U, 5U}) EXPECT_GT(seen[squares], 0) << squares;
}

// The angle from the first edge of a corner, counterclockwise around the vertex, to a place in one of the triangles
// there; in long double, by the mesh alone.
long double angle_to(const MeshData& mesh, std::array<std::uint32_t, 3> first, const Vec3& x,
                     std::array<std::uint32_t, 3> in, long double& total) {
  std::map<std::uint32_t, std::array<std::uint32_t, 3>> by_next;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const auto f = mesh.cell(c);
    for (unsigned k = 0; k < 3; ++k) {
      if (f[k] == first[0]) by_next[f[(k + 1) % 3]] = {f[k], f[(k + 1) % 3], f[(k + 2) % 3]};
    }
  }
  const auto angle = [&](const Vec3& a, const Vec3& b) {
    long double n = 0;
    const long double p[3] = {a.x, a.y, a.z};
    const long double q[3] = {b.x, b.y, b.z};
    long double along = 0;
    for (unsigned i = 0; i < 3; ++i) {
      const long double c = p[i] * q[(i + 1) % 3] - p[(i + 1) % 3] * q[i];
      n += c * c;
      along += p[i] * q[i];
    }
    return std::atan2(std::sqrt(n), along);
  };
  const Vec3 v = mesh.points[first[0]];
  long double found = -1;
  total = 0;
  std::uint32_t next = first[1];
  do {
    const auto& t = by_next.at(next);
    if (t == in) found = total + angle(mesh.points[t[1]] - v, x - v);
    total += angle(mesh.points[t[1]] - v, mesh.points[t[2]] - v);
    next = t[2];
  } while (next != first[1]);
  return found;
}

// The same from corner k of a triangle to a place near it.
long double angle_at(const MeshData& mesh, const Surface& surface, SimplexId t, unsigned k, const SurfacePlace& place,
                     long double& total) {
  const auto v = surface.vertices(t);
  const auto w = surface.vertices(place.triangle);
  std::array<std::uint32_t, 3> in{};
  for (unsigned i = 0; i < 3; ++i) {
    if (w[i] == v[k]) in = {w[i].value, w[(i + 1) % 3].value, w[(i + 2) % 3].value};
  }
  return angle_to(mesh, {v[k].value, v[(k + 1) % 3].value, v[(k + 2) % 3].value}, surface.point(place), in, total);
}

TEST(SurfacePaths, PassAnyVertexWithEqualAngles) {
  Random random(8);
  for (int seed = 1; seed <= 5; ++seed) {
    const MeshData mesh = test::bumpy(1, 0.4, static_cast<std::uint64_t>(seed));
    const Surface surface(mesh);
    for (const SimplexId t : surface.triangles()) {
      for (unsigned k = 0; k < 3; ++k) {
        const auto x = surface.corners(t);
        const Vec3 one = x[(k + 1) % 3] - x[k];
        const Vec3 two = x[(k + 2) % 3] - x[k];
        const double back = std::atan2(norm(cross(one, two)), dot(one, two)) * random.uniform(0.01, 0.99);
        std::array<double, 3> weights = {};
        weights[k] = 1.0;
        SurfacePlace place = surface.place(t, weights);
        dartcast::step(surface, place, tangent(surface, t, k, back + pi, 1e-3));
        long double total = 0;
        const long double out = angle_at(mesh, surface, t, k, place, total);
        ASSERT_GE(out, 0.0L);
        const long double left = out > back ? out - back : out - back + total;
        ASSERT_NEAR(static_cast<double>(left), static_cast<double>(total / 2), 1e-11);
      }
    }
  }
}

TEST(SurfacePaths, MayStartAtAVertexIntoAnyTriangle) {
  const MeshData mesh = test::sphere(2);
  const Surface surface(mesh);
  // Straight ahead of a triangle's corner it unfolds over the triangles beside it, by angles that are kept.
  for (const SimplexId t : surface.triangles()) {
    for (unsigned k = 0; k < 3; ++k) {
      for (const double angle : {-0.9, -0.3, 0.4, 1.8, 2.4}) {
        std::array<double, 3> weights = {};
        weights[k] = 1.0;
        SurfacePlace place = surface.place(t, weights);
        const SurfaceStep step = dartcast::step(surface, place, tangent(surface, t, k, angle, 1e-3));
        ASSERT_EQ(step.end, SurfaceEnd::arrived);
        long double total = 0;
        const long double out = angle_at(mesh, surface, t, k, place, total);
        const auto wanted = static_cast<double>(angle < 0.0 ? angle + total : angle);
        ASSERT_NEAR(static_cast<double>(out), wanted, 1e-11);
      }
    }
  }
}

}  // namespace dartcast::known_paths_test
