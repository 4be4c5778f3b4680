#include "dartcast/predicates.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "base/random.hpp"
#include "support/dyadic.hpp"
#include "support/quadruples.hpp"
#include "support/tier.hpp"

namespace dartcast::test::predicates_test {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

int cases(int quick) { return scaled(quick, 30 * quick); }

Sign true_sign(const Quadruple& q) { return static_cast<Sign>(determinant(q[0], q[1], q[2], q[3]).sign()); }

Sign filtered(const Quadruple& q) { return orient3d(q[0], q[1], q[2], q[3]); }
Sign unfiltered(const Quadruple& q) { return orient3d_exact(q[0], q[1], q[2], q[3]); }
double value(const Quadruple& q) { return orient3d_value(q[0], q[1], q[2], q[3]); }

std::string text(const Quadruple& q) {
  std::string s;
  char buffer[128];
  for (const Vec3& p : q) {
    std::snprintf(buffer, sizeof buffer, "(%a, %a, %a) ", p.x, p.y, p.z);
    s += buffer;
  }
  return s;
}

bool all_in_range(const Quadruple& q) {
  return std::all_of(q.begin(), q.end(), [](const Vec3& p) { return in_exact_range(p); });
}

// The rule for small coordinates, in words of its own.
template <std::size_t N>
std::array<Vec3, N> counted(std::array<Vec3, N> q) {
  for (Vec3& p : q) {
    for (double* x : {&p.x, &p.y, &p.z}) *x = *x > -0x1p-300 && *x < 0x1p-300 ? 0.0 : *x;
  }
  return q;
}

TEST(Orient3d, IsPositiveWhereTheFirstThreeTurnCounterclockwiseSeenFromTheFourth) {
  const Vec3 a{0, 0, 0};
  const Vec3 b{1, 0, 0};
  const Vec3 c{0, 1, 0};
  EXPECT_EQ(orient3d(a, b, c, {0, 0, 1}), Sign::positive);
  EXPECT_EQ(orient3d(a, b, c, {0, 0, -1}), Sign::negative);
  EXPECT_EQ(orient3d(a, b, c, {5, 7, 0}), Sign::zero);
  EXPECT_EQ(orient3d_value(a, b, c, {0, 0, 1}), 1.0);
}

TEST(Orient3d, HasTheExactSignOnEveryKindOfQuadruple) {
  const int n = cases(40'000);
  for (int k = 0; k < quadruple_kinds; ++k) {
    Quadruples quadruples(100 + static_cast<std::uint64_t>(k));
    int zeros = 0;
    for (int i = 0; i < n; ++i) {
      const Quadruple q = quadruples.make(static_cast<QuadrupleKind>(k));
      const Sign truth = true_sign(q);
      zeros += truth == Sign::zero ? 1 : 0;
      ASSERT_EQ(filtered(q), truth) << "kind " << k << ": " << text(q);
      ASSERT_EQ(unfiltered(q), truth) << "kind " << k << ": " << text(q);
    }
    const auto kind = static_cast<QuadrupleKind>(k);
    if (kind == QuadrupleKind::exactly_coplanar || kind == QuadrupleKind::small_lattice) {
      EXPECT_GT(zeros, kind == QuadrupleKind::exactly_coplanar ? n - 1 : n / 100);
    }
  }
}

TEST(Orient3d, HasTheExactSignWhenScaledByPowersOfTwo) {
  Quadruples quadruples(7);
  const int n = cases(40'000);
  for (int i = 0; i < n; ++i) {
    Quadruple q = quadruples.make(static_cast<QuadrupleKind>(quadruples.random().below(quadruple_kinds)));
    const double scale = std::ldexp(1.0, static_cast<int>(quadruples.random().below(590)) - 295);
    for (Vec3& p : q) p *= scale;
    const Sign truth = all_in_range(q) ? true_sign(counted(q)) : Sign::undecidable;
    ASSERT_EQ(unfiltered(q), truth) << text(q);
    ASSERT_EQ(filtered(q), truth) << text(q);
  }
}

// Coordinates of any magnitude in the range, its ends among them, side by side: the worst for overflow and underflow.
TEST(Orient3d, HasTheExactSignOverTheWholeRange) {
  Quadruples quadruples(8);
  const int n = cases(40'000);
  for (int i = 0; i < n; ++i) {
    Quadruple q;
    for (Vec3& p : q) {
      for (double* x : {&p.x, &p.y, &p.z}) {
        const std::uint32_t which = quadruples.random().below(8);
        *x = quadruples.signed_power(-300, 300);
        if (which == 0) *x = std::copysign(largest_magnitude, *x);
        if (which == 1) *x = std::copysign(smallest_magnitude, *x);
        if (which == 2) *x = std::copysign(smallest_magnitude * (1.0 + 0x1p-52), *x);
        if (which == 3) *x = 0.0;
      }
    }
    if (i % 3 == 0) q[3] = q[0];  // exact zeros, and differences that cancel
    if (i % 3 == 1) q[2].x = q[0].x;
    ASSERT_TRUE(all_in_range(q)) << text(q);
    const Sign truth = true_sign(q);
    ASSERT_EQ(unfiltered(q), truth) << text(q);
    ASSERT_EQ(filtered(q), truth) << text(q);
  }
}

TEST(Orient3d, CountsSmallCoordinatesAsZero) {
  Quadruples quadruples(10);
  int zeros = 0;
  const int n = cases(40'000);
  for (int i = 0; i < n; ++i) {
    Quadruple q;
    for (Vec3& p : q) {
      for (double* x : {&p.x, &p.y, &p.z}) {
        const std::uint32_t which = quadruples.random().below(4);
        *x = which == 0   ? quadruples.signed_power(-1074, -300)
             : which == 1 ? quadruples.signed_power(-330, -270)
             : which == 2 ? quadruples.signed_power(-300, -200)
                          : quadruples.signed_power(-3, 3);
      }
    }
    if (i % 4 == 0) q[3] = q[0] + 0x1p-290 * (q[1] - q[0]);
    const Quadruple zeroed = counted(q);
    const Sign truth = true_sign(zeroed);
    zeros += truth == Sign::zero ? 1 : 0;
    ASSERT_EQ(filtered(q), truth) << text(q);
    ASSERT_EQ(unfiltered(q), truth) << text(q);
    // The same determinant but for what is below rounding.
    ASSERT_NEAR(value(q), value(zeroed), 0x1p-48 * std::abs(value(zeroed))) << text(q);
    const std::array<Vec3, 1> opposite = {q[0]};
    const std::array<Vec3, 1> zeroed_opposite = {zeroed[0]};
    ASSERT_EQ(SymbolicPerturbation(q[2], opposite).of_line(q[0], q[1], q[3]),
              SymbolicPerturbation(zeroed[2], zeroed_opposite).of_line(zeroed[0], zeroed[1], zeroed[3]))
        << text(q);
    ASSERT_EQ(orient2d(q[0], q[1], q[2]), orient2d(zeroed[0], zeroed[1], zeroed[2])) << text(q);
    ASSERT_EQ(orient2d_exact(q[0], q[1], q[2]), orient2d(zeroed[0], zeroed[1], zeroed[2])) << text(q);
    ASSERT_EQ(PlanarSymbolicPerturbation(q[2], opposite).of_line(q[3]),
              PlanarSymbolicPerturbation(zeroed[2], zeroed_opposite).of_line(zeroed[3]))
        << text(q);
  }
  EXPECT_GT(zeros, n / 50);
}

// A filter looks at differences alone; it must not say more than exact signs.
TEST(Orient3d, DecidesNothingBeyondTheRange) {
  Quadruples quadruples(11);
  int undecidable = 0;
  const int n = cases(20'000);
  for (int i = 0; i < n; ++i) {
    const double center = quadruples.signed_power(298, 304);
    Quadruple q;
    for (Vec3& p : q) {
      for (double* x : {&p.x, &p.y, &p.z}) *x = quadruples.signed_power(-2, 2);
      double& far = quadruples.random().below(2) == 0 ? p.x : p.z;
      far = center * (1.0 + 0x1p-50 * quadruples.random().below(9));
      if (i % 2 == 0) far = quadruples.signed_power(297, 302);
    }
    const Sign expected = all_in_range(q) ? true_sign(q) : Sign::undecidable;
    undecidable += expected == Sign::undecidable ? 1 : 0;
    ASSERT_EQ(filtered(q), expected) << text(q);
    ASSERT_EQ(unfiltered(q), expected) << text(q);
  }
  EXPECT_GT(undecidable, n / 4);
  EXPECT_LT(undecidable, n - n / 8);
}

TEST(Orient3d, IsRightOrUndecidableForAnyFiniteInput) {
  Quadruples quadruples(9);
  int refused = 0;
  const int n = cases(20'000);
  for (int i = 0; i < n; ++i) {
    Quadruple q;
    const int lowest = i % 2 == 0 ? -1074 : 240;
    const int highest = i % 2 == 0 ? -240 : 1023;
    for (Vec3& p : q)
      p = {quadruples.signed_power(lowest, highest), quadruples.signed_power(lowest, highest),
           quadruples.signed_power(lowest, highest)};
    if (i % 5 == 0) q[3] = q[0] + 2.0 * (q[1] - q[0]);
    if (!is_finite(q[3])) continue;
    const Sign expected = all_in_range(q) ? true_sign(counted(q)) : Sign::undecidable;
    ASSERT_EQ(filtered(q), expected) << text(q);
    ASSERT_EQ(unfiltered(q), expected) << text(q);
    refused += filtered(q) == Sign::undecidable ? 1 : 0;
  }
  EXPECT_GT(refused, n / 10);
}

TEST(Orient3d, RefusesWhatIsOutsideItsRange) {
  const Quadruple good = {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  const std::array<double, 6> bad = {nan, infinity, -infinity, 0x1.0000000000001p+300, -0x1p+303, 1e308};
  for (const double x : bad) {
    for (std::size_t i = 0; i < 4; ++i) {
      for (double Vec3::*coordinate : {&Vec3::x, &Vec3::y, &Vec3::z}) {
        Quadruple q = good;
        q[i].*coordinate = x;
        EXPECT_FALSE(in_exact_range(q[i]));
        EXPECT_EQ(unfiltered(q), Sign::undecidable) << text(q);
        EXPECT_EQ(filtered(q), Sign::undecidable) << text(q);
        EXPECT_TRUE(std::isnan(value(q))) << text(q);
        for (Vec3& p : q) p = {x, x, x};  // all alike: differences are 0, or not a number
        EXPECT_EQ(filtered(q), Sign::undecidable) << text(q);
        EXPECT_TRUE(std::isnan(value(q))) << text(q);
      }
    }
  }
  EXPECT_TRUE(in_exact_range(Vec3{0.0, smallest_magnitude, -largest_magnitude}));
  EXPECT_TRUE(in_exact_range(Vec3{0x1p-1074, 0.0, 0.0}));
  EXPECT_FALSE(in_exact_range(Vec3{0.0, 0x1.0000000000001p+300, 0.0}));
}

// A batch that filters by itself relies on determinant_error and filter_applies alone: this is that filter, written
// out.
TEST(Filter, ItsErrorNeverExceedsItsBound) {
  const int n = cases(40'000);
  double worst = 0.0;
  for (int k = 0; k < quadruple_kinds; ++k) {
    Quadruples quadruples(200 + static_cast<std::uint64_t>(k));
    for (int i = 0; i < n; ++i) {
      Quadruple q = quadruples.make(static_cast<QuadrupleKind>(k));
      const double scale = std::ldexp(1.0, static_cast<int>(quadruples.random().below(600)) - 300);
      if (i % 4 == 0) {
        for (Vec3& p : q) p *= scale;
      }
      const Vec3 u = q[0] - q[3];
      const Vec3 v = q[2] - q[3];
      const Vec3 w = q[1] - q[3];
      const double x = std::max({std::abs(u.x), std::abs(v.x), std::abs(w.x)});
      const double y = std::max({std::abs(u.y), std::abs(v.y), std::abs(w.y)});
      const double z = std::max({std::abs(u.z), std::abs(v.z), std::abs(w.z)});
      const double m = x * y * z;
      if (!bound_holds({x, y, z})) continue;
      const double rounded = dot(u, cross(v, w));
      const Quadruple zeroed = counted(q);
      const Dyadic error = (Dyadic(rounded) - determinant(zeroed[0], zeroed[1], zeroed[2], zeroed[3])).abs();
      ASSERT_FALSE(Dyadic(determinant_error * m) < error) << "kind " << k << ": " << text(q);
      for (const double share : {0.1, 0.05, 0.02}) {
        if (worst < share && Dyadic(share * determinant_error * m) < error) worst = share;
      }
    }
  }
  EXPECT_GE(worst, 0.05) << "the cases are too tame to say anything about the bound";
}

TEST(Filter, NeverDecidesWhatIsNotFinite) {
  for (const double bad : {infinity, 0x1.0000000000001p+247, 0x1p-235, 0.0}) {
    EXPECT_FALSE(filter_applies({bad, 1.0, 1.0})) << bad;
    EXPECT_FALSE(filter_applies({1.0, bad, 1.0})) << bad;
    EXPECT_FALSE(filter_applies({1.0, 1.0, bad})) << bad;
    EXPECT_FALSE(plane_filter_applies(bad, 1.0)) << bad;
    EXPECT_FALSE(plane_filter_applies(1.0, bad)) << bad;
  }
  EXPECT_TRUE(filter_applies({1.0, 0x1p-234, 0x1p+247}));
  EXPECT_TRUE(plane_filter_applies(0x1p-234, 0x1p+247));
}

// Points of a lattice with another unit along each axis, about so many units apart, far from the origin or not: exact
// in doubles, just about, or not.
struct LatticeQuadruple {
  Quadruple q;
  bool nudged;  // one coordinate, by a unit in the last place

  LatticeQuadruple(Quadruples& numbers, int spread) : nudged(numbers.random().below(4) == 0) {
    for (double Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
      const int unit = static_cast<int>(numbers.random().below(200)) - 100;
      const double offset = numbers.random().below(2) == 0 ? 0.0 : numbers.integer(1 << 30);
      for (Vec3& p : q) p.*axis = std::ldexp(offset + numbers.integer(spread), unit);
    }
    double& x = q[numbers.random().below(4)].*(numbers.random().below(2) == 0 ? &Vec3::x : &Vec3::z);
    if (nudged) x = std::nextafter(x, 4.0 * x + 1.0);
  }
};

TEST(RoundsNothing, IsTrueOnlyWhereTheDeterminantIsExact) {
  Quadruples numbers(400);
  int true_at_limit = 0;
  int false_at_limit = 0;
  const int n = cases(100'000);
  for (int i = 0; i < n; ++i) {
    const int bits = 8 + i % 13;  // differences below 2^(bits + 1) units
    const LatticeQuadruple lattice(numbers, 1 << bits);
    const auto& [a, b, c, d] = lattice.q;
    const Vec3 extent = extent_of(a - d, b - d, c - d);
    if (!bound_holds(extent)) continue;
    const bool exact = rounds_nothing(extent, a, b, c, d);
    if (exact) {
      ASSERT_EQ(Dyadic(dot(a - d, cross(c - d, b - d))), determinant(a, b, c, d)) << text(lattice.q);
    }
    if (bits < 15 && !lattice.nudged) {
      ASSERT_TRUE(exact) << text(lattice.q);
    }
    true_at_limit += bits == 16 && exact ? 1 : 0;
    false_at_limit += bits == 16 && !exact && !lattice.nudged ? 1 : 0;
    ASSERT_EQ(filtered(lattice.q), true_sign(lattice.q)) << text(lattice.q);
  }
  EXPECT_GT(true_at_limit, n / 200);
  EXPECT_GT(false_at_limit, n / 200);
}

TEST(RoundsNothing, IsFalseWhereSomethingIsNotFiniteOrOffTheLattice) {
  const Vec3 extent{1, 1, 1};
  EXPECT_TRUE(rounds_nothing(extent, Vec3{0x1p+60, -3, 0.25}, Vec3{}));
  EXPECT_TRUE(rounds_nothing(extent, Vec3{1.0 - 0x1p-15, 0, 0}));
  EXPECT_FALSE(rounds_nothing(extent, Vec3{1.0 - 0x1p-16, 0, 0}));
  EXPECT_FALSE(rounds_nothing(extent, Vec3{}, Vec3{0, 0, 0x1p-1074}));
  for (const double bad : {nan, infinity, -infinity}) EXPECT_FALSE(rounds_nothing(extent, Vec3{0, bad, 0}));
}

// Where all twelve coordinates are at the limit, every bit of the double is used: one more, and it would round.
TEST(RoundsNothing, HoldsForTheLargestDeterminantOfALattice) {
  for (const double n : {0x1p+15 - 1.0, 0x1p+16 - 1.0, 0x1p+17 - 1.0, 0x1p+18 - 1.0}) {
    const Quadruple q = {Vec3{n, -n, n}, Vec3{n, n, -n}, Vec3{-n, n, n}, Vec3{0, 0, 0}};
    const Vec3 extent{n, n, n};
    const Dyadic rounded(dot(q[0], cross(q[2], q[1])));
    EXPECT_EQ(rounds_nothing(extent, q[0], q[1], q[2], q[3]), n < 0x1p+16);
    EXPECT_EQ(rounded == determinant(q[0], q[1], q[2], q[3]), n < 0x1p+17) << n;
  }
}

TEST(Orient3dValue, IsNearTheTrueValueAndOfItsSign) {
  const int n = cases(40'000);
  for (int k = 0; k < quadruple_kinds; ++k) {
    Quadruples quadruples(300 + static_cast<std::uint64_t>(k));
    for (int i = 0; i < n; ++i) {
      const Quadruple q = quadruples.make(static_cast<QuadrupleKind>(k));
      const Dyadic truth = determinant(q[0], q[1], q[2], q[3]);
      const double v = value(q);
      ASSERT_EQ((v > 0.0) - (v < 0.0), truth.sign()) << text(q);
      const Dyadic error = (Dyadic(v) - truth).abs();
      ASSERT_FALSE(Dyadic(0x1p-49) * truth.abs() < error) << "kind " << k << ": " << text(q);
    }
  }
}

// Only one of the differences to the last point is rounded: b and c are next to d, a is far from them and close to
// their plane.
TEST(Orient3dValue, IsNearTheTrueValueWhereOneDifferenceIsRounded) {
  Random random(310);
  const auto any = [&](double low, double high) {
    return Vec3{random.uniform(low, high), random.uniform(low, high), random.uniform(low, high)};
  };
  for (int i = 0; i < cases(3'000); ++i) {
    const Vec3 d = any(0x1p-20, 0x1.8p-20);
    const std::array<Vec3, 2> near = {any(0x1p-20, 0x1.8p-20), any(0x1p-20, 0x1.8p-20)};
    const Vec3 far = d + (near[0] - d) * random.uniform(0x1p+18, 0x1p+19) +
                     (near[1] - d) * random.uniform(0x1p+18, 0x1p+19) + any(-1, 1) * std::exp2(random.uniform(-30, -8));
    for (std::size_t place = 0; place < 3; ++place) {
      Quadruple q = {near[0], near[0], near[1], d};
      if (place == 2) q[1] = near[1];
      q[place] = far;
      const Dyadic truth = determinant(q[0], q[1], q[2], q[3]);
      const Dyadic error = (Dyadic(value(q)) - truth).abs();
      ASSERT_FALSE(Dyadic(0x1p-49) * truth.abs() < error) << text(q);
    }
  }
}

using Triple = std::array<Vec3, 3>;

Dyadic plane_determinant(const Triple& t) {
  const auto x = [&](int i) { return Dyadic(t[static_cast<std::size_t>(i)].x) - Dyadic(t[2].x); };
  const auto y = [&](int i) { return Dyadic(t[static_cast<std::size_t>(i)].y) - Dyadic(t[2].y); };
  return x(0) * y(1) - y(0) * x(1);
}

// Plain ones, points of a lattice, points on a line or next to it, and all of these with one axis far longer than the
// other.
Triple make_triple(Random& random) {
  Triple t;
  for (Vec3& p : t) p = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-9, 9)};
  const std::uint32_t kind = random.below(4);
  const auto lattice = [&] { return static_cast<double>(random.below(9)) - 4.0; };
  if (kind == 1) {
    for (Vec3& p : t) p = {lattice(), lattice(), lattice()};
  }
  if (kind > 1) {
    const double s = kind == 2 ? lattice() : random.uniform(-2, 2);
    if (kind == 2) t[1] = {lattice(), lattice(), 0};
    if (kind == 2) t[0] = {lattice(), lattice(), 0};
    t[2] = t[0] + (t[1] - t[0]) * s;
    if (random.below(2) == 0) t[2].x = std::nextafter(t[2].x, 100.0 * lattice());
  }
  const int k = static_cast<int>(random.below(40)) - 20;
  for (Vec3& p : t) p.y = std::ldexp(p.y, k);
  return t;
}

TEST(Orient2d, HasTheExactSign) {
  Random random(17);
  int zeros = 0;
  const int n = cases(100'000);
  for (int i = 0; i < n; ++i) {
    Triple t = make_triple(random);
    const double scale = std::ldexp(1.0, static_cast<int>(random.below(520)) - 260);
    for (Vec3& p : t) p *= scale;
    const auto truth = static_cast<Sign>(plane_determinant(counted(t)).sign());
    zeros += truth == Sign::zero ? 1 : 0;
    std::uint64_t exact = 0;
    ASSERT_EQ(orient2d(t[0], t[1], t[2], exact), truth) << i;
    ASSERT_EQ(orient2d_exact(t[0], t[1], t[2]), truth) << i;
    ASSERT_LE(exact, 1U);
    const double value = orient2d_value(t[0], t[1], t[2]);
    ASSERT_EQ(value > 0.0 ? Sign::positive : value < 0.0 ? Sign::negative : Sign::zero, truth) << i;
  }
  EXPECT_GT(zeros, n / 20);
  EXPECT_LT(zeros, n / 2);
}

TEST(Orient2d, TurnsCounterclockwiseAndSaysWhatItCannotDecide) {
  EXPECT_EQ(orient2d({0, 0, 5}, {1, 0, -3}, {0, 1, 8}), Sign::positive);
  EXPECT_EQ(orient2d_value({0, 0, 5}, {1, 0, -3}, {0, 1, 8}), 1.0);
  EXPECT_EQ(orient2d({0, 0, 0}, {1, nan, 0}, {0, 1, 0}), Sign::undecidable);
  EXPECT_EQ(orient2d({0, 0, 0}, {infinity, 0, 0}, {0, 1, 0}), Sign::undecidable);
  EXPECT_EQ(orient2d({0, 0, 0}, {0x1p+301, 0, 0}, {0, 1, 0}), Sign::undecidable);
  EXPECT_EQ(orient2d_exact({0, 0, 0}, {0x1p+301, 0, 0}, {0, 1, 0}), Sign::undecidable);
  EXPECT_TRUE(std::isnan(orient2d_value({0, 0, 0}, {nan, 0, 0}, {0, 1, 0})));
  EXPECT_EQ(orient2d({0, 0, nan}, {1, 0, 0}, {0, 1, infinity}), Sign::positive) << "z is not read";
}

}  // namespace dartcast::test::predicates_test
