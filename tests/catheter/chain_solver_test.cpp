// The banded solver against a dense one that is put together from the energy's definition.
#include "catheter/chain_solver.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "base/random.hpp"
#include "support/random_vectors.hpp"
#include "support/tier.hpp"

namespace dartcast::chain_solver_test {

using test::random_vector;

struct Case {
  std::vector<Vec3> points, wanted, start, bends;
  std::size_t free;
  ChainWeights weights;
  std::vector<ChainWall> walls;
};

Case random_case(Random& random, std::size_t free) {
  Case c;
  c.free = free;
  c.weights = {1.0, std::pow(10.0, random.uniform(-2, 3)), 0.0, 1e9};
  for (std::size_t i = 0; i < free + 2; ++i) {
    c.points.push_back(Vec3{0, 0, -static_cast<double>(i)} + random_vector(random, 0.2));
    c.bends.push_back(random_vector(random, 0.1));
  }
  for (std::size_t i = 0; i < free; ++i) c.wanted.push_back(c.points[i] + random_vector(random, 0.2));
  for (const Vec3& x : c.points) c.start.push_back(x + random_vector(random, 0.2));
  return c;
}

// Least squares of rows weight (J u + r), in u, densely and in long doubles.
class Dense {
 public:
  explicit Dense(std::size_t free) : n_(3 * free), h_(n_, std::vector<long double>(n_ + 1)) {}

  // stiffness / 2 (sum of coefficients . u + rest)^2
  void add(const std::vector<std::pair<std::size_t, Vec3>>& coefficients, double rest, double stiffness) {
    std::vector<long double> row(n_ + 1);
    for (const auto& [i, v] : coefficients) {
      if (3 * i >= n_) continue;
      row[3 * i] += v.x;
      row[3 * i + 1] += v.y;
      row[3 * i + 2] += v.z;
    }
    row[n_] = -rest;
    for (std::size_t i = 0; i < n_; ++i) {
      if (row[i] == 0.0L) continue;
      for (std::size_t j = 0; j <= n_; ++j) h_[i][j] += stiffness * row[i] * row[j];
    }
  }

  // By elimination: the system is positive definite, and needs no pivots.
  [[nodiscard]] std::vector<Vec3> solved() const {
    std::vector<std::vector<long double>> h = h_;
    for (std::size_t k = 0; k < n_; ++k) {
      for (std::size_t i = k + 1; i < n_; ++i) {
        const long double f = h[i][k] / h[k][k];
        for (std::size_t j = k; j <= n_ && f != 0.0L; ++j) h[i][j] -= f * h[k][j];
      }
    }
    std::vector<double> u(n_);
    for (std::size_t i = n_; i-- > 0;) {
      long double rest = h[i][n_];
      for (std::size_t j = i + 1; j < n_; ++j) rest -= h[i][j] * u[j];
      u[i] = static_cast<double>(rest / h[i][i]);
    }
    std::vector<Vec3> all;
    for (std::size_t i = 0; i < n_; i += 3) all.push_back({u[i], u[i + 1], u[i + 2]});
    return all;
  }

 private:
  std::size_t n_;
  std::vector<std::vector<long double>> h_;  // the last column is the right-hand side
};

Dense dense(const Case& c, double hard) {
  Dense d(c.free);
  const Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const Vec3& e : axes) {
    for (std::size_t i = 0; i < c.free; ++i) d.add({{i, e}}, dot(e, c.points[i] - c.wanted[i]), 1.0);
    for (std::size_t i = 1; i <= c.free; ++i) {
      const Vec3 r = c.points[i - 1] - 2.0 * c.points[i] + c.points[i + 1] - c.bends[i];
      d.add({{i - 1, e}, {i, e * -2.0}, {i + 1, e}}, dot(e, r), c.weights.bending);
    }
  }
  for (std::size_t i = 0; i < c.free; ++i) {
    const Vec3 along = c.points[i] - c.points[i + 1];
    const Vec3 t = along * (1.0 / norm(along));
    d.add({{i, t}, {i + 1, -t}}, norm(along) - c.weights.spacing, hard);
  }
  return d;
}

double hardness_of(const Case& c) { return 1e3 * (1.0 + 16.0 * c.weights.bending); }

std::vector<Vec3> solved(const Case& c, std::vector<ChainWall>& walls) {
  ChainSolver solver;
  std::vector<Vec3> points = c.points;
  solver.solve({points, c.free, c.wanted, c.start, c.bends}, c.weights, walls);
  return points;
}

void expect_same(const Case& c, const std::vector<Vec3>& found, const std::vector<Vec3>& u) {
  for (std::size_t i = 0; i < c.free; ++i) ASSERT_LE(norm(found[i] - c.points[i] - u[i]), 1e-7) << i;
  for (std::size_t i = c.free; i < found.size(); ++i) ASSERT_EQ(found[i], c.points[i]);
}

TEST(ChainSolver, AgreesWithADenseSolver) {
  Random random(11);
  for (int k = 0; k < std::max(3, test::scaled(60, 2000)); ++k) {
    const Case c = random_case(random, 1 + random.below(30));
    std::vector<ChainWall> none;
    expect_same(c, solved(c, none), dense(c, hardness_of(c)).solved());
  }
}

// With walls: those that press hold their points, the others are not passed, and the same system with those alone has
// the same solution.
TEST(ChainSolver, FindsTheWallsThatPress) {
  Random random(12);
  int pressing = 0;
  int idle = 0;
  for (int k = 0; k < std::max(3, test::scaled(100, 2000)); ++k) {
    Case c = random_case(random, 12);
    std::vector<ChainWall> none;
    const std::vector<Vec3> open = solved(c, none);
    std::vector<ChainWall> walls;
    for (std::uint32_t i = 0; i < 12;
         i += random.below(2) == 0 ? 5 : 11) {  // 11: a segment to a point that is not free
      const double weight = random.below(2) == 0 ? 0.0 : random.uniform();
      const Vec3 from = c.points[i] * (1.0 - weight) + c.points[i + 1] * weight;
      const Vec3 moved = open[i] * (1.0 - weight) + open[i + 1] * weight - from;
      // Halfway on its way, or far on the other side of it.
      const double side = random.below(2) == 0 ? -1.0 : 1.0;
      const Vec3 n = moved * (side / norm(moved));
      walls.push_back({i, weight, n, side < 0 ? from + moved * 0.5 : from - n, 0.0, 0});
    }
    const std::vector<Vec3> found = solved(c, walls);
    Dense d = dense(c, hardness_of(c));
    for (const ChainWall& w : walls) {
      const double gap = dot(w.normal, place_on(w, found) - w.point);
      EXPECT_GE(gap, -0.02);
      EXPECT_NEAR(w.pressure, std::max(0.0, -gap * hardness_of(c)), 1e-6 * hardness_of(c));
      (w.pressure > 0.0 ? pressing : idle) += 1;
      if (w.pressure > 0.0)
        d.add({{w.index, w.normal * (1.0 - w.weight)}, {w.index + 1, w.normal * w.weight}},
              dot(w.normal, place_on(w, c.points) - w.point), hardness_of(c));
    }
    expect_same(c, found, d.solved());
  }
  EXPECT_GT(pressing, 0);
  EXPECT_GT(idle, 0);
}

// A point pressed on a wall and drawn along it: friction takes its share, and holds it where it is less than that.
TEST(ChainSolver, FrictionHoldsBack) {
  const auto slip = [](double friction, double along) {
    Case c;
    c.free = 1;
    c.points = {{1.0, 0, 0}, {0, 0, 0}, {-1, 0, 0}};
    c.start = {{1.0, 0, 0}};
    c.wanted = {{1.0, along, -0.5}};
    c.bends.resize(3);
    c.weights = {1.0, 0.0, friction, 1e9};
    std::vector<ChainWall> walls = {{0, 0.0, {0, 0, 1}, {1.0, 0, 0}, 0.0, 0}};
    for (int i = 0; i < 200; ++i) {
      const std::vector<Vec3> points = solved(c, walls);
      c.points = points;
    }
    return c.points[0].y;
  };
  const double open = slip(0.0, 0.3);
  EXPECT_NEAR(open, 0.29, 0.02);
  EXPECT_NEAR(slip(0.2, 0.3), 0.2, 0.02);  // pressed with 0.5: 0.1 is taken
  EXPECT_LE(slip(0.2, 0.05), 2e-3);
  EXPECT_LE(slip(1.0, 0.3), 2e-3);
}

}  // namespace dartcast::chain_solver_test
