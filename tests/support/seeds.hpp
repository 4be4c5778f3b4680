// Runs a check over many seeds, on two threads in the full tier, and gathers what went wrong.
#pragma once

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "support/tier.hpp"

namespace dartcast::test {

/// Calls check(seed), which says what is wrong, for the seeds from 1 to `count`, or for the one in the variable
/// DARTCAST_SEED of the environment alone. Returns the first few complaints.
template <class Check>
std::vector<std::string> run_seeds(std::uint64_t count, Check&& check) {
  constexpr std::size_t enough = 10;
  const char* const only = std::getenv("DARTCAST_SEED");
  if (only != nullptr) count = std::strtoull(only, nullptr, 10);
  std::atomic<std::uint64_t> next{only != nullptr ? count : 1};
  std::mutex mutex;
  std::vector<std::string> complaints;
  const auto work = [&] {
    for (std::uint64_t seed = next++; seed <= count; seed = next++) {
      std::string wrong;
      try {
        wrong = check(seed);
      } catch (const std::exception& e) {
        wrong = "seed " + std::to_string(seed) + ": threw " + e.what();
      }
      if (wrong.empty()) continue;
      const std::lock_guard lock(mutex);
      complaints.push_back(std::move(wrong));
      if (complaints.size() >= enough) next = count + 1;
    }
  };
  std::vector<std::thread> threads;
  if (full_tier()) threads.emplace_back(work);
  work();
  for (auto& t : threads) t.join();
  return complaints;
}

}  // namespace dartcast::test
