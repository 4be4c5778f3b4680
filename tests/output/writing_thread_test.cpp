// The thread that writes: order, bounds, errors.
#include "output/writing_thread.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <string>
#include <vector>

#include "dartcast/error.hpp"

namespace dartcast::writing_thread_test {

TEST(WritingThread, JobsAreDoneInTheirOrder) {
  std::vector<int> done;
  WritingThread writing;
  for (int i = 0; i < 1000; ++i) writing.add(1, [&done, i] { done.push_back(i); });
  writing.finish();
  ASSERT_EQ(done.size(), 1000U);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(done[static_cast<std::size_t>(i)], i);
}

TEST(WritingThread, ItsEndWaitsForTheJobs) {
  std::atomic<int> done = 0;
  {
    WritingThread writing;
    for (int i = 0; i < 100; ++i) writing.add(1, [&done] { ++done; });
  }
  EXPECT_EQ(done, 100);
}

// At no time do jobs hold more than the bound, but for one that is larger by itself.
TEST(WritingThread, TheQueueIsBounded) {
  std::atomic<int> held = 0;
  std::atomic<int> most = 0;
  WritingThread writing(10);
  for (int i = 0; i < 500; ++i) {
    const int bytes = 1 + i % 7;
    writing.add(static_cast<std::size_t>(bytes), [&held, bytes] { held -= bytes; });
    most = std::max(most.load(), held += bytes);  // counted late: never more than there are
  }
  writing.add(1000, [] {});
  writing.finish();
  EXPECT_EQ(held, 0);
  EXPECT_LE(most, 10);
}

TEST(WritingThread, ALateJobWaits) {
  std::promise<void> go;
  WritingThread writing(10);
  writing.add(8, [&] { go.get_future().wait(); });
  std::atomic<bool> added = false;
  std::thread second([&] {
    writing.add(8, [] {});
    added = true;
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(added);
  go.set_value();
  second.join();
  EXPECT_TRUE(added);
  writing.finish();
  EXPECT_GT(writing.seconds(), 0.01);
}

TEST(WritingThread, AnErrorStopsItAndIsThrownByAllThatFollows) {
  bool later = false;
  WritingThread writing(10);
  writing.add(1, [] { throw Error("the disk is full"); });
  try {
    writing.add(1, [&] { later = true; });
  } catch (const Error&) {  // where the thread was quick
  }
  EXPECT_THROW(writing.finish(), Error);
  EXPECT_FALSE(later);
  EXPECT_THROW(writing.check(), Error);
  EXPECT_THROW(writing.add(100, [&] { later = true; }), Error);
  EXPECT_THROW(writing.finish(), Error);
  EXPECT_FALSE(later);
}

}  // namespace dartcast::writing_thread_test
