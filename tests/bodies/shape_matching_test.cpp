#include "bodies/shape_matching.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "base/random.hpp"
#include "dartcast/error.hpp"
#include "support/points.hpp"
#include "support/random_vectors.hpp"
#include "support/tier.hpp"

namespace dartcast::shape_matching_test {

using test::mapped;
using test::random_vector;
using test::scaled;

Mat3 random_turn(Random& random) { return matrix(normalized({random.uniform(-1.0, 1.0), random_vector(random)})); }

std::vector<Vec3> random_points(std::size_t count, Random& random) {
  std::vector<Vec3> points(count);
  for (Vec3& p : points) p = random_vector(random);
  return points;
}

std::vector<double> random_masses(std::size_t count, Random& random) {
  std::vector<double> masses(count);
  for (double& m : masses) m = random.uniform(0.1, 1.0);
  return masses;
}

struct Matched {
  std::vector<Fit> fits;
  std::vector<Vec3> goals;
  double constant = 0.0;
};
Matched matched(const RestShape& shape, std::span<const Vec3> x) {
  Matched m{std::vector<Fit>(shape.cluster_count()), std::vector<Vec3>(shape.size()), 0.0};
  shape.match(x, m.fits);
  m.constant = shape.goals(m.fits, m.goals);
  return m;
}

double energy_at(const RestShape& shape, std::span<const Vec3> x) {
  const Matched m = matched(shape, x);
  return matching_energy(shape, x, m.goals, m.constant);
}

double furthest(std::span<const Vec3> a, std::span<const Vec3> b) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, norm(a[i] - b[i]));
  return most;
}

// Bodies of every rank, in parts or whole: where they have moved as rigid ones, everybody is at its goal.
TEST(ShapeMatching, ReproducesRigidMotions) {
  Random random(1);
  int rounded = 0;  // regions that are nearly flat: inverses
  const int cases = scaled(400, 10'000);
  for (int i = 0; i < cases; ++i) {
    const std::size_t count = 1 + random.below(30);
    std::vector<Vec3> points = random_points(count, random);
    const Mat3 turn = random_turn(random);
    const unsigned rank = random.below(4);
    for (Vec3& p : points) {
      if (rank < 1) p.x = 0.25;
      if (rank < 2) p.y = -0.5;
      if (rank < 3) p.z = 0.125;
      p = turn * p;
    }
    MatchOptions options;
    options.linear = random.below(2) == 0 ? 0.0 : random.uniform();
    options.keep_volume = random.below(2) == 0;
    if (random.below(2) == 0) options.clusters = overlapping_clusters(points, 0.7);
    const RestShape shape(points, random_masses(count, random), options);
    const Mat3 other = random_turn(random);
    const Vec3 shift = random_vector(random, 100.0);
    const auto x = mapped(points, [&](const Vec3& p) { return other * p + shift; });
    const Matched m = matched(shape, x);
    const double off = furthest(m.goals, x);
    ASSERT_LE(off, 1e-10) << "rank " << rank << ", " << count << " points";
    ASSERT_LE(energy_at(shape, x), std::max(1e-23, 30.0 * off * off));
    rounded += off > 2e-13 ? 1 : 0;
  }
  EXPECT_LE(rounded, cases / 500);
}

TEST(ShapeMatching, ReproducesLinearMapsWhereItIsAskedTo) {
  Random random(2);
  for (int i = 0; i < scaled(200, 5'000); ++i) {
    const auto points = random_points(30, random);
    Mat3 map = random_turn(random);
    map = map + Mat3{random_vector(random, 0.4), random_vector(random, 0.4), random_vector(random, 0.4)};
    if (determinant(map) < 0.2) continue;
    const auto x = mapped(points, [&](const Vec3& p) { return map * p; });
    MatchOptions options;
    options.linear = 1.0;
    options.keep_volume = false;
    ASSERT_LE(furthest(matched(RestShape(points, std::vector<double>(30, 1.0), options), x).goals, x), 1e-12);
    options.keep_volume = true;
    const Matched kept = matched(RestShape(points, std::vector<double>(30, 1.0), options), x);
    ASSERT_NEAR(determinant(kept.fits.front().transform), 1.0, 1e-12);
  }
}

// No rotation and shift nearby has less energy, and the force is the energy's derivative: with regions and linear
// parts, too.
TEST(ShapeMatching, ForceIsTheDerivativeOfTheEnergy) {
  Random random(3);
  for (int i = 0; i < scaled(40, 1'000); ++i) {
    const std::size_t count = 12;
    const auto points = random_points(count, random);
    MatchOptions options;
    options.keep_volume = false;
    options.linear = random.below(2) == 0 ? 0.0 : 0.4;
    if (random.below(2) == 0) {
      options.clusters = {{0, 1, 2, 3, 4, 5}, {4, 5, 6, 7, 8}, {0, 7, 8, 9, 10, 11}, {5, 11}};
    }
    const auto masses = random_masses(count, random);
    const RestShape shape(points, masses, options);
    const Mat3 turn = random_turn(random);
    auto x = mapped(points, [&](const Vec3& p) { return turn * p + random_vector(random, 0.1); });
    const Matched m = matched(shape, x);
    ASSERT_TRUE(shape.has_least_fits());
    for (std::size_t p = 0; p < count; ++p) {
      const Vec3 direction = random_vector(random);
      constexpr double h = 1e-4;
      auto before = x;
      auto after = x;
      before[p] -= direction * h;
      after[p] += direction * h;
      const double slope = (energy_at(shape, after) - energy_at(shape, before)) / (2.0 * h);
      ASSERT_NEAR(slope, masses[p] * dot(x[p] - m.goals[p], direction), 1e-6);
    }
    // The fits are those of least energy: with fits of other places the same particles have more.
    const Matched other = matched(shape, mapped(x, [&](const Vec3& p) { return p + random_vector(random, 0.05); }));
    ASSERT_GE(matching_energy(shape, x, other.goals, other.constant), matching_energy(shape, x, m.goals, m.constant));
  }
}

// Forces between the particles of a body are internal ones.
TEST(ShapeMatching, ForcesHaveNoSumAndNoTorque) {
  Random random(4);
  int rounded = 0;  // regions that are nearly flat: inverses
  const int cases = scaled(200, 5'000);
  for (int i = 0; i < cases; ++i) {
    const auto points = random_points(20, random);
    const auto masses = random_masses(20, random);
    MatchOptions options;
    options.linear = random.below(2) == 0 ? 0.0 : random.uniform();
    options.keep_volume = false;
    if (random.below(2) == 0) options.clusters = overlapping_clusters(points, 1.0);
    const RestShape shape(points, masses, options);
    const auto x = mapped(points, [&](const Vec3& p) { return p + random_vector(random, 0.3); });
    const Matched m = matched(shape, x);
    Vec3 sum;
    Vec3 torque;
    for (std::size_t p = 0; p < 20; ++p) {
      sum += (m.goals[p] - x[p]) * masses[p];
      torque += cross(x[p], (m.goals[p] - x[p]) * masses[p]);
    }
    ASSERT_LE(norm(sum), options.linear == 0.0 ? 1e-14 : 1e-13);
    ASSERT_LE(norm(torque), options.linear == 0.0 ? 1e-13 : 1e-8);
    rounded += norm(torque) > 1e-11 ? 1 : 0;
  }
  EXPECT_LE(rounded, cases / 500);
}

TEST(ShapeMatching, GoalOfAPointIsTheMeanOverItsRegions) {
  Random random(5);
  const auto points = random_points(9, random);
  MatchOptions options;
  options.clusters = {{0, 1, 2, 3, 4}, {4, 5, 6, 7, 8}};
  const std::vector<double> masses(9, 2.0);
  const RestShape shape(points, masses, options);
  const auto x = mapped(points, [&](const Vec3& p) { return p + random_vector(random, 0.3); });
  const Matched m = matched(shape, x);
  // Each region by itself; the point that both share has half of its mass in each.
  Vec3 mean;
  for (const auto& cluster : options.clusters) {
    std::vector<Vec3> rest;
    std::vector<Vec3> at;
    std::vector<double> weights;
    std::size_t shared = 0;
    for (const std::uint32_t i : cluster) {
      if (i == 4) shared = rest.size();
      rest.push_back(points[i]);
      at.push_back(x[i]);
      weights.push_back(i == 4 ? 1.0 : 2.0);
    }
    mean += matched(RestShape(rest, weights), at).goals[shared] * 0.5;
  }
  EXPECT_LE(norm(mean - m.goals[4]), 1e-14);
  EXPECT_GT(m.constant, 0.0);
}

TEST(ShapeMatching, ClustersCoverAllPointsAndOverlap) {
  Random random(6);
  const auto points = random_points(500, random);
  const auto clusters = overlapping_clusters(points, 0.5);
  std::vector<int> count(500, 0);
  for (const auto& cluster : clusters) {
    Vec3 low = points[cluster.front()];
    Vec3 high = low;
    for (const std::uint32_t i : cluster) {
      ++count[i];
      low = {std::min(low.x, points[i].x), std::min(low.y, points[i].y), std::min(low.z, points[i].z)};
      high = {std::max(high.x, points[i].x), std::max(high.y, points[i].y), std::max(high.z, points[i].z)};
    }
    EXPECT_LE(std::max({high.x - low.x, high.y - low.y, high.z - low.z}), 0.5);
  }
  EXPECT_EQ(*std::min_element(count.begin(), count.end()), 8);
  EXPECT_EQ(*std::max_element(count.begin(), count.end()), 8);
  EXPECT_THROW(overlapping_clusters(points, 0.0), InvalidArgument);
  EXPECT_THROW(overlapping_clusters(points, 1e-9), InvalidArgument);
  EXPECT_TRUE(overlapping_clusters({}, 1.0).empty());
}

// The goals of an inverted, flat or collapsed body are finite and have its rest shape.
TEST(ShapeMatching, RecoversFromAnyPlaces) {
  Random random(7);
  const auto points = random_points(20, random);
  MatchOptions options;
  options.linear = 0.5;
  const RestShape shape(points, std::vector<double>(20, 1.0), options);
  for (const Vec3& scale : {Vec3{1, 1, -1}, Vec3{1, 1, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 0}, Vec3{-1, -1, -1}}) {
    const auto x = mapped(points, [&](const Vec3& p) { return Vec3{p.x * scale.x, p.y * scale.y, p.z * scale.z}; });
    const Matched m = matched(shape, x);
    for (const Vec3& g : m.goals) ASSERT_TRUE(is_finite(g));
    const Mat3 r = matrix(m.fits.front().rotation);
    EXPECT_NEAR(determinant(r), 1.0, 1e-14);
  }
}

TEST(ShapeMatching, RefusesWhatIsNoShape) {
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}};
  const std::vector<double> masses = {1, 1};
  const auto refused = [&](std::span<const Vec3> p, std::span<const double> m, const MatchOptions& o) {
    EXPECT_THROW(RestShape(p, m, o), InvalidArgument);
  };
  refused({}, {}, {});
  refused(points, std::vector<double>{1.0}, {});
  refused(points, std::vector<double>{1.0, 0.0}, {});
  refused(std::vector<Vec3>{{0, 0, std::numeric_limits<double>::infinity()}, {}}, masses, {});
  MatchOptions o;
  o.linear = 1.5;
  refused(points, masses, o);
  o.linear = 0.0;
  for (const auto& clusters :
       std::vector<std::vector<std::vector<std::uint32_t>>>{{{0, 1}, {}}, {{0, 2}}, {{0, 1, 0}}, {{0}}}) {
    o.clusters = clusters;
    refused(points, masses, o);
  }
}

}  // namespace dartcast::shape_matching_test
