#include "bodies/rotation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/random.hpp"
#include "support/tier.hpp"

namespace dartcast::rotation_test {

using test::scaled;

Eigen::Matrix3d eigen(const Mat3& m) {
  Eigen::Matrix3d e;
  e << m.x.x, m.y.x, m.z.x, m.x.y, m.y.y, m.z.y, m.x.z, m.y.z, m.z.z;
  return e;
}

Mat3 random_matrix(Random& random) {
  const auto u = [&] { return random.uniform(-1.0, 1.0); };
  return {{u(), u(), u()}, {u(), u(), u()}, {u(), u(), u()}};
}

Quaternion random_rotation(Random& random) {
  const auto u = [&] { return random.uniform(-1.0, 1.0); };
  return normalized({u(), {u(), u(), u()}});
}

// U diag(s) V^T.
Mat3 with_singular_values(const Vec3& s, Random& random) {
  const Mat3 u = matrix(random_rotation(random));
  const Mat3 v = matrix(random_rotation(random));
  return outer(u.x * s.x, v.x) + outer(u.y * s.y, v.y) + outer(u.z * s.z, v.z);
}

// A rotation, and no rotation has a greater trace(R^T A): the singular values say what the greatest is.
void expect_nearest(const Mat3& a, const Rotation& r) {
  const Eigen::Matrix3d m = eigen(matrix(r.q));
  ASSERT_LE((m.transpose() * m - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  ASSERT_GT(m.determinant(), 0.0);
  const Eigen::Matrix3d e = eigen(a);
  const Eigen::Vector3d s = Eigen::JacobiSVD<Eigen::Matrix3d>(e).singularValues();
  const double greatest = s[0] + s[1] + (e.determinant() < 0.0 ? -s[2] : s[2]);
  // Where det A is but rounding, its sign is open, and so is that of the last term.
  const double open = std::abs(e.determinant()) < 1e-14 * s[0] * s[0] * s[0] ? 2.0 * s[2] : 0.0;
  ASSERT_NEAR((m.transpose() * e).trace(), greatest, 1e-14 * s[0] + open);
}

// The nearest rotation is unique, and well defined, where the least two singular values (the least with the sign of the
// determinant) have a sum that is not small: then it is Eigen's.
void expect_that_of_eigen(const Mat3& a, const Rotation& r) {
  const Eigen::Matrix3d e = eigen(a);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(e, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  const bool reflects = (u * svd.matrixV().transpose()).determinant() < 0.0;
  if (reflects) u.col(2) = -u.col(2);
  const Eigen::Vector3d s = svd.singularValues();
  const double gap = s[1] + (reflects ? -s[2] : s[2]);
  ASSERT_LE((u * svd.matrixV().transpose() - eigen(matrix(r.q))).norm() * gap, 1e-14 * s[0]);
}

TEST(Rotation, IsThatOfEigensSvdFromAnyGuess) {
  Random random(1);
  std::uint64_t fallbacks = 0;
  const auto count = scaled(20'000, 1'000'000);
  for (int i = 0; i < count; ++i) {
    const Mat3 a = random_matrix(random);
    const Rotation r = nearest_rotation(a, random_rotation(random));
    fallbacks += r.fallback ? 1 : 0;
    expect_nearest(a, r);
    expect_that_of_eigen(a, r);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(fallbacks, 0U);
}

// From one step of a simulation to the next the guess is near: no fallback.
TEST(Rotation, FollowsANearGuessWithoutAFallback) {
  Random random(2);
  for (int i = 0; i < scaled(20'000, 500'000); ++i) {
    const Vec3 s = {random.uniform(0.5, 1.0), random.uniform(0.3, 1.0), random.uniform(-0.2, 1.0)};
    const Mat3 a = with_singular_values(s, random);
    const Quaternion exact = nearest_rotation(a, {}).q;
    const Vec3 axis = matrix(random_rotation(random)).x * (0.5 * std::tan(0.25 * random.uniform()));
    const Rotation r = nearest_rotation(a, normalized(exact * Quaternion{1.0, axis}));
    ASSERT_FALSE(r.fallback && s.y + s.z > 0.05) << s.x << " " << s.y << " " << s.z;
    expect_nearest(a, r);
    if (HasFatalFailure()) return;
  }
}

TEST(Rotation, OfFlatNearlySingularAndInvertedMatrices) {
  Random random(3);
  for (int i = 0; i < scaled(20'000, 500'000); ++i) {
    const double small = std::ldexp(1.0, -static_cast<int>(random.below(60)));
    const Vec3 cases[] = {{1, 0.5, 0},  {1, 0.5, small},       {1, 0.5, -small},
                          {1, 1, -0.5}, {1, small, small / 2}, {1, 1, -1}};
    const Mat3 a = with_singular_values(cases[random.below(6)], random);
    const Rotation r = nearest_rotation(a, random_rotation(random));
    expect_nearest(a, r);
    expect_that_of_eigen(a, r);
    if (HasFatalFailure()) return;
  }
}

TEST(Rotation, OfRankOneAndZero) {
  Random random(4);
  for (int i = 0; i < scaled(1'000, 10'000); ++i) {
    const Mat3 u = matrix(random_rotation(random));
    const Mat3 v = matrix(random_rotation(random));
    const Mat3 line = outer(u.x, v.x);
    const Rotation r = nearest_rotation(line, random_rotation(random));
    expect_nearest(line, r);
    ASSERT_LE(norm(matrix(r.q) * v.x - u.x), 1e-14);
    const Quaternion start = random_rotation(random);
    ASSERT_EQ(nearest_rotation(zero_matrix(), start).q, start);
  }
  const Mat3 axis = outer({1, 0, 0}, {1, 0, 0});  // exactly of rank 1
  expect_nearest(axis, nearest_rotation(axis, {}));
}

// The guess is half a turn away: the derivative vanishes there, too.
TEST(Rotation, FromHalfATurnAway) {
  for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    const Mat3 a = {{3, 0, 0}, {0, 2, 0}, {0, 0, 1}};
    const Rotation r = nearest_rotation(a, {0.0, axis});
    EXPECT_TRUE(r.fallback);
    EXPECT_LE(norm(r.q.v), 1e-15);
    expect_nearest(matrix({0.0, axis}), nearest_rotation(matrix({0.0, axis}), {}));
  }
}

// Any scale gives the same rotation, powers of two the same bits.
TEST(Rotation, DoesNotDependOnTheScale) {
  Random random(5);
  for (int i = 0; i < scaled(1'000, 10'000); ++i) {
    const Mat3 a = with_singular_values({1, 0.8, 0.5}, random);
    const Rotation r = nearest_rotation(a, {});
    for (const int e : {-1000, -500, -140, 140, 500, 1000}) {
      const Mat3 b = a * std::ldexp(1.0, e);
      const Rotation s = nearest_rotation(b, {});
      ASSERT_LE(std::min(norm(s.q.v - r.q.v), norm(s.q.v + r.q.v)), 1e-14) << e;
    }
  }
}

TEST(Rotation, QuaternionsMultiplyAsTheirMatrices) {
  Random random(6);
  for (int i = 0; i < 1000; ++i) {
    const Quaternion p = random_rotation(random);
    const Quaternion q = random_rotation(random);
    const Mat3 product = matrix(p * q);
    const Mat3 other = matrix(p) * matrix(q);
    ASSERT_LE(norm(product.x - other.x) + norm(product.y - other.y) + norm(product.z - other.z), 1e-14);
    ASSERT_NEAR(determinant(product), 1.0, 1e-14);
  }
}

}  // namespace dartcast::rotation_test
