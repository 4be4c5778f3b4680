// Finds the interval of a time, and the weights of the frames around it.
#include "simulation/frame_blend.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "dartcast/error.hpp"

namespace dartcast {

namespace {

// Frames are always the first step of a deformation.
void require(bool holds, const char* text) {
  if (!holds) throw InvalidArgument(std::string("deformation 1 (frames): ") + text);
}

}  // namespace

FrameTimes::FrameTimes(std::vector<double> times, Interpolation interpolation, double cycle)
    : times_(std::move(times)), interpolation_(interpolation), cycle_(cycle), size_(times_.size()) {
  for (std::size_t i = 0; i < times_.size(); ++i)
    require(std::isfinite(times_[i]) && (i == 0 || times_[i] > times_[i - 1]), "times must be finite and increasing");
  require(std::isfinite(cycle) && cycle >= 0.0, "cycle must be 0 or more");
  if (cycle == 0.0 || times_.empty()) return;
  require(cycle >= times_.back() - times_.front(), "cycle must be at least the time from the first to the last frame");
  if (size_ > 1 && times_.front() + cycle <= times_.back()) --size_;
}

double FrameTimes::in_cycle(double time) const {
  const double since = time - times_.front();
  const double phase = since - std::floor(since / cycle_) * cycle_;
  return times_.front() + (phase >= 0.0 && phase < cycle_ ? phase : 0.0);
}

// From the frame to the one behind it.
double FrameTimes::length(std::size_t interval) const {
  return (interval + 1 < times_.size() ? times_[interval + 1] : times_.front() + cycle_) - times_[interval];
}

FrameWeights FrameTimes::at(double time) const {
  const double t = repeat() ? in_cycle(time) : time;
  const auto end = times_.begin() + static_cast<std::ptrdiff_t>(size_);
  const auto after = static_cast<std::size_t>(std::upper_bound(times_.begin(), end, t) - times_.begin());
  const std::size_t before = after == 0 ? 0 : after - 1;
  if (size_ == 1 || (!repeat() && (after == 0 || after == size_))) return {before, 1, {1.0, 0.0, 0.0, 0.0}};
  const double share = std::min((t - times_[before]) / length(before), 1.0);
  if (interpolation_ == Interpolation::cubic) return cubic(before, share);
  return {before, 2, {1 - share, share, 0.0, 0.0}};
}

// Hermite's cubic between two frames. The velocity at a frame is that of the parabola through it and its neighbours; at
// the first and the last one of a series that does not repeat it is that of the straight way.
FrameWeights FrameTimes::cubic(std::size_t before, double share) const {
  const bool has_first = repeat() || before > 0;
  const bool has_last = repeat() || before + 2 < size_;
  const double s = share, h = length(before);
  const double to_first = s * (1 - s) * (1 - s), to_second = s * s * (s - 1);  // factors of the two velocities
  std::array<double, 4> w = {0.0, (1 + 2 * s) * (1 - s) * (1 - s), s * s * (3 - 2 * s), 0.0};
  double outer = 0.0, inner = 1.0;  // a velocity times h, from the differences on its two sides
  if (has_first) {
    const double g = length((before + size_ - 1) % size_);
    outer = h * h / (g * (g + h));
    inner = g / (g + h);
  }
  w[0] -= to_first * outer;
  w[1] += to_first * (outer - inner);
  w[2] += to_first * inner;
  outer = 0.0, inner = 1.0;
  if (has_last) {
    const double g = length((before + 1) % size_);
    outer = h * h / (g * (g + h));
    inner = g / (g + h);
  }
  w[1] -= to_second * inner;
  w[2] += to_second * (inner - outer);
  w[3] += to_second * outer;
  if (has_first) return {(before + size_ - 1) % size_, has_last ? std::size_t{4} : 3, w};
  return {before, has_last ? std::size_t{3} : 2, {w[1], w[2], w[3], 0.0}};
}

}  // namespace dartcast
