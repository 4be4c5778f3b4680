// When particles came into a simulation.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace dartcast {

/// Ids are given in the order of adding. So one entry stands for all particles that came in a step.
class StartTimes {
 public:
  struct Start {
    std::uint64_t first_id = 0;
    double time = 0.0;  ///< s
  };

  StartTimes() = default;
  StartTimes(std::vector<Start> starts, std::uint64_t next_id) : starts_(std::move(starts)), next_id_(next_id) {}

  /// Those with lower ids that are not known yet came at this time.
  void add(std::uint64_t end_id, double time) {
    if (end_id <= next_id_) return;
    starts_.push_back({next_id_, time});
    next_id_ = end_id;
  }
  /// Precondition: id < next_id().
  [[nodiscard]] double of(std::uint64_t id) const {
    const auto after = std::upper_bound(starts_.begin(), starts_.end(), id,
                                        [](std::uint64_t value, const Start& s) { return value < s.first_id; });
    return (after - 1)->time;
  }
  [[nodiscard]] std::uint64_t next_id() const { return next_id_; }
  [[nodiscard]] const std::vector<Start>& starts() const { return starts_; }

 private:
  std::vector<Start> starts_;
  std::uint64_t next_id_ = 0;
};

}  // namespace dartcast
