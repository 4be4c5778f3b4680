// Values at a time from samples at other times: frames of a deformation, samples of a field.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "dartcast/deformation.hpp"

namespace dartcast {

/// Which samples count at a time, in the order of their times, and their weights, which sum to 1. In a cycle that is as
/// long as its samples, the first and the last one are neighbours without a distance. One of them is left out.
struct SampleWeights {
  std::size_t count = 1;
  std::array<std::size_t, 4> samples = {};
  std::array<double, 4> weights = {1.0, 0.0, 0.0, 0.0};
};

/// The times of samples, and whether these repeat.
class SampleTimes {
 public:
  SampleTimes() = default;
  /// Throws InvalidArgument, which begins with the owner's name, if times do not increase, or the cycle is shorter than
  /// they take.
  SampleTimes(std::string_view owner, std::vector<double> times, Interpolation interpolation, double cycle);

  [[nodiscard]] std::size_t size() const { return times_.size(); }
  [[nodiscard]] bool repeat() const { return cycle_ > 0.0; }
  /// Samples that a time needs at most.
  [[nodiscard]] std::size_t needed() const { return interpolation_ == Interpolation::cubic ? 4 : 2; }
  [[nodiscard]] SampleWeights at(double time) const;

 private:
  // A sample beside another one, and the time between them.
  struct Neighbour {
    std::size_t sample = 0;
    double distance = 0.0;
  };

  [[nodiscard]] double in_cycle(double time) const;
  [[nodiscard]] double gap() const { return times_.front() + cycle_ - times_.back(); }
  [[nodiscard]] Neighbour after(std::size_t sample) const;
  [[nodiscard]] Neighbour before(std::size_t sample) const;
  [[nodiscard]] SampleWeights cubic(std::size_t first, const Neighbour& second, double share) const;

  std::vector<double> times_;
  Interpolation interpolation_ = Interpolation::linear;
  double cycle_ = 0.0;
};

}  // namespace dartcast
