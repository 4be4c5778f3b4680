// The shift against the same sign with a small true shift, 2^-400 instead of an infinitesimal: points here are
// multiples of 2^-70 of magnitude below 2^25, so that no term of a higher order can outweigh one of a lower order.
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <vector>

#include "dartcast/exact/predicates.hpp"
#include "exact/dyadic.hpp"
#include "exact/quadruples.hpp"

namespace dartcast::test {
namespace {

constexpr int shift_bits = 400;
constexpr int cases = 3000;

std::vector<Vec3> some_points(Quadruples& quadruples, std::uint32_t count, int largest, double scale) {
  std::vector<Vec3> points;
  for (std::uint32_t i = 0; i < count; ++i) {
    points.push_back(Vec3{quadruples.integer(largest), quadruples.integer(largest), quadruples.integer(largest)} *
                     scale);
  }
  return points;
}

Sign shifted_plane(const Quadruple& t, const Vec3& p, const std::vector<Vec3>& opposite) {
  const DyadicVec3 q = DyadicVec3(t[3]) + small_shift(p, opposite, shift_bits);
  return static_cast<Sign>(determinant(DyadicVec3(t[0]), DyadicVec3(t[1]), DyadicVec3(t[2]), q).sign());
}

Sign shifted_line(const Vec3& a, const Vec3& b, const Vec3& p, const Vec3& q, const std::vector<Vec3>& opposite) {
  const DyadicVec3 s = small_shift(p, opposite, shift_bits);
  return static_cast<Sign>(determinant(DyadicVec3(a), DyadicVec3(b), DyadicVec3(p) + s, DyadicVec3(q) + s).sign());
}

// Few integers, so that w, n.w and single coordinates of n vanish often; or many, so that products have many digits.
struct Sizes {
  int largest;
  double scale;
};
constexpr Sizes all_sizes[] = {{1, 1.0}, {2, 0.5}, {4, 1.0}, {1 << 20, 0x1p-20}};

TEST(Shift, OfAPlaneIsTheSignWithASmallTrueShift) {
  Quadruples quadruples(1);
  int zeros_along_w = 0;
  for (int i = 0; i < 4 * cases; ++i) {
    const Sizes s = all_sizes[i % 4];
    Quadruple t = quadruples.coplanar_integers(s.largest);
    for (Vec3& x : t) x *= s.scale;
    ASSERT_EQ(orient3d(t[0], t[1], t[2], t[3]), Sign::zero);
    const Vec3 p = i % 3 == 0 ? t[3] : some_points(quadruples, 1, s.largest, s.scale)[0];
    const auto opposite = some_points(quadruples, quadruples.random().below(4), s.largest, s.scale);
    const Sign sign = Shift(p, opposite).of_plane(t[0], t[1], t[2]);
    ASSERT_EQ(sign, shifted_plane(t, p, opposite)) << i;
    const bool collinear = cross(t[1] - t[0], t[2] - t[0]) == Vec3{};  // exact: few digits
    if (s.largest <= 4) {
      ASSERT_EQ(sign == Sign::zero, collinear) << i;
    }
    zeros_along_w += Shift(p, {}).of_plane(t[0], t[1], t[2]) == sign ? 1 : 0;
  }
  EXPECT_GT(zeros_along_w, cases);
}

TEST(Shift, OfALineIsTheSignWithASmallTrueShift) {
  Quadruples quadruples(2);
  for (int i = 0; i < 4 * cases; ++i) {
    const Sizes s = all_sizes[i % 4];
    Quadruple t = quadruples.coplanar_integers(s.largest);
    if (i % 5 != 0) t = quadruples.shuffled(t);
    for (Vec3& x : t) x *= s.scale;
    const auto& [a, b, p, q] = t;
    const auto opposite = some_points(quadruples, quadruples.random().below(4), s.largest, s.scale);
    const Sign sign = Shift(p, opposite).of_line(a, b, p, q);
    ASSERT_EQ(sign, shifted_line(a, b, p, q, opposite)) << i;
    const bool parallel = cross(b - a, q - p) == Vec3{};
    if (s.largest <= 4) {
      ASSERT_EQ(sign == Sign::zero, parallel) << i;
    }
  }
}

TEST(Shift, HoldsOverTheWholeRange) {
  Quadruples quadruples(3);
  for (int i = 0; i < cases; ++i) {
    const double scale = std::ldexp(1.0, static_cast<int>(quadruples.random().below(590)) - 295);
    const Quadruple t = quadruples.coplanar_integers(4);
    const auto opposite = some_points(quadruples, 3, 4, 1.0);
    const Sign unscaled = Shift(t[3], opposite).of_plane(t[0], t[1], t[2]);
    const Sign unscaled_line = Shift(t[2], opposite).of_line(t[0], t[1], t[2], t[3]);
    Quadruple u = t;
    for (Vec3& x : u) x *= scale;
    std::vector<Vec3> far = opposite;
    for (Vec3& x : far) x *= scale;
    ASSERT_EQ(Shift(u[3], far).of_plane(u[0], u[1], u[2]), unscaled) << i;
    ASSERT_EQ(Shift(u[2], far).of_line(u[0], u[1], u[2], u[3]), unscaled_line) << i;
  }
}

// Every coordinate at an end of the range: the longest expansions there are.
TEST(Shift, HoldsWithExtremeCoordinatesSideBySide) {
  Quadruples quadruples(4);
  const auto point = [&] {
    Vec3 p;
    for (double* x : {&p.x, &p.y, &p.z}) {
      const int exponent = quadruples.random().below(2) == 0 ? -300 : 299;
      *x = quadruples.signed_power(exponent, exponent + 1);
    }
    return p;
  };
  for (int i = 0; i < cases; ++i) {
    const Vec3 a = point();
    const Vec3 b = point();
    const Vec3 c = point();
    const std::vector<Vec3> opposite = {point(), point(), point()};
    // The first term alone decides; a is a point of the plane.
    const DyadicVec3 q = DyadicVec3(a) + small_shift(a, opposite, 8000);
    const int truth = determinant(DyadicVec3(a), DyadicVec3(b), DyadicVec3(c), q).sign();
    ASSERT_EQ(static_cast<int>(Shift(a, opposite).of_plane(a, b, c)), truth) << i;
  }
}

TEST(Shift, LeadsInsideFromEveryPlaceOfASimplex) {
  const Quadruple simplex = {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  // p is the mean of the corners in the mask; it lies on the facets opposite to all others.
  for (unsigned mask = 1; mask < 16; ++mask) {
    if ((mask & (mask - 1)) != 0 && mask != 3 && mask != 5 && mask != 9 && mask != 15)
      continue;  // means exact in doubles
    Vec3 sum;
    double corners = 0.0;
    std::vector<Vec3> opposite;
    for (std::size_t i = 0; i < 4; ++i) {
      if ((mask >> i & 1U) != 0) {
        sum += simplex[i];
        corners += 1.0;
      } else {
        opposite.push_back(simplex[i]);
      }
    }
    const Vec3 p = sum * (1.0 / corners);
    const Shift shift(p, opposite);
    for (std::size_t i = 0; i < 4; ++i) {
      if ((mask >> i & 1U) != 0) continue;
      Quadruple facet = simplex;  // with the opposite corner last
      std::swap(facet[i], facet[3]);
      EXPECT_EQ(shift.of_plane(facet[0], facet[1], facet[2]), orient3d(facet[0], facet[1], facet[2], facet[3])) << mask;
    }
  }
}

TEST(Shift, RefusesWhatIsOutsideTheRange) {
  const Vec3 a{0, 0, 0};
  const Vec3 b{1, 0, 0};
  const Vec3 c{0, 1, 0};
  for (const double x :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 0x1p-301, 0x1p+301}) {
    const Vec3 bad{0, 0, x};
    EXPECT_EQ(Shift(bad, {}).of_plane(a, b, c), Sign::undecidable);
    EXPECT_EQ(Shift(a, std::array{bad}).of_plane(a, b, c), Sign::undecidable);
    EXPECT_EQ(Shift(a, {}).of_plane(a, b, bad), Sign::undecidable);
    EXPECT_EQ(Shift(a, {}).of_line(a, b, bad, c), Sign::undecidable);
    EXPECT_EQ(Shift(a, {}).of_line(a, b, c, bad), Sign::undecidable);
    EXPECT_EQ(Shift(bad, {}).of_line(a, b, a, c), Sign::undecidable);
  }
}

}  // namespace
}  // namespace dartcast::test
