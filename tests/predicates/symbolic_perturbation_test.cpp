// The shift against the same sign with a small true shift, 2^-400 instead of an infinitesimal: points here are
// multiples of 2^-70 of magnitude below 2^25, so that no term of a higher order can outweigh one of a lower order.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <vector>

#include "dartcast/predicates.hpp"
#include "support/dyadic.hpp"
#include "support/quadruples.hpp"
#include "support/tier.hpp"

namespace dartcast::test::shift_test {

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

Sign shifted_line(const Vec3& a, const Vec3& b, const Vec3& p, const Vec3& q, const std::vector<Vec3>& opposite,
                  int bits = shift_bits) {
  const Exact3<Dyadic> shift = small_shift(p, opposite, bits);
  const auto shifted = [&](const Vec3& x) {
    const Exact3<Dyadic> at = exact(x);
    return Exact3<Dyadic>{at[0] + shift[0], at[1] + shift[1], at[2] + shift[2]};
  };
  return static_cast<Sign>(determinant(exact(a), exact(b), shifted(p), shifted(q)).sign());
}

// Few integers, so that w, n.w and single coordinates of n vanish often; or many, so that products have many digits.
struct Sizes {
  int largest;
  double scale;
};
constexpr Sizes all_sizes[] = {{1, 1.0}, {2, 0.5}, {4, 1.0}, {1 << 11, 1.0}, {1 << 14, 1.0}, {1 << 20, 0x1p-20}};

TEST(SymbolicPerturbation, OfALineIsTheSignWithASmallTrueShift) {
  Quadruples quadruples(2);
  for (int i = 0; i < 6 * cases; ++i) {
    const Sizes s = all_sizes[i % 6];
    Quadruple t = quadruples.coplanar_integers(s.largest);
    if (i % 5 != 0) t = quadruples.shuffled(t);
    for (Vec3& x : t) x *= s.scale;
    const auto& [a, b, p, q] = t;
    const auto opposite = some_points(quadruples, quadruples.random().below(4), s.largest, s.scale);
    const Sign sign = SymbolicPerturbation(p, opposite).of_line(a, b, q);
    ASSERT_EQ(sign, shifted_line(a, b, p, q, opposite)) << i;
    const bool parallel = cross(b - a, q - p) == Vec3{};
    if (s.largest <= 4) {
      ASSERT_EQ(sign == Sign::zero, parallel) << i;
    }
  }
}

// Beyond the range it may be undecidable.
TEST(SymbolicPerturbation, HoldsOverTheWholeRange) {
  Quadruples quadruples(3);
  int refused = 0;
  for (int i = 0; i < 2 * cases; ++i) {
    const double scale = std::ldexp(1.0, static_cast<int>(quadruples.random().below(1000)) - 500);
    const Quadruple t = quadruples.coplanar_integers(4);
    const auto opposite = some_points(quadruples, 3, 4, 1.0);
    const Sign unscaled = SymbolicPerturbation(t[2], opposite).of_line(t[0], t[1], t[3]);
    Quadruple u = t;
    for (Vec3& x : u) x *= scale;
    std::vector<Vec3> far = opposite;
    for (Vec3& x : far) x *= scale;
    const Sign sign = SymbolicPerturbation(u[2], far).of_line(u[0], u[1], u[3]);
    refused += sign == Sign::undecidable ? 1 : 0;
    const auto in_range = [](const Vec3& x) {
      const auto good = [](double c) {
        return c == 0.0 || (std::abs(c) >= smallest_magnitude && std::abs(c) <= largest_magnitude);
      };
      return good(x.x) && good(x.y) && good(x.z);
    };
    if (std::all_of(u.begin(), u.end(), in_range) && std::all_of(far.begin(), far.end(), in_range))
      ASSERT_EQ(sign, unscaled) << i;
  }
  EXPECT_GT(refused, 0);
}

// Every coordinate at an end of the range: the longest expansions there are.
TEST(SymbolicPerturbation, HoldsWithExtremeCoordinatesSideBySide) {
  Quadruples quadruples(4);
  const auto point = [&] {
    Vec3 p;
    for (double* x : {&p.x, &p.y, &p.z}) {
      const int exponent = quadruples.random().below(2) == 0 ? -300 : 299;
      *x = quadruples.signed_power(exponent, exponent + 1);
    }
    return p;
  };
  for (int i = 0; i < (sanitized() ? 20 : cases); ++i) {
    const Vec3 a = point();
    const Vec3 p = point();
    const Vec3 q = point();
    const std::vector<Vec3> opposite = {point(), point(), point()};
    // The line ab meets pq at p, so that the sign is zero; the first term alone decides.
    const Sign truth = shifted_line(a, p, p, q, opposite, 8000);
    ASSERT_EQ(SymbolicPerturbation(p, opposite).of_line(a, p, q), truth) << i;
  }
}

TEST(SymbolicPerturbation, RefusesWhatIsNotFinite) {
  const Vec3 a{0, 0, 0};
  const Vec3 b{1, 0, 0};
  const Vec3 c{0, 1, 0};
  for (const double x : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (const Vec3 bad : {Vec3{x, 0, 0}, Vec3{0, x, 0}, Vec3{0, 0, x}}) {
      EXPECT_EQ(SymbolicPerturbation(bad, {}).of_line(a, b, c), Sign::undecidable);
      EXPECT_EQ(SymbolicPerturbation(c, std::array{bad}).of_line(a, b, a), Sign::undecidable);
      EXPECT_EQ(SymbolicPerturbation(c, {}).of_line(bad, b, a), Sign::undecidable);
      EXPECT_EQ(SymbolicPerturbation(c, {}).of_line(a, bad, b), Sign::undecidable);
      EXPECT_EQ(SymbolicPerturbation(c, {}).of_line(a, b, bad), Sign::undecidable);
    }
  }
}

TEST(SymbolicPerturbation, IsUndecidableOrRightOutsideTheRange) {
  Quadruples quadruples(5);
  const auto point = [&] {
    Vec3 p;
    for (double* x : {&p.x, &p.y, &p.z}) {
      const unsigned kind = quadruples.random().below(20);
      const int exponent = kind == 0 ? -305 : kind == 1 ? 300 : 0;
      *x = quadruples.signed_power(exponent, exponent + 1);
    }
    return p;
  };
  int decided = 0;
  for (int i = 0; i < (sanitized() ? 20 : cases); ++i) {
    const Vec3 a = point();
    const Vec3 p = point();
    const Vec3 q = point();
    const std::vector<Vec3> opposite = {point(), point(), point()};
    const Sign sign = SymbolicPerturbation(p, opposite).of_line(a, p, q);
    if (sign == Sign::undecidable) continue;
    ++decided;
    ASSERT_EQ(sign, shifted_line(a, p, p, q, opposite, 9000)) << i;
  }
  EXPECT_GT(decided, 0);
}

// In the plane: p + e w + (e^2, e^3), and c anywhere on the line through p and q.
TEST(PlanarSymbolicPerturbation, OfALineIsTheSignWithASmallTrueShift) {
  Quadruples quadruples(5);
  int zero_along = 0;
  for (int i = 0; i < 6 * cases; ++i) {
    const Sizes s = all_sizes[i % 6];
    const auto points = some_points(quadruples, 2, s.largest, s.scale);
    const Vec3& p = points[0];
    const Vec3& q = points[1];
    const auto opposite = some_points(quadruples, quadruples.random().below(3), s.largest, s.scale);
    const Vec3 c = p + (q - p) * (quadruples.random().below(5) - 2.0);
    const Dyadic e = Dyadic::power_of_two(-shift_bits);
    Dyadic x = e * e;
    Dyadic y = e * e * e;
    Dyadic along;
    for (const Vec3& o : opposite) {
      const Dyadic wx = Dyadic(o.x) - Dyadic(p.x);
      const Dyadic wy = Dyadic(o.y) - Dyadic(p.y);
      x = x + e * wx;
      y = y + e * wy;
      along = along + wx * (Dyadic(q.y) - Dyadic(p.y)) - wy * (Dyadic(q.x) - Dyadic(p.x));
    }
    const auto from_c = [&](const Vec3& v) {
      return std::pair{Dyadic(v.x) + x - Dyadic(c.x), Dyadic(v.y) + y - Dyadic(c.y)};
    };
    const auto [px, py] = from_c(p);
    const auto [qx, qy] = from_c(q);
    ASSERT_EQ(PlanarSymbolicPerturbation(p, opposite).of_line(q), static_cast<Sign>((px * qy - py * qx).sign())) << i;
    zero_along += along.sign() == 0 && q != p ? 1 : 0;
  }
  EXPECT_GT(zero_along, cases) << "the further terms decide";
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(PlanarSymbolicPerturbation({0, 0, 0}, {}).of_line({1, nan, 0}), Sign::undecidable);
}

}  // namespace dartcast::test::shift_test
