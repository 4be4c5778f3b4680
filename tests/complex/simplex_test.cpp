// The four determinants of a simplex, against rational numbers.
#include "complex/simplex.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "base/random.hpp"
#include "support/dyadic.hpp"

namespace dartcast::simplex_test {

using test::determinant;
using test::Dyadic;

// Random simplices, from fat ones to exactly flat ones and slivers a rounding apart; a point in, on or near them.
class Sample {
 public:
  explicit Sample(std::uint64_t seed) : random_(seed) {
    const double shift = random_.below(3) == 0 ? std::ldexp(1.0, static_cast<int>(random_.below(30))) : 0.0;
    const double grid = random_.below(3) == 0 ? 8.0 : 0x1p+40;
    for (Vec3& p : v) p = point(shift, grid);
    switch (random_.below(4)) {
      case 0: v[3] = mix(v[0], v[1], v[2]); break;  // as good as flat
      case 1: v[2] = mix(v[0], v[1], v[1]); break;
      default: break;
    }
    switch (random_.below(4)) {
      case 0: x = point(shift, grid); break;
      case 1: x = mix(v[0], v[1], v[2]); break;
      case 2: x = v[random_.below(4)]; break;
      default: x = mix(mix(v[0], v[1], v[2]), v[3], v[0]); break;
    }
  }

  Corners v;
  Vec3 x;

 private:
  Vec3 point(double shift, double grid) {
    const auto c = [&] { return shift + std::floor(random_.uniform() * grid) / grid; };
    return {c(), c(), c()};
  }
  Vec3 mix(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double s = random_.uniform();
    const double t = random_.uniform() * (1.0 - s);
    return a * s + b * t + c * (1.0 - s - t);
  }
  Random random_;
};

TEST(Determinants, SignsAndProofsAgreeWithDyadics) {
  int undecided = 0, on_lattice = 0, proved = 0, not_positive = 0;
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    const Sample s(seed);
    const Determinants d(s.v, s.x);
    Dyadic sum;
    std::uint64_t exact = 0;
    unsigned negative = 0, zero = 0;
    for (unsigned i = 0; i < 4; ++i) {
      Corners replaced = s.v;
      replaced[i] = s.x;
      const Dyadic truth = determinant(replaced[0], replaced[1], replaced[2], replaced[3]);
      sum += truth;
      negative |= truth < 0 ? 1U << i : 0U;
      zero |= truth == 0 ? 1U << i : 0U;
      const std::uint64_t before = exact;
      EXPECT_EQ(static_cast<int>(sign_of(d, i, s.v, s.x, exact)), truth.sign()) << "seed " << seed << ", det " << i;
      EXPECT_EQ(static_cast<int>(orient_facet(s.v, i, s.x)), truth.sign());
      EXPECT_EQ(exact - before, d.decides(i) ? 0U : 1U);
      if (d.exact(s.v, s.x)) EXPECT_EQ(Dyadic(d.value[i]), truth) << "seed " << seed << ", det " << i;
      if (std::isfinite(d.bound))
        EXPECT_LE((Dyadic(d.value[i]) - truth).abs(), Dyadic(d.bound)) << "seed " << seed << ", det " << i;
    }
    for (unsigned asked = 0; asked < 16; ++asked) {
      std::uint64_t left = 0;
      const DeterminantSigns signs = signs_of(d, s.v, s.x, asked, left);
      EXPECT_EQ(signs.negative, negative & asked) << "seed " << seed;
      EXPECT_EQ(signs.zero, zero & asked) << "seed " << seed;
      if (asked == 15) EXPECT_EQ(left, exact);
    }
    undecided += exact > 0 ? 1 : 0;
    on_lattice += exact > 0 && d.exact(s.v, s.x) ? 1 : 0;
    const Dyadic volume = determinant(s.v[0], s.v[1], s.v[2], s.v[3]);
    EXPECT_EQ(sum, volume);
    EXPECT_EQ(static_cast<int>(volume_sign(s.v)), volume.sign());
    if (d.proves_positive()) EXPECT_GT(volume, 0) << "seed " << seed;
    proved += d.proves_positive() ? 1 : 0;
    not_positive += volume <= 0 ? 1 : 0;
  }
  EXPECT_GT(undecided, 100);
  EXPECT_GT(on_lattice, 20);
  EXPECT_GT(undecided - on_lattice, 100);
  EXPECT_GT(proved, 500);
  EXPECT_GT(not_positive, 500);
}

TEST(Determinants, NothingIsProvedWhereSomethingIsNotFinite) {
  const Corners v = {Vec3{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {std::nan(""), infinity, -infinity, 0x1p+400}) {
    for (unsigned i = 0; i < 5; ++i) {
      for (unsigned axis = 0; axis < 3; ++axis) {
        Corners w = v;
        Vec3 x{0.2, 0.3, 0.1};
        Vec3& target = i < 4 ? w[i] : x;
        (axis == 0 ? target.x : axis == 1 ? target.y : target.z) = bad;
        const Determinants d(w, x);
        EXPECT_FALSE(d.proves_positive());
        for (unsigned k = 0; k < 4; ++k) {
          if (k != i) EXPECT_FALSE(d.decides(k));  // det_i does not read corner i
        }
        if (i < 4) EXPECT_EQ(volume_sign(w), Sign::undecidable);
      }
    }
  }
}

// In the plane, with points next to the sides and on them.
TEST(Determinants, SignsInThePlaneAreExact) {
  Random random(23);
  int zeros = 0;
  int open = 0;
  for (int i = 0; i < 20000; ++i) {
    PlaneCorners v;
    for (Vec3& p : v) p = {random.uniform(-1, 1), random.uniform(-1, 1), 0};
    if (i % 3 == 0) {
      for (Vec3& p : v) p = {std::round(4 * p.x), std::round(4 * p.y), 0};
    }
    const double t = i % 3 == 0 ? 0.5 * random.below(5) : random.uniform(-0.5, 1.5);
    Vec3 x = v[0] + (v[1] - v[0]) * t;
    if (i % 5 == 0) x.y += random.uniform(-1, 1);
    const Determinants d(v, x);
    std::uint64_t exact = 0;
    const DeterminantSigns signs = signs_of(d, v, x, 7, exact);
    open += exact > 0 ? 1 : 0;
    for (unsigned f = 0; f < 3; ++f) {
      const auto& [a, b] = plane_facet_corners[f];
      const Sign truth = orient2d_exact(v[a], v[b], x);
      ASSERT_EQ((signs.negative >> f) & 1U, truth == Sign::negative ? 1U : 0U) << i;
      ASSERT_EQ((signs.zero >> f) & 1U, truth == Sign::zero ? 1U : 0U) << i;
      zeros += truth == Sign::zero ? 1 : 0;
    }
    ASSERT_TRUE(!d.proves_positive() || volume_sign(v) == Sign::positive) << i;
    ASSERT_EQ(volume_sign(v), volume_sign(raised({v[0], v[1], v[2], {}}))) << i;
  }
  EXPECT_GT(zeros, 1000);
  EXPECT_GT(open, 5000);
}

TEST(Determinants, OrderOfFacetCorners) {
  const Corners v = {Vec3{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (unsigned i = 0; i < 4; ++i) {
    EXPECT_EQ(orient_facet(v, i, v[i]), Sign::positive);
    EXPECT_EQ(orient_facet(v, i, v[(i + 1) % 4]), Sign::zero);
  }
}

}  // namespace dartcast::simplex_test
