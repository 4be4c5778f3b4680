// Large arrays: where they start, what they keep as they grow, and that their memory is given back.
#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <numeric>

#include "dartcast/storage.hpp"

namespace dartcast::test::aligned_test {

constexpr std::size_t huge_page = std::size_t{1} << 21U;

std::uintptr_t address_of(const AlignedVector<std::uint32_t>& v) { return reinterpret_cast<std::uintptr_t>(v.data()); }

TEST(AlignedVector, StartsOnACacheLineOrAHugePage) {
  for (const std::size_t bytes : {std::size_t{4}, huge_page / 2, huge_page - 68, huge_page - 64, huge_page,
                                  huge_page + 4, 3 * huge_page - 64, 3 * huge_page}) {
    const AlignedVector<std::uint32_t> v(bytes / 4);
    EXPECT_EQ(address_of(v) % 64, 0U) << bytes;
#if defined(__linux__)
    if (bytes >= huge_page) EXPECT_EQ(address_of(v) % huge_page, 0U) << bytes;
#endif
  }
}

TEST(AlignedVector, KeepsWhatItHoldsAsItGrows) {
  AlignedVector<std::uint32_t> v;
  for (std::uint32_t i = 0; i < 3'000'000; ++i) v.push_back(i);
  for (std::uint32_t i = 0; i < v.size(); ++i) ASSERT_EQ(v[i], i);
  const AlignedVector<std::uint32_t> copy = v;
  v.assign(v.size(), 7);
  EXPECT_EQ(std::accumulate(copy.begin(), copy.end(), std::uint64_t{0}), std::uint64_t{2'999'999} * 3'000'000 / 2);
}

#if defined(__linux__)

// Pages of address space in use.
std::uint64_t pages_in_use() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages;
}

TEST(AlignedVector, GivesItsMemoryBack) {
  const std::uint64_t before = pages_in_use();
  for (std::size_t i = 0; i < 300; ++i) {
    const AlignedVector<std::uint32_t> v(huge_page / 4 + i * 100);
    ASSERT_EQ(v.back(), 0U);
  }
  EXPECT_LT(pages_in_use(), before + 100 * huge_page / 4096);
}

#endif

}  // namespace dartcast::test::aligned_test
