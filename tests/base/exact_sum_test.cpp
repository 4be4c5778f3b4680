// Exact sums against fractions, in any order.
#include "base/exact_sum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include "support/tier.hpp"

namespace dartcast::test {
namespace {

// Wide enough for any sum of doubles: 2098 bits and the carries of 2^40 of them.
using Wide = boost::multiprecision::number<
    boost::multiprecision::cpp_bin_float<2200, boost::multiprecision::digit_base_2, void, std::int32_t, -5000, 5000>>;

double true_sum(const std::vector<double>& values) {
  Wide sum = 0;
  for (const double v : values) sum += Wide(v);
  return sum.convert_to<double>();
}

double sum_of(const std::vector<double>& values) {
  ExactSum sum;
  for (const double v : values) sum.add(v);
  return sum.value();
}

// Signs, mantissas and exponents of all sizes; some cancel others.
std::vector<double> random_values(std::mt19937_64& random, int spread) {
  std::vector<double> values(std::uniform_int_distribution<std::size_t>(1, 60)(random));
  for (double& v : values) {
    const double mantissa = std::ldexp(static_cast<double>(random() >> 11U), -53);
    v = std::ldexp(mantissa, std::uniform_int_distribution<int>(-spread, std::min(spread, 1000))(random));
    if (random() % 2 == 0) v = -v;
  }
  if (random() % 3 == 0) {
    const std::size_t half = values.size() / 2;
    for (std::size_t i = 0; i < half; ++i) values[half + i] = -values[i];
  }
  return values;
}

TEST(ExactSum, IsThatOfWideNumbers) {
  std::mt19937_64 random(1);
  for (int round = 0; round < scaled(20'000, 1'000'000); ++round) {
    const std::vector<double> values = random_values(random, round % 4 == 0 ? 1080 : 40);
    const double sum = sum_of(values);
    if (std::isinf(true_sum(values))) continue;
    ASSERT_EQ(std::bit_cast<std::uint64_t>(sum + 0.0), std::bit_cast<std::uint64_t>(true_sum(values) + 0.0)) << round;
  }
}

TEST(ExactSum, IsTheSameInAnyOrderAndInParts) {
  std::mt19937_64 random(2);
  for (int round = 0; round < scaled(5'000, 200'000); ++round) {
    std::vector<double> values = random_values(random, 200);
    const double sum = sum_of(values);
    std::shuffle(values.begin(), values.end(), random);
    ASSERT_EQ(sum_of(values), sum);
    ExactSum parts[3];
    for (const double v : values) parts[random() % 3].add(v);
    ExactSum::Words words = parts[0].words();
    for (const ExactSum& p : {parts[1], parts[2]}) {
      for (std::size_t i = 0; i < words.size(); ++i) words[i] += p.words()[i];
    }
    ASSERT_EQ(ExactSum::of(words).value(), sum);
    parts[0] += parts[1];
    parts[0] += parts[2];
    ASSERT_EQ(parts[0].value(), sum);
  }
}

TEST(ExactSum, RoundsTiesToEven) {
  EXPECT_EQ(sum_of({0x1p53, 1.0}), 0x1p53);
  EXPECT_EQ(sum_of({0x1p53, 1.0, 0x1p-1074}), 0x1p53 + 2.0);
  EXPECT_EQ(sum_of({0x1p53 + 2.0, 1.0}), 0x1p53 + 4.0);
  EXPECT_EQ(sum_of({-0x1p53, -1.0, 0x1p-1074}), -0x1p53);
  EXPECT_EQ(sum_of({0x1p-1074, 0x1p-1074}), 0x1p-1073);
}

TEST(ExactSum, KeepsWhatIsNotFinite) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(sum_of({1.0, infinity, -5.0}), infinity);
  EXPECT_TRUE(std::isnan(sum_of({infinity, 1.0, -infinity})));
  ExactSum::Words words{};
  for (const double x : {infinity, 1.0, -infinity}) {
    ExactSum sum;
    sum.add(x);
    for (std::size_t i = 0; i < words.size(); ++i) words[i] += sum.words()[i];
    if (x > 0.0) EXPECT_EQ(ExactSum::of(words).value(), infinity);
  }
  EXPECT_TRUE(std::isnan(ExactSum::of(words).value()));
}

}  // namespace
}  // namespace dartcast::test
