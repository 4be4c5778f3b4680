#include "base/elementary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "base/elementary4.inl"
#include "base/random.hpp"

namespace dartcast::elementary_test {

// The truth: 113 bits where the system has them.
#if defined(__GLIBC__) && defined(__HAVE_FLOAT128) && __HAVE_FLOAT128
using Wide = __float128;
Wide wide_sine(Wide x) { return sinf128(x); }
Wide wide_cosine(Wide x) { return cosf128(x); }
Wide wide_exp(Wide x) { return expf128(x); }
Wide wide_expm1(Wide x) { return expm1f128(x); }
Wide wide_log(Wide x) { return logf128(x); }
Wide wide_pow(Wide x, Wide y) { return powf128(x, y); }
Wide wide_atan2(Wide y, Wide x) { return atan2f128(y, x); }
Wide wide_cbrt(Wide x) { return cbrtf128(x); }
Wide wide_sqrt(Wide x) { return sqrtf128(x); }
const Wide wide_turn = 8 * atan2f128(1, 1);
#else
using Wide = long double;
Wide wide_sine(Wide x) { return std::sin(x); }
Wide wide_cosine(Wide x) { return std::cos(x); }
Wide wide_exp(Wide x) { return std::exp(x); }
Wide wide_expm1(Wide x) { return std::expm1(x); }
Wide wide_log(Wide x) { return std::log(x); }
Wide wide_pow(Wide x, Wide y) { return std::pow(x, y); }
Wide wide_atan2(Wide y, Wide x) { return std::atan2(y, x); }
Wide wide_cbrt(Wide x) { return std::cbrt(x); }
Wide wide_sqrt(Wide x) { return std::sqrt(x); }
const Wide wide_turn = 8 * std::atan2(Wide(1), Wide(1));
#endif

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }

// The distance from the truth in units of the last place of the truth.
double error_in_ulp(double value, Wide truth) {
  const auto nearest = std::abs(static_cast<double>(truth));
  const double ulp = nearest == 0.0 ? std::numeric_limits<double>::denorm_min()
                                    : std::ldexp(1.0, std::max(std::ilogb(nearest) - 52, -1074));
  const Wide off = (static_cast<Wide>(value) - truth) / static_cast<Wide>(ulp);
  return std::abs(static_cast<double>(off));
}

class Worst {
 public:
  void add(double x, double value, Wide truth) {
    const double error = error_in_ulp(value, truth);
    if (!(error <= worst_)) worst_ = error, at_ = x;
  }
  void expect_below(double bound, const char* what) const {
    EXPECT_LT(worst_, bound) << what << " at " << std::hexfloat << at_;
    ::testing::Test::RecordProperty(what, std::to_string(worst_));
  }

 private:
  double worst_ = 0.0, at_ = 0.0;
};

// Numbers of all sizes between two powers of 2, both signs.
std::vector<double> numbers(int low, int high, int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> all;
  for (int i = 0; i < count; ++i) {
    const int e = low + static_cast<int>(random.below(static_cast<std::uint32_t>(high - low)));
    all.push_back(std::ldexp(random.uniform(1.0, 2.0), e) * (random.below(2) == 0 ? 1.0 : -1.0));
  }
  return all;
}

// All multiples of an eighth of a turn in the range of the fast reduction, and the doubles beside them.
std::vector<double> hard_angles() {
  std::vector<double> all;
  for (int k = 1; k < 1400; ++k) {
    const auto x = static_cast<double>(wide_turn * k / 8);
    for (const double y : {x, std::nextafter(x, 0.0), std::nextafter(x, infinity)}) all.push_back(y);
  }
  all.push_back(std::ldexp(6381956970095103.0, 797));  // the double nearest to a multiple of pi / 2
  return all;
}

TEST(Elementary, SineAndCosineAreWithinAUlp) {
  Worst sine, cosine;
  const auto check = [&](const std::vector<double>& all) {
    for (const double x : all) {
      const SineCosine s = sine_cosine(x);
      sine.add(x, s.sine, wide_sine(x));
      cosine.add(x, s.cosine, wide_cosine(x));
      ASSERT_LE(std::abs(s.sine), 1.0);
      ASSERT_LE(std::abs(s.cosine), 1.0);
      const SineCosine mirrored = sine_cosine(-x);
      ASSERT_EQ(bits(mirrored.sine), bits(-s.sine));
      ASSERT_EQ(bits(mirrored.cosine), bits(s.cosine));
    }
  };
  check(numbers(-900, -10, 2000, 1));
  check(numbers(-10, 10, 40000, 2));
  check(numbers(10, 1023, 20000, 3));
  check(hard_angles());
  sine.expect_below(1.0, "sine");
  cosine.expect_below(1.0, "cosine");
}

TEST(Elementary, SineAndCosineOfTurnsAreWithinAUlp) {
  Worst sine, cosine;
  for (const double t : numbers(-60, 60, 60000, 4)) {
    const SineCosine s = sine_cosine_of_turns(t);
    const double quarters = std::round(4.0 * std::fmod(t, 1.0));
    const Wide angle = wide_turn * (std::fmod(t, 1.0) - 0.25 * quarters);  // so that it loses no digits
    const std::array<Wide, 4> sines = {wide_sine(angle), wide_cosine(angle), -wide_sine(angle), -wide_cosine(angle)};
    const auto quadrant = static_cast<std::size_t>(static_cast<int>(quarters) + 8);
    sine.add(t, s.sine, sines[quadrant % 4]);
    cosine.add(t, s.cosine, sines[(quadrant + 1) % 4]);
    ASSERT_EQ(bits(sine_cosine_of_turns(-t).sine), bits(-s.sine));
    ASSERT_EQ(bits(sine_cosine_of_turns(-t).cosine), bits(s.cosine));
  }
  sine.expect_below(1.0, "sine of turns");
  cosine.expect_below(1.0, "cosine of turns");
  for (const double whole : {0.0, 1.0, 7.0, 0x1p+52, 0x1p+300}) {
    EXPECT_EQ(bits(sine_cosine_of_turns(whole).sine), bits(0.0));
    EXPECT_EQ(sine_cosine_of_turns(whole).cosine, 1.0);
  }
  EXPECT_EQ(sine_cosine_of_turns(0.25).sine, 1.0);
  EXPECT_EQ(sine_cosine_of_turns(0.25).cosine, 0.0);
  EXPECT_EQ(bits(sine_cosine_of_turns(0.5).sine), bits(0.0));
  EXPECT_EQ(sine_cosine_of_turns(-0.75).sine, 1.0);
}

TEST(Elementary, SineNeverFallsNearZero) {
  for (double start = 0x1p-60; start < 0.5; start *= 8) {
    double last = sine_cosine(start).sine;
    double x = start;
    for (int i = 0; i < 5000; ++i) {
      x = std::nextafter(x, 1.0);
      const double s = sine_cosine(x).sine;
      ASSERT_GE(s, last) << std::hexfloat << x;
      last = s;
    }
  }
}

TEST(Elementary, ExponentialsAreWithinTheirBounds) {
  Worst exp, expm1;
  for (const double x : numbers(-60, 10, 40000, 5)) {
    if (x < 709.0 && x > -708.0) exp.add(x, exponential(x), wide_exp(x));
    if (x < 709.0) expm1.add(x, exponential_less_one(x), wide_expm1(x));
  }
  exp.expect_below(1.0, "exp");
  expm1.expect_below(2.0, "expm1");
  EXPECT_EQ(exponential(0.0), 1.0);
  EXPECT_EQ(exponential(1e4), infinity);
  EXPECT_EQ(exponential(-1e4), 0.0);
  EXPECT_EQ(exponential_less_one(-infinity), -1.0);
}

TEST(Elementary, LogarithmsAreWithinAUlp) {
  Worst log;
  const auto check = [&](double x) { log.add(x, logarithm(x), wide_log(x)); };
  for (const double x : numbers(-1074, 1024, 40000, 10)) check(std::abs(x));
  for (const double x : numbers(-52, 0, 40000, 11)) check(1.0 + 0.9 * x);  // small results
  for (const double half : {std::sqrt(0.5), std::sqrt(2.0), 1.0}) {        // the ends of the reduction
    double x = half * (1.0 - 0x1p-44);
    for (int i = 0; i < 2000; ++i) check(x = std::nextafter(x, infinity));
  }
  log.expect_below(1.0, "log");
  EXPECT_EQ(bits(logarithm(1.0)), bits(0.0));
}

TEST(Elementary, PowersAreWithinTheirBound) {
  const std::vector<double> bases = numbers(-1000, 1000, 40000, 12), exponents = numbers(-20, 4, 40000, 13);
  double worst = 0.0;
  for (std::size_t i = 0; i < bases.size(); ++i) {
    const double x = i % 2 == 0 ? std::abs(bases[i]) : std::abs(std::fmod(bases[i], 1e4)) + 1e-9;
    for (const double y : {exponents[i], 0.687, 2.0 / 3.0}) {
      const Wide truth = wide_pow(x, y);
      const auto size = std::abs(static_cast<double>(Wide(y) * wide_log(x)));
      if (size > 700.0) continue;
      worst = std::max(worst, error_in_ulp(power(x, y), truth) / (2.0 + 3.0 * size));
    }
  }
  EXPECT_LT(worst, 1.0);
  EXPECT_GT(worst, 0.1);  // the bound is not an idle one
}

// Each lane has the bits of the function of one number, whatever is in the other lanes.
TEST(Elementary, FourAtATimeHaveTheBitsOfOne) {
  std::vector<double> all = {0.0,  -0.0,  infinity, -infinity, nan,   5e-324, 1.0,
                             -1.0, 699.9, -700.1,   -49.9,     -50.1, 1e300};
  for (const double x : numbers(-60, 9, 6000, 14)) all.push_back(x);
  for (const double x : numbers(-1074, 1023, 2000, 15)) all.push_back(x);
  const auto expect = [&](const char* what, const std::vector<double>& given, auto&& four, auto&& one) {
    for (std::size_t i = 0; i + 4 <= given.size(); i += 4) {
      const detail::portable::Double4 y = four(detail::portable::load_doubles(&given[i]));
      for (std::size_t k = 0; k < 4; ++k) {
        const double truth = one(given[i + k]);
        if (std::isnan(truth) && std::isnan(y[k])) continue;
        ASSERT_EQ(bits(y[k]), bits(truth)) << what << " of " << given[i + k];
      }
    }
  };
  using Four = detail::portable::Double4;
  expect(
      "exp", all, [](const Four& x) { return detail::portable::exponential(x); }, exponential);
  expect(
      "log", all, [](const Four& x) { return detail::portable::logarithm(x); }, logarithm);
  std::vector<double> sizes, negative;
  for (const double x : all) sizes.push_back(std::abs(x)), negative.push_back(std::isnan(x) ? -0.0 : -std::abs(x));
  expect(
      "pow", sizes, [](const Four& x) { return detail::portable::power(x, 0.687); },
      [](double x) { return power(x, 0.687); });
  expect(
      "expm1", negative, [](const Four& x) { return detail::portable::exponential_less_one(x); }, exponential_less_one);
}

TEST(Elementary, AnglesRootsAndLengthsAreWithinTheirBounds) {
  Worst angle, cube, length, space;
  const std::vector<double> a = numbers(-30, 30, 40000, 6), b = numbers(-30, 30, 40000, 7);
  const std::vector<double> large = numbers(-1000, 1000, 4000, 8);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double near = a[i] * (1.0 + 1e-2 * b[i] / (1.0 + std::abs(b[i])));  // all slopes near 1, too
    for (const double x : {b[i], near, a[i] * 0.5 * (1.0 + 0x1p-50)}) {
      angle.add(a[i], polar_angle(a[i], x), wide_atan2(a[i], x));
      length.add(a[i], hypotenuse(a[i], x), wide_sqrt(Wide(a[i]) * a[i] + Wide(x) * x));
    }
    space.add(a[i], hypotenuse(a[i], b[i], near), wide_sqrt(Wide(a[i]) * a[i] + Wide(b[i]) * b[i] + Wide(near) * near));
    cube.add(a[i], cube_root(a[i]), wide_cbrt(a[i]));
  }
  for (std::size_t i = 0; i + 1 < large.size(); ++i) {
    cube.add(large[i], cube_root(large[i]), wide_cbrt(large[i]));
    length.add(large[i], hypotenuse(large[i], large[i + 1]),
               wide_sqrt(Wide(large[i]) * large[i] + Wide(large[i + 1]) * large[i + 1]));
    const Wide truth = wide_atan2(large[i], large[i + 1]);
    if (std::abs(static_cast<double>(truth)) > 0x1p-1000)
      angle.add(large[i], polar_angle(large[i], large[i + 1]), truth);
  }
  angle.expect_below(2.0, "atan2");
  cube.expect_below(1.0, "cbrt");
  length.expect_below(2.0, "hypot");
  space.expect_below(2.0, "hypot of three");
  EXPECT_EQ(cube_root(-27.0), -3.0);
  EXPECT_EQ(hypotenuse(3e300, 4e300), 5e300);
  EXPECT_EQ(hypotenuse(3 * 0x1p-1070, 4 * 0x1p-1070), 5 * 0x1p-1070);
}

TEST(Elementary, SpecialValuesAreThoseOfTheStandardLibrary) {
  const std::vector<double> special = {0.0, -0.0, 1.0, -1.0, infinity, -infinity, nan, 5e-324, -1e308};
  const auto same = [](double own, double standard) {
    return std::isnan(standard) ? std::isnan(own) : bits(own) == bits(standard);
  };
  for (const double x : special) {
    const bool usual = std::abs(x) == 1.0 || std::abs(x) == 1e308;
    if (!usual) {
      EXPECT_TRUE(same(sine_cosine(x).sine, std::sin(x))) << x;
      EXPECT_TRUE(same(sine_cosine(x).cosine, std::cos(x))) << x;
      EXPECT_TRUE(same(cube_root(x), std::cbrt(x)) || x == 5e-324) << x;
      EXPECT_EQ(std::isnan(sine_cosine_of_turns(x).sine), !std::isfinite(x));
    }
    EXPECT_TRUE(same(exponential(x), std::exp(x)) || usual) << x;
    EXPECT_TRUE(same(exponential_less_one(x), std::expm1(x)) || usual) << x;
    EXPECT_TRUE(same(logarithm(x), std::log(x)) || x == 5e-324) << x;
    if (!std::signbit(x)) EXPECT_TRUE(same(power(x, 0.5), std::pow(x, 0.5)) || x == 5e-324) << x;
    if (!std::signbit(x)) EXPECT_TRUE(same(power(x, 0.0), 1.0)) << x;
    for (const double y : special) {
      EXPECT_TRUE(same(polar_angle(y, x), std::atan2(y, x))) << y << " " << x << " " << polar_angle(y, x);
      EXPECT_TRUE(same(hypotenuse(y, x), std::hypot(y, x)) || (std::abs(x) == 1.0 && std::abs(y) == 1.0))
          << y << " " << x;
    }
  }
}

// The known number: a change of any bit of any function changes every scene.
TEST(Elementary, BitsAreTheSameEverywhere) {
  std::uint64_t hash = 0;
  const auto add = [&](double x) { hash = Random(hash ^ bits(x)).next(); };
  for (const double x : numbers(-40, 40, 4000, 9)) {
    const SineCosine radians = sine_cosine(x), turns = sine_cosine_of_turns(x);
    for (const double y : {radians.sine, radians.cosine, turns.sine, turns.cosine}) add(y);
    add(exponential(std::fmod(x, 700.0)));
    add(exponential_less_one(std::fmod(x, 30.0)));
    add(polar_angle(x, std::fmod(x, 3.0)));
    add(cube_root(x));
    add(hypotenuse(x, 3.0, 0.1));
  }
  EXPECT_EQ(hash, 0xc527c97bcb7d6517ULL) << std::hex << hash;
}

TEST(Elementary, BitsOfLogarithmsAndPowersAreTheSameEverywhere) {
  std::uint64_t hash = 0;
  const auto add = [&](double x) { hash = Random(hash ^ bits(x)).next(); };
  for (const double x : numbers(-40, 40, 4000, 16)) {
    add(logarithm(std::abs(x)));
    add(power(std::abs(x), 0.687));
  }
  EXPECT_EQ(hash, 0xc4fa38def52708e5ULL) << std::hex << hash;
}

}  // namespace dartcast::elementary_test
