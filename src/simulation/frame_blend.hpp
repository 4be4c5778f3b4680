// Positions at a time from frames at other times.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "dartcast/deformation.hpp"

namespace dartcast {

/// Which frames count at a time: `count` of them from `first` on (of a cycle: again from 0 behind the last), and their
/// weights, which sum to 1.
struct FrameWeights {
  std::size_t first = 0;
  std::size_t count = 1;
  std::array<double, 4> weights = {1.0, 0.0, 0.0, 0.0};
};

/// The times of frames, and whether these repeat.
class FrameTimes {
 public:
  FrameTimes() = default;
  /// Throws InvalidArgument where times do not increase, or the cycle is shorter than they take.
  FrameTimes(std::vector<double> times, Interpolation interpolation, double cycle);

  /// Frames that are used.
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool repeat() const { return cycle_ > 0.0; }
  /// Frames that a time needs at most.
  [[nodiscard]] std::size_t needed() const { return interpolation_ == Interpolation::cubic ? 4 : 2; }
  [[nodiscard]] FrameWeights at(double time) const;

 private:
  [[nodiscard]] double in_cycle(double time) const;
  [[nodiscard]] double length(std::size_t interval) const;
  [[nodiscard]] FrameWeights cubic(std::size_t before, double share) const;

  std::vector<double> times_;
  Interpolation interpolation_ = Interpolation::linear;
  double cycle_ = 0.0;
  std::size_t size_ = 0;
};

}  // namespace dartcast
