#include "base/parallel.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <mutex>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/error.hpp"
#include "support/expectations.hpp"
#include "support/tier.hpp"

namespace dartcast::parallel_test {

class ParallelFor : public ::testing::TestWithParam<unsigned> {};

std::vector<std::pair<std::size_t, std::size_t>> chunks_of(std::size_t count, std::size_t grain, unsigned threads) {
  std::vector<std::pair<std::size_t, std::size_t>> chunks;
  std::mutex mutex;
  parallel_for(count, grain, {threads}, [&](std::size_t begin, std::size_t end) {
    const std::lock_guard lock(mutex);
    chunks.emplace_back(begin, end);
  });
  std::sort(chunks.begin(), chunks.end());
  return chunks;
}

TEST_P(ParallelFor, CoversEveryItemOnceInChunksOfTheGrain) {
  for (const std::size_t count : {0U, 1U, 5U, 63U, 64U, 65U, 1000U}) {
    for (const std::size_t grain : {1U, 7U, 64U, 5000U}) {
      const auto chunks = chunks_of(count, grain, GetParam());
      ASSERT_EQ(chunks.size(), chunk_count(count, grain));
      for (std::size_t c = 0; c < chunks.size(); ++c) {
        EXPECT_EQ(chunks[c].first, c * grain);
        EXPECT_EQ(chunks[c].second, std::min(count, (c + 1) * grain));
      }
    }
  }
}

TEST_P(ParallelFor, ThrowsTheFirstExceptionByChunkOrderAfterAllChunks) {
  for (int repeat = 0; repeat < 20; ++repeat) {
    std::vector<int> done(100, 0);
    std::string what;
    try {
      parallel_for(100, 1, {GetParam()}, [&](std::size_t begin, std::size_t) {
        done[begin] = 1;
        if (begin == 17 || begin == 18 || begin == 99) throw std::runtime_error(std::to_string(begin));
      });
    } catch (const std::runtime_error& e) {
      what = e.what();
    }
    EXPECT_EQ(what, "17");
    EXPECT_EQ(std::count(done.begin(), done.end(), 1), 100);
  }
}

TEST_P(ParallelFor, GivesTheSameResultForAnyNumberOfThreads) {
  std::vector<double> result(10'000);
  const auto body = [&](std::size_t begin, std::size_t end) {
    double sum = 0.0;
    for (std::size_t i = begin; i < end; ++i) result[i] = sum += 1.0 / static_cast<double>(i + 1);
  };
  parallel_for(result.size(), 33, {1}, body);
  const std::vector<double> serial = std::exchange(result, std::vector<double>(result.size()));
  parallel_for(result.size(), 33, {GetParam()}, body);
  EXPECT_EQ(result, serial);
}

TEST_P(ParallelFor, TakesABodyThatIsConst) {
  std::vector<int> done(10, 0);
  const auto body = [&done](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) done[i] = 1;
  };
  parallel_for(10, 3, {GetParam()}, body);
  EXPECT_EQ(done, std::vector<int>(10, 1));
}

TEST_P(ParallelFor, MayBeNested) {
  std::vector<int> done(64, 0);
  parallel_for(8, 1, {GetParam()}, [&](std::size_t outer, std::size_t) {
    parallel_for(8, 1, {GetParam()}, [&](std::size_t inner, std::size_t) { ++done[8 * outer + inner]; });
  });
  EXPECT_EQ(done, std::vector<int>(64, 1));
}

TEST_P(ParallelFor, MayBeNestedWithOtherThreads) {
  std::vector<int> done(64, 0);
  parallel_for(8, 1, {GetParam()}, [&](std::size_t outer, std::size_t) {
    parallel_for(8, 1, {GetParam() + 1}, [&](std::size_t inner, std::size_t) { ++done[8 * outer + inner]; });
  });
  EXPECT_EQ(done, std::vector<int>(64, 1));
}

// Each stage counts on from all that the stage before wrote.
TEST_P(ParallelFor, StagesStartWhenTheOneBeforeHasEnded) {
  for (const std::size_t grain : {1U, 3U, 100U}) {
    std::vector<std::vector<std::uint64_t>> rows(60);
    std::vector<std::size_t> counts;
    for (std::size_t s = 0; s < rows.size(); ++s) counts.push_back(s % 7 == 5 ? 0 : s + 1);
    for (std::size_t s = 0; s < rows.size(); ++s) rows[s].assign(s + 1, 0);
    std::size_t last = 0;
    parallel_stages(counts, grain, {GetParam()}, [&](std::size_t stage, std::size_t begin, std::size_t end) {
      const std::size_t before = stage % 7 == 6 ? stage - 2 : stage - 1;
      for (std::size_t i = begin; i < end; ++i) {
        std::uint64_t sum = 0;
        if (stage > 0) sum = std::accumulate(rows[before].begin(), rows[before].end(), std::uint64_t{0});
        rows[stage][i] = i == 0 ? sum + 1 : 0;
      }
      if (begin == 0) last = stage;
    });
    std::uint64_t expected = 0;
    for (std::size_t s = 0; s < rows.size(); ++s) {
      if (counts[s] > 0) EXPECT_EQ(rows[s][0], ++expected);
    }
    EXPECT_EQ(last, rows.size() - 1);
  }
  parallel_stages(std::vector<std::size_t>{}, 1, {GetParam()}, [](auto, auto, auto) { FAIL(); });
}

// --- more threads than there can be

TEST(ParallelForRefuses, MoreThreadsThanCanBeAskedFor) {
  EXPECT_GE(max_threads(), 256U);
  for (const unsigned count : {max_threads() + 1, 100'000U, 0x7fffffffU, 0x80000000U, 0xffffffffU}) {
    const std::string why = test::error_text([&] { check_threads({count}); });
    EXPECT_NE(why.find(std::to_string(count) + " threads"), std::string::npos) << why;
    EXPECT_NE(why.find("at most " + std::to_string(max_threads())), std::string::npos) << why;
    for (const std::size_t items : {0U, 1U, 100U})
      EXPECT_THROW(parallel_for(items, 1, {count}, [](std::size_t, std::size_t) { FAIL(); }), InvalidArgument);
  }
}

// In a process of its own: lets it take so much more memory, where the stack of each thread takes some megabytes.
void limit_memory(std::size_t bytes) {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const rlim_t most = pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) + bytes;
  const rlimit limit = {most, most};
  setrlimit(RLIMIT_AS, &limit);
}

class ParallelForUnderALimit : public ::testing::Test {
 protected:
  void SetUp() override {
    if (test::sanitized()) GTEST_SKIP() << "sanitizers take more memory than any limit";
    testing::GTEST_FLAG(death_test_style) = "threadsafe";
  }
};

[[noreturn]] void ask_for_too_many() {
  limit_memory(std::size_t{100} << 20U);
  const std::string why = test::error_text([&] { check_threads({200}); });
  int done = 0;
  parallel_for(2, 1, {2}, [&](std::size_t, std::size_t) { __atomic_add_fetch(&done, 1, __ATOMIC_RELAXED); });
  try {
    parallel_for(1000, 1, {200}, [](std::size_t, std::size_t) { std::abort(); });
  } catch (const Error& e) {
    std::fprintf(stderr, "%d done; %s\n", done, e.what());
    std::exit(why.find("200 threads: the system gives ") == 0 ? 0 : 2);
  }
  std::exit(3);
}

TEST_F(ParallelForUnderALimit, SaysHowManyThreadsThereAre) {
  EXPECT_EXIT(ask_for_too_many(), testing::ExitedWithCode(0),
              "^2 done; 200 threads: the system gives [0-9]+ now; ask for fewer");
}

[[noreturn]] void ask_for_all() {
  limit_memory(std::size_t{4} << 20U);
  int done = 0;
  parallel_for(100, 1, {}, [&](std::size_t, std::size_t) { __atomic_add_fetch(&done, 1, __ATOMIC_RELAXED); });
  std::exit(done == 100 ? 0 : 1);
}

TEST_F(ParallelForUnderALimit, TakesThoseThatThereAre) { EXPECT_EXIT(ask_for_all(), testing::ExitedWithCode(0), ""); }

INSTANTIATE_TEST_SUITE_P(Threads, ParallelFor, ::testing::Values(0U, 1U, 2U, 7U));

}  // namespace dartcast::parallel_test
