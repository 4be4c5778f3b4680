// The first time within a separation against known pairs, against distances sampled in time and along both elements, and
// against the exact first touch, which is later.
#include "dynamics/pair_separation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>

#include "support/tier.hpp"

namespace dartcast::test::pair_separation_test {

using detail::MovingPair;
using detail::PairKind;

constexpr PairKind kinds[] = {PairKind::vertex_face, PairKind::edge_edge};

// The distance of two points of the elements, by their weights, which is no smaller than that of the elements.
double sampled_distance(const MovingPair& pair, PairKind kind, double t, double u, double v) {
  std::array<Vec3, 4> p;
  for (std::size_t i = 0; i < 4; ++i) p[i] = pair.from[i] * (1 - t) + pair.to[i] * t;
  if (kind == PairKind::edge_edge) return norm(p[0] * (1 - u) + p[1] * u - p[2] * (1 - v) - p[3] * v);
  if (u + v > 1) return norm(p[0] - p[1] * (u + v - 1) - p[2] * (1 - u) - p[3] * (1 - v));
  return norm(p[0] - p[1] * (1 - u - v) - p[2] * u - p[3] * v);
}

constexpr int samples = 12;

double smallest_sampled(const MovingPair& pair, PairKind kind, double t) {
  double smallest = sampled_distance(pair, kind, t, 0, 0);
  for (int i = 0; i <= samples; ++i) {
    for (int j = 0; j <= samples; ++j) {
      smallest = std::min(smallest, sampled_distance(pair, kind, t, i * (1.0 / samples), j * (1.0 / samples)));
    }
  }
  return smallest;
}

MovingPair random_pair(std::mt19937_64& random) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  MovingPair pair;
  for (std::size_t i = 0; i < 4; ++i) {
    pair.from[i] = {any(random), any(random), any(random)};
    pair.to[i] = pair.from[i] + Vec3{any(random), any(random), any(random)};
  }
  return pair;
}

TEST(PairSeparation, KnownPairs) {
  const Vec3 x{1, 0, 0};
  const Vec3 y{0, 1, 0};
  const Vec3 z{0, 0, 1};
  const MovingPair vertex{{Vec3{0.25, 0.25, 1}, Vec3{}, x, y}, {Vec3{0.25, 0.25, -1}, Vec3{}, x, y}};
  const auto face_time = first_within(vertex, PairKind::vertex_face, 0.25);
  ASSERT_TRUE(face_time);
  EXPECT_NEAR(*face_time, 0.375, 1e-9);

  const MovingPair edges{{z - x, z + x, -y, y}, {-z - x, x - z, -y, y}};
  const auto edge_time = first_within(edges, PairKind::edge_edge, 0.5);
  ASSERT_TRUE(edge_time);
  EXPECT_NEAR(*edge_time, 0.25, 1e-9);

  const MovingPair past{{z + 2 * x, z + 3 * x, -y, y}, {2 * x - z, 3 * x - z, -y, y}};
  EXPECT_FALSE(first_within(past, PairKind::edge_edge, 1.9375));
  EXPECT_TRUE(first_within(past, PairKind::edge_edge, 2.0625));
}

// The corners are so far away that their differences to the vertex lose its last digits: the computed face is at more
// than 1e-4 from it, the true one, z = x, at 8.64e-5.
TEST(PairSeparation, CoversRoundedDifferences) {
  const double far = 0x1p40;
  const Vec3 a{-far, -far, -far};
  const Vec3 b{far, -far, far};
  const Vec3 c{0, far, 0};
  const MovingPair pair{{Vec3{0, 0, 1}, a, b, c}, {Vec3{0, 0, 0x1p-13 + 0x1p-23}, a, b, c}};
  EXPECT_TRUE(first_within(pair, PairKind::vertex_face, 9e-5));
}

TEST(PairSeparation, IsNeverLate) {
  std::mt19937_64 random(5);
  constexpr double separation = 0.15;
  int near = 0;
  int touching = 0;
  for (const PairKind kind : kinds) {
    for (int i = 0; i < scaled(4000, 40000); ++i) {
      const MovingPair pair = random_pair(random);
      const std::string where = "kind " + std::to_string(static_cast<int>(kind)) + ", pair " + std::to_string(i);
      if (smallest_sampled(pair, kind, 0.0) < 2 * separation) continue;  // the rule at the start is another one
      const double first = first_within(pair, kind, separation).value_or(2.0);
      const double touch = detail::first_touch(pair, kind).value_or(2.0);
      ASSERT_LE(first, touch) << where;
      near += first <= 1 ? 1 : 0;
      touching += touch <= 1 ? 1 : 0;
      for (int k = 0; k <= 20; ++k) {
        const double t = k / 20.0;
        if (smallest_sampled(pair, kind, t) <= separation) {
          ASSERT_LE(first, t) << where;
        }
      }
      // At that time some sampled points are near, up to the distance between samples and the time's own bound.
      if (first <= 1) {
        EXPECT_LT(smallest_sampled(pair, kind, first), separation + 0.35) << where;
      }
    }
  }
  EXPECT_GT(near, touching);
  EXPECT_GT(touching, scaled(60, 600));
}

}  // namespace dartcast::test::pair_separation_test
