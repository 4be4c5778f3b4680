// Which particles of a simulation are this process's. Not installed.
#pragma once

#include <cstdint>
#include <span>

#include "base/are_several.hpp"
#include "dartcast/ranks.hpp"

namespace dartcast {

/// Blocks of ids go to the ranks in turn, so that those that come together are shared evenly.
class ParticleShare {
 public:
  /// None: one process has all.
  explicit ParticleShare(const Ranks* ranks)
      : rank_(ranks != nullptr ? ranks->rank() : 0), size_(ranks != nullptr ? ranks->size() : 1) {}

  [[nodiscard]] bool has_all() const { return size_ == 1; }
  [[nodiscard]] bool is_first() const { return rank_ == 0; }
  [[nodiscard]] bool holds(std::uint64_t id) const { return has_all() || id / block % size_ == rank_; }

 private:
  static constexpr std::uint64_t block = 64;

  std::uint64_t rank_;
  std::uint64_t size_;
};

/// Each value becomes the sum of those of all ranks; none: it stays.
inline void sum_over(Ranks* ranks, std::span<std::uint64_t> values) {
  if (are_several(ranks)) ranks->sum(values);
}

}  // namespace dartcast
