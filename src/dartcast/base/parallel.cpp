#include "dartcast/base/parallel.hpp"

#include <algorithm>
#include <exception>
#include <vector>

#ifdef DARTCAST_THREADS_STD
#include <atomic>
#include <thread>
#else
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <optional>
#endif

namespace dartcast::detail {

namespace {

// Keeps the first exception by chunk order, so that what is thrown does not depend on threads either.
class Chunks {
 public:
  Chunks(std::size_t count, std::size_t grain, ChunkBody body, void* context)
      : count_(count), grain_(grain), body_(body), context_(context), errors_(chunk_count(count, grain)) {}

  [[nodiscard]] std::size_t size() const { return errors_.size(); }

  void run(std::size_t chunk) noexcept {
    try {
      body_(context_, chunk * grain_, std::min(count_, (chunk + 1) * grain_));
    } catch (...) {
      errors_[chunk] = std::current_exception();
    }
  }

  void rethrow() const {
    for (const auto& e : errors_) {
      if (e) std::rethrow_exception(e);
    }
  }

 private:
  std::size_t count_;
  std::size_t grain_;
  ChunkBody body_;
  void* context_;
  std::vector<std::exception_ptr> errors_;
};

#ifdef DARTCAST_THREADS_STD
void run_parallel(Chunks& chunks, unsigned threads) {
  if (threads == 0) threads = std::max(1U, std::thread::hardware_concurrency());
  threads = static_cast<unsigned>(std::min<std::size_t>(threads, chunks.size()));
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t c = next++; c < chunks.size(); c = next++) chunks.run(c);
  };
  std::vector<std::thread> pool;
  for (unsigned i = 1; i < threads; ++i) pool.emplace_back(work);
  work();
  for (auto& t : pool) t.join();
}
#else
void run_parallel(Chunks& chunks, unsigned threads) {
  // Asked for more threads than there are cores, TBB would start fewer and complain on stderr.
  std::optional<tbb::global_control> more;
  if (threads > static_cast<unsigned>(tbb::info::default_concurrency())) {
    more.emplace(tbb::global_control::max_allowed_parallelism, threads);
  }
  tbb::task_arena arena(threads == 0 ? tbb::task_arena::automatic : static_cast<int>(threads));
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, chunks.size(), 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t c = range.begin(); c < range.end(); ++c) chunks.run(c);
        },
        tbb::simple_partitioner{});
  });
}
#endif

}  // namespace

void parallel_chunks(std::size_t count, std::size_t grain, Threads threads, ChunkBody body, void* context) {
  if (count == 0) return;
  Chunks chunks(count, std::max<std::size_t>(grain, 1), body, context);
  if (threads.count == 1 || chunks.size() == 1) {
    for (std::size_t c = 0; c < chunks.size(); ++c) chunks.run(c);
  } else {
    run_parallel(chunks, threads.count);
  }
  chunks.rethrow();
}

}  // namespace dartcast::detail
