// Removal by runs against removal one by one.
#include "base/kept_runs.hpp"

#include <gtest/gtest.h>

#include "base/random.hpp"

namespace dartcast::kept_runs_test {

void expect_kept(const std::vector<std::uint8_t>& marks) {
  constexpr std::size_t width = 2;
  std::vector<std::size_t> values;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < width * marks.size(); ++i) {
    values.push_back(i);
    if (marks[i / width] == 0) kept.push_back(i);
  }
  const KeptRuns runs(marks);
  runs.keep_in(values, width);
  EXPECT_EQ(values, kept);
  EXPECT_EQ(runs.kept() * width, kept.size());
}

TEST(KeptRuns, KeepsWhatIsNotMarked) {
  expect_kept({});
  expect_kept({0, 0, 0});
  expect_kept({1, 1, 1});
  expect_kept({1, 0, 1, 1, 0, 0});
  expect_kept({0, 2, 0});
  Random random(1);
  for (std::uint32_t round = 0; round < 200; ++round) {  // many marked, and few
    std::vector<std::uint8_t> marks(random.below(100));
    for (std::uint8_t& mark : marks) mark = random.below(3 + 40 * (round % 2)) == 0 ? 1 : 0;
    expect_kept(marks);
  }
}

}  // namespace dartcast::kept_runs_test
