#include "predicates/expansion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "support/dyadic.hpp"
#include "support/quadruples.hpp"
#include "support/tier.hpp"

namespace dartcast::test::expansion_test {

template <std::size_t N>
Dyadic exact(const Expansion<N>& e) {
  Dyadic sum;
  for (std::size_t i = 0; i < e.size; ++i) sum = sum + Dyadic(e.component[i]);
  return sum;
}

// The lowest binary digit of x that is set, as a power of two.
double lowest_digit(double x) {
  int exponent = 0;
  const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &exponent), 53));
  return std::ldexp(static_cast<double>(mantissa & -mantissa), exponent - 53);
}

// Sorted, without zeros, and each component below the lowest digit of the next: what sign() and estimate() rely on.
template <std::size_t N>
::testing::AssertionResult well_formed(const Expansion<N>& e) {
  if (e.size > N) return ::testing::AssertionFailure() << "too long: " << e.size;
  for (std::size_t i = 0; i < e.size; ++i) {
    if (e.component[i] == 0.0) return ::testing::AssertionFailure() << "zero at " << i;
    if (i == 0) continue;
    if (std::abs(e.component[i - 1]) >= lowest_digit(e.component[i]))
      return ::testing::AssertionFailure() << "overlap at " << i;
  }
  return ::testing::AssertionSuccess();
}

template <std::size_t N>
void expect_is(const Expansion<N>& e, const Dyadic& truth) {
  ASSERT_TRUE(well_formed(e));
  ASSERT_EQ(exact(e), truth);
  ASSERT_EQ(e.sign(), truth.sign());
  const double estimate = e.estimate();
  ASSERT_EQ((estimate > 0.0) - (estimate < 0.0), truth.sign());
  ASSERT_FALSE(truth.abs() * Dyadic(0x1p-51) < (Dyadic(estimate) - truth).abs());
}

TEST(Expansion, SumsDifferencesAndProductsAreExact) {
  Quadruples quadruples(1);
  for (int i = 0; i < scaled(40'000, 40'000); ++i) {
    const int spread = 1 + i % 80;
    const auto number = [&] { return i % 3 == 0 ? quadruples.integer(3) : quadruples.signed_power(-spread, spread); };
    const double x[6] = {number(), number(), number(), number(), number(), number()};
    const auto a = difference(x[0], x[1]);
    const auto b = difference(x[2], x[3]);
    const auto c = difference(x[4], x[5]);
    const Dyadic da = Dyadic(x[0]) - Dyadic(x[1]);
    const Dyadic db = Dyadic(x[2]) - Dyadic(x[3]);
    const Dyadic dc = Dyadic(x[4]) - Dyadic(x[5]);
    expect_is(a, da);
    expect_is(-a, Dyadic() - da);
    expect_is(a + b, da + db);
    expect_is(a - b, da - db);
    expect_is(a - a, Dyadic());
    expect_is(scale(a, x[2]), da * Dyadic(x[2]));
    expect_is(a * b, da * db);
    expect_is(a * b - c * a, da * db - dc * da);
    expect_is((a * b - c * a) * (b - c), (da * db - dc * da) * (db - dc));
    expect_is((a * b - c * a) - (b - c) * a, Dyadic());
    if (HasFatalFailure()) FAIL() << "case " << i;
  }
}

TEST(Expansion, OfZeroHasNoComponents) {
  EXPECT_EQ(difference(1.0, 1.0).size, 0U);
  EXPECT_EQ(difference(1.0, 1.0).sign(), 0);
  EXPECT_EQ(difference(1.0, 1.0).estimate(), 0.0);
  EXPECT_EQ(scale(difference(2.0, 1.0), 0.0).size, 0U);
  EXPECT_EQ((difference(1.0, 1.0) * difference(2.0, 1.0)).size, 0U);
}

}  // namespace dartcast::test::expansion_test
