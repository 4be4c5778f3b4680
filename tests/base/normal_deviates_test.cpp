// Normal deviates: against logarithms and sines of 113 bits or more, their moments, and the same bits in all lanes.
#include "base/normal_deviates.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include "base/normal_deviates4.inl"
#include "base/random.hpp"

namespace dartcast::normal_deviates_test {

constexpr RandomMoment moment = {12345, RandomPurpose::brownian, 77};

// The bound that the header states.
TEST(NormalDeviates, AreWithinTheStatedBound) {
  const long double turn = 8.0L * std::atan2(1.0L, 1.0L);
  const auto middle = [](std::uint32_t piece) { return (static_cast<long double>(piece) + 0.5L) * 0x1p-32L; };
  Random random(3);
  for (int i = 0; i < 100'000; ++i) {
    const auto word = [&] { return static_cast<std::uint32_t>(random.next() >> 32U); };
    const std::array<std::uint32_t, 4> bits = {i < 10 ? 0U : i < 20 ? ~0U : word(), word(), word(), word()};
    const std::array<double, 4> z = normal_deviates(bits);
    for (std::size_t k = 0; k < 4; k += 2) {
      const long double size = std::sqrt(-2.0L * std::log(middle(bits[k])));
      const long double along = size * std::cos(turn * middle(bits[k + 1]));
      const long double across = size * std::sin(turn * middle(bits[k + 1]));
      // The system's sine of a rounded angle is off by 2^-61 of the size.
      ASSERT_LT(std::abs(z[k] - along), 3 * 0x1p-52L * std::abs(along) + 0x1p-61L * size) << i;
      ASSERT_LT(std::abs(z[k + 1] - across), 3 * 0x1p-52L * std::abs(across) + 0x1p-61L * size) << i;
      ASSERT_LT(std::abs(z[k]), 6.7);
    }
  }
}

// Lanes: other ids in each, and other places of the same id.
TEST(NormalDeviates, HaveTheSameBitsInFourLanes) {
  using namespace detail::DARTCAST_SIMD;
  for (std::uint64_t id = 0; id < 4000; id += 3) {
    const Bits4 ids = {id << 33U, id, id + 1, ~id};
    for (const std::uint32_t draw : {0U, 1U, 7U}) {
      const std::array<Bits4, 4> bits = random_bits(moment, ids, draw);
      const SineCosine4 first = normal_pair(bits[0], bits[1]);
      const SineCosine4 second = normal_pair(bits[2], bits[3]);
      for (unsigned k = 0; k < 4; ++k) {
        const std::array<double, 4> z = normal_deviates(moment.bits(ids[k], draw));
        ASSERT_EQ(z, (std::array<double, 4>{first.cosine[k], first.sine[k], second.cosine[k], second.sine[k]})) << id;
      }
    }
  }
}

// The k-th moment of 800,000 deviates has a standard error of sqrt(E z^2k - (E z^k)^2) / 894.
TEST(NormalDeviates, HaveTheMomentsOfTheirDistribution) {
  constexpr std::uint64_t count = 200'000;
  std::array<double, 4> sums{};
  std::array<double, 3> products{};  // of neighbours: in a block, of items, of moments
  std::array<double, 4> last{};
  for (std::uint64_t id = 0; id < count; ++id) {
    const std::array<double, 4> z = normal_deviates(moment.bits(id));
    const std::array<double, 4> later =
        normal_deviates(RandomMoment{moment.seed, moment.purpose, moment.moment + 1}.bits(id));
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t power = 0; power < 4; ++power) sums[power] += std::pow(z[k], static_cast<int>(power) + 1);
      products[0] += z[k] * z[(k + 1) % 4];
      products[1] += z[k] * last[k];
      products[2] += z[k] * later[k];
    }
    last = z;
  }
  const double n = 4.0 * count;
  const std::array<double, 4> truth = {0.0, 1.0, 0.0, 3.0};
  const std::array<double, 4> deviation = {1.0, std::sqrt(2.0), std::sqrt(15.0), std::sqrt(96.0)};
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(sums[k] / n, truth[k], 4.0 * deviation[k] / std::sqrt(n)) << k;
  for (const double p : products) EXPECT_NEAR(p / n, 0.0, 4.0 / std::sqrt(n));
}

TEST(NormalDeviates, BitsDependOnSeedPurposeMomentItemAndDraw) {
  std::set<std::array<std::uint32_t, 4>> seen;
  int count = 0;
  for (const std::uint64_t seed : {1ULL, 1ULL << 32U}) {
    for (const auto purpose : {RandomPurpose::diffusion, RandomPurpose::brownian}) {
      for (const std::uint64_t at : {0ULL, 1ULL, 1ULL << 32U, (1ULL << 53U) - 1}) {
        for (const std::uint64_t id : {0ULL, 1ULL, 1ULL << 32U}) {
          for (const std::uint32_t draw : {0U, 1U, 7U})
            ++count, seen.insert(RandomMoment{seed, purpose, at}.bits(id, draw));
        }
      }
    }
  }
  EXPECT_EQ(seen.size(), static_cast<std::size_t>(count));
}

}  // namespace dartcast::normal_deviates_test
