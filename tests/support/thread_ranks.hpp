// Ranks that are threads of one process: for tests of what ranks do, without MPI.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "dartcast/ranks.hpp"

namespace dartcast::test {

/// Where the ranks of a group leave what they send.
class RankGroup {
 public:
  explicit RankGroup(unsigned size) : sent_(size) {}
  [[nodiscard]] unsigned size() const { return static_cast<unsigned>(sent_.size()); }

  /// The bytes that all have sent to this rank, by rank.
  std::vector<std::string> exchange(unsigned rank, std::vector<std::string> bytes) {
    {
      const std::lock_guard lock(mutex_);
      sent_[rank] = std::move(bytes);
    }
    wait();
    std::vector<std::string> received;
    {
      const std::lock_guard lock(mutex_);
      for (const auto& row : sent_) received.push_back(row[rank]);
    }
    wait();
    return received;
  }

  bool fail(unsigned rank, const std::string& why) {
    const std::lock_guard lock(mutex_);
    const bool first = failure_.empty();
    if (first) failure_ = "rank " + std::to_string(rank) + ": " + why;
    changed_.notify_all();
    return first;
  }

 private:
  void wait() {
    std::unique_lock lock(mutex_);
    const std::uint64_t round = round_;
    if (++waiting_ == size()) {
      waiting_ = 0;
      ++round_;
      changed_.notify_all();
    }
    changed_.wait(lock, [&] { return round_ != round || !failure_.empty(); });
    if (round_ == round) throw RankFailed(failure_);
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::vector<std::string>> sent_;  // by sender, then by receiver
  unsigned waiting_ = 0;
  std::uint64_t round_ = 0;
  std::string failure_;
};

class ThreadRanks final : public Ranks {
 public:
  ThreadRanks(RankGroup& group, unsigned rank) : group_(group), rank_(rank) {}

  [[nodiscard]] unsigned rank() const override { return rank_; }
  [[nodiscard]] unsigned size() const override { return group_.size(); }
  std::vector<std::string> gather(std::string bytes) override {
    std::vector<std::string> to(size());
    to[0] = std::move(bytes);
    std::vector<std::string> all = group_.exchange(rank_, std::move(to));
    if (rank_ != 0) all.clear();
    return all;
  }
  std::string broadcast(std::string bytes) override {
    return group_.exchange(rank_, std::vector<std::string>(size(), bytes)).front();
  }
  std::vector<std::string> exchange(std::vector<std::string> bytes) override {
    return group_.exchange(rank_, std::move(bytes));
  }
  void sum(std::span<std::uint64_t> values) override {
    const std::string own(reinterpret_cast<const char*>(values.data()), values.size_bytes());
    const std::vector<std::string> all = group_.exchange(rank_, std::vector<std::string>(size(), own));
    std::fill(values.begin(), values.end(), 0);
    for (const std::string& bytes : all) {
      for (std::size_t i = 0; i < values.size(); ++i) {
        std::uint64_t value = 0;
        bytes.copy(reinterpret_cast<char*>(&value), sizeof value, i * sizeof value);
        values[i] += value;
      }
    }
  }
  bool fail(const std::string& why) noexcept override { return group_.fail(rank_, why); }

 private:
  RankGroup& group_;
  unsigned rank_;
};

/// Runs a function on so many ranks, each in a thread of its own. Throws what the first that failed has thrown.
inline void on_ranks(unsigned size, const std::function<void(Ranks&)>& run) {
  RankGroup group(size);
  std::vector<std::exception_ptr> errors(size);
  std::vector<std::thread> threads;
  for (unsigned rank = 0; rank < size; ++rank) {
    threads.emplace_back([&, rank] {
      ThreadRanks ranks(group, rank);
      try {
        run(ranks);
      } catch (const RankFailed&) {
        errors[rank] = std::current_exception();
      } catch (const std::exception& e) {
        errors[rank] = std::current_exception();
        ranks.fail(e.what());
      }
    });
  }
  for (std::thread& t : threads) t.join();
  for (const std::exception_ptr& e : errors) {
    if (e) std::rethrow_exception(e);
  }
}

}  // namespace dartcast::test
