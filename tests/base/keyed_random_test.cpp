#include "base/keyed_random.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace dartcast::keyed_random_test {

using Block = std::array<std::uint32_t, 4>;

// The known answers that come with the authors' library Random123.
TEST(Philox, GivesItsAuthorsNumbers) {
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Block{0x6627e8d5U, 0xe169c58dU, 0xbc57ac4cU, 0x9b00dbd8U}));
  constexpr std::uint32_t all = 0xffffffffU;
  EXPECT_EQ(philox({all, all, all, all}, {all, all}), (Block{0x408f276dU, 0x41c83b0eU, 0xa20bc7c6U, 0x6d5451fdU}));
  EXPECT_EQ(philox({0x243f6a88U, 0x85a308d3U, 0x13198a2eU, 0x03707344U}, {0xa4093822U, 0x299f31d0U}),
            (Block{0xd16cfe09U, 0x94fdccebU, 0x5001e420U, 0x24126ea1U}));
}

TEST(KeyedRandom, DependsOnSeedPurposeItemAndDrawAlone) {
  constexpr auto place = RandomPurpose::place;
  KeyedRandom a(7, place, 12), b(7, place, 12);
  for (int i = 0; i < 9; ++i) EXPECT_EQ(a.next(), b.next());
  std::set<std::uint64_t> seen;
  for (std::uint64_t seed : {7ULL, 8ULL, 7ULL + (1ULL << 32U)}) {
    for (std::uint64_t id : {0ULL, 1ULL, 1ULL << 32U, 1ULL << 63U}) {
      KeyedRandom random(seed, place, id);
      for (int i = 0; i < 5; ++i) seen.insert(random.next());
      KeyedRandom other(seed, static_cast<RandomPurpose>(2), id);
      seen.insert(other.next());
    }
  }
  EXPECT_EQ(seen.size(), 3U * 4U * 6U);
}

// The first draws of neighbouring items are independent: means, and pairs on a grid.
TEST(KeyedRandom, FirstDrawsOfItemsAreUniform) {
  constexpr int count = 64000;
  std::array<int, 64> pairs{};
  double last = KeyedRandom(1, RandomPurpose::place, 0).uniform();
  for (int id = 1; id <= count; ++id) {
    KeyedRandom random(1, RandomPurpose::place, static_cast<std::uint64_t>(id));
    const double u = random.uniform();
    ++pairs[static_cast<std::size_t>(u * 8) * 8 + static_cast<std::size_t>(last * 8)];
    last = u;
  }
  double chi = 0.0;
  for (const int n : pairs) chi += (n - count / 64.0) * (n - count / 64.0) / (count / 64.0);
  EXPECT_LT(chi, 63 + 6 * std::sqrt(2.0 * 63));
  EXPECT_GT(chi, 63 - 5 * std::sqrt(2.0 * 63));
  KeyedRandom random(1, RandomPurpose::place, 3);
  for (int i = 0; i < 1000; ++i) EXPECT_LT(random.below(3), 3U);
}

}  // namespace dartcast::keyed_random_test
