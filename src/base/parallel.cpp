// Chunks of a loop on threads of TBB or std::thread, and the number of threads that the system gives.
#include "base/parallel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

#include "dartcast/error.hpp"

#ifndef DARTCAST_THREADS_STD
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <map>
#include <optional>
#endif

namespace dartcast {

namespace {

constexpr unsigned usual_limit = 256;  // TBB always accepts this many

unsigned machine_threads() {
#ifdef DARTCAST_THREADS_STD
  return std::max(1U, std::thread::hardware_concurrency());
#else
  return static_cast<unsigned>(tbb::info::default_concurrency());
#endif
}

// The number of threads that can exist at once, with the calling one; at most `wanted`. TBB ends the program if it
// cannot start a thread, so all are started and ended here first.
unsigned given_by_system(unsigned wanted) {
  std::vector<std::thread> started;
  std::atomic<bool> end = false;
  try {
    while (started.size() + 1 < wanted) started.emplace_back([&end] { end.wait(false); });
  } catch (const std::exception&) {  // the number or the memory of threads is limited
  }
  end = true;
  end.notify_all();
  for (std::thread& t : started) t.join();
  return static_cast<unsigned>(started.size()) + 1;
}

}  // namespace

unsigned max_threads() { return std::max(usual_limit, machine_threads()); }

void check_threads(Threads threads) {
  static std::atomic<unsigned> given = 1;  // the largest number that the system has given: it is asked once
  if (threads.count <= given) return;
  if (threads.count > max_threads())
    throw InvalidArgument(fmt::format("{} threads: at most {} can be asked for, 0 stands for all that the machine has",
                                      threads.count, max_threads()));
  const unsigned limit = given_by_system(threads.count);
  if (limit < threads.count)
    throw Error(fmt::format(
        "{} threads: the system gives {} now; ask for fewer, or raise its limits (ulimit -u, ulimit -v, or those of "
        "the container)",
        threads.count, limit));
  given = limit;
}

unsigned thread_count(Threads threads) {
  static const unsigned all = given_by_system(machine_threads());
  return threads.count == 0 ? all : threads.count;
}

}  // namespace dartcast

namespace dartcast::detail {

namespace {

// Keeps the first exception by chunk order, so that the exception does not depend on threads either.
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
  threads = static_cast<unsigned>(std::min<std::size_t>(threads, chunks.size()));
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t c = next++; c < chunks.size(); c = next++) chunks.run(c);
  };
  std::vector<std::thread> pool;
  try {
    for (unsigned i = 1; i < threads; ++i) pool.emplace_back(work);
  } catch (const std::exception&) {  // the system gave them before: fewer suffice now
  }
  work();
  for (auto& t : pool) t.join();
}
#else
// Each calling thread keeps its arenas, by their size: the workers of a new one come some 50 us later. A thread that
// waits for its loop takes chunks of no other loop, because that may be a loop around its own.
void run_parallel(Chunks& chunks, unsigned threads) {
  // If a caller asks for more threads than cores, TBB would start fewer and complain on stderr.
  std::optional<tbb::global_control> more;
  if (threads > machine_threads()) more.emplace(tbb::global_control::max_allowed_parallelism, threads);
  thread_local std::map<unsigned, tbb::task_arena> arenas;
  tbb::task_arena& arena = arenas.try_emplace(threads, static_cast<int>(threads)).first->second;
  arena.execute([&] {
    tbb::this_task_arena::isolate([&] {
      tbb::parallel_for(
          tbb::blocked_range<std::size_t>(0, chunks.size(), 1),
          [&](const tbb::blocked_range<std::size_t>& range) {
            for (std::size_t c = range.begin(); c < range.end(); ++c) chunks.run(c);
          },
          tbb::simple_partitioner{});
    });
  });
}
#endif

// The stages of one call. A thread first claims chunks of its own slice of a stage. So it finds most of its data in its
// own cache. Then it claims those of others that are late. It goes on when all chunks of the stage are done. A chunk is
// claimed by running threads alone, so nobody waits for a thread that has not come.
class Stages {
 public:
  Stages(std::span<const std::size_t> counts, std::size_t grain, unsigned slices, StageBody body, void* context)
      : counts_(counts),
        grain_(grain),
        slices_(slices),
        body_(body),
        context_(context),
        done_(counts.size()),
        claimed_(counts.size() * slices) {}

  void run(std::size_t slice) {
    for (std::size_t stage = 0; stage < counts_.size(); ++stage) {
      const std::size_t chunks = chunk_count(counts_[stage], grain_);
      std::atomic<std::size_t>& done = done_[stage].value;
      if (done.load(std::memory_order_acquire) == chunks) continue;
      std::size_t own = 0;
      for (std::size_t i = 0; i < slices_; ++i) own += run_slice(stage, chunks, (slice + i) % slices_);
      if (own > 0) done.fetch_add(own, std::memory_order_acq_rel);
      wait(done, chunks);
    }
  }

 private:
  struct alignas(64) Count {
    std::atomic<std::size_t> value{0};
  };

  // Returns the number of chunks that this thread has run.
  std::size_t run_slice(std::size_t stage, std::size_t chunks, std::size_t slice) {
    const std::size_t first = chunks * slice / slices_;
    const std::size_t size = chunks * (slice + 1) / slices_ - first;
    std::atomic<std::size_t>& claimed = claimed_[stage * slices_ + slice].value;
    std::size_t own = 0;
    while (claimed.load(std::memory_order_relaxed) < size) {
      const std::size_t c = claimed.fetch_add(1, std::memory_order_relaxed);
      if (c >= size) break;
      const std::size_t begin = (first + c) * grain_;
      body_(context_, stage, begin, std::min(counts_[stage], begin + grain_));
      ++own;
    }
    return own;
  }

  // A chunk takes about a microsecond. If it takes much longer, its thread has lost its core.
  static void wait(const std::atomic<std::size_t>& done, std::size_t chunks) {
    for (unsigned tries = 0; done.load(std::memory_order_acquire) != chunks; ++tries) {
      if (tries < 2000)
        relax();
      else
        std::this_thread::yield();
    }
  }
  static void relax() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }

  std::span<const std::size_t> counts_;
  std::size_t grain_;
  std::size_t slices_;
  StageBody body_;
  void* context_;
  std::vector<Count> done_;     // by stage: chunks
  std::vector<Count> claimed_;  // by stage and slice: chunks
};

}  // namespace

void parallel_chunks(std::size_t count, std::size_t grain, Threads threads, ChunkBody body, void* context) {
  check_threads(threads);
  if (count == 0) return;
  Chunks chunks(count, std::max<std::size_t>(grain, 1), body, context);
  const unsigned wanted = chunks.size() == 1 ? 1 : thread_count(threads);
  if (wanted == 1) {
    for (std::size_t c = 0; c < chunks.size(); ++c) chunks.run(c);
  } else {
    run_parallel(chunks, wanted);
  }
  chunks.rethrow();
}

void parallel_stages(std::span<const std::size_t> counts, std::size_t grain, Threads threads, StageBody body,
                     void* context) {
  check_threads(threads);
  std::size_t most = 0;
  for (const std::size_t count : counts) most = std::max(most, chunk_count(count, grain));
  const auto slices = most <= 1 ? 1U : static_cast<unsigned>(std::min<std::size_t>(thread_count(threads), most));
  if (slices == 1) {
    for (std::size_t stage = 0; stage < counts.size(); ++stage) {
      if (counts[stage] > 0) body(context, stage, 0, counts[stage]);
    }
    return;
  }
  Stages stages(counts, grain, slices, body, context);
  parallel_for(slices, 1, {slices}, [&](std::size_t slice, std::size_t) { stages.run(slice); });
}

}  // namespace dartcast::detail
