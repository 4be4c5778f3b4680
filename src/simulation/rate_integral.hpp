// How many particles a rate that changes by a waveform lets in up to a time.
#pragma once

#include <vector>

#include "dartcast/scene.hpp"

namespace dartcast {

/// The integral of a waveform's factors over time. Pieces between times are exact up to rounding.
class RateIntegral {
 public:
  /// Throws InvalidArgument if the waveform is not as Waveform says.
  explicit RateIntegral(const Waveform& waveform);

  /// From time 0 to t >= 0, in seconds. Without factors: t.
  [[nodiscard]] double operator()(double t) const;
  [[nodiscard]] double largest_factor() const { return largest_; }

 private:
  [[nodiscard]] double from_first_time(double t) const;
  [[nodiscard]] double in_piece(double t) const;

  std::vector<double> times_;  // of a whole period, if it repeats
  std::vector<double> factors_;
  std::vector<double> sums_;  // from the first time to each
  double period_;
  double largest_ = 1.0;
  double at_zero_ = 0.0;
};

}  // namespace dartcast
