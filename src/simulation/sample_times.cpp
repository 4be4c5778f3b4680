// Finds the interval of a time, and the weights of the samples around it.
#include "simulation/sample_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "dartcast/error.hpp"

namespace dartcast {

SampleTimes::SampleTimes(std::string_view owner, std::vector<double> times, Interpolation interpolation, double cycle)
    : times_(std::move(times)), interpolation_(interpolation), cycle_(cycle) {
  const auto require = [&](bool holds, std::string_view text) {
    if (!holds) throw InvalidArgument(fmt::format("{}: {}", owner, text));
  };
  for (std::size_t i = 0; i < times_.size(); ++i)
    require(std::isfinite(times_[i]) && (i == 0 || times_[i] > times_[i - 1]), "times must be finite and increasing");
  require(std::isfinite(cycle) && cycle >= 0.0, "cycle must be 0 or more");
  if (cycle == 0.0 || times_.empty()) return;
  require(cycle >= times_.back() - times_.front(), "cycle must be at least the time from the first to the last frame");
}

double SampleTimes::in_cycle(double time) const {
  const double since = time - times_.front();
  const double phase = since - std::floor(since / cycle_) * cycle_;
  return times_.front() + (phase >= 0.0 && phase < cycle_ ? phase : 0.0);
}

// Behind the last sample of a cycle is the first one, or that behind it if the two are at one time.
SampleTimes::Neighbour SampleTimes::after(std::size_t sample) const {
  if (sample + 1 < size()) return {sample + 1, times_[sample + 1] - times_[sample]};
  return gap() > 0.0 ? Neighbour{0, gap()} : Neighbour{1, times_[1] - times_[0]};
}

SampleTimes::Neighbour SampleTimes::before(std::size_t sample) const {
  if (sample > 0) return {sample - 1, times_[sample] - times_[sample - 1]};
  const std::size_t last = size() - 1;
  return gap() > 0.0 ? Neighbour{last, gap()} : Neighbour{last - 1, times_[last] - times_[last - 1]};
}

SampleWeights SampleTimes::at(double time) const {
  const double t = repeat() ? in_cycle(time) : time;
  const auto behind = static_cast<std::size_t>(std::upper_bound(times_.begin(), times_.end(), t) - times_.begin());
  const std::size_t first = behind == 0 ? 0 : behind - 1;
  if (size() == 1 || (!repeat() && (behind == 0 || behind == size()))) return {1, {first}, {1.0}};
  const Neighbour second = after(first);
  const double share = std::min((t - times_[first]) / second.distance, 1.0);
  if (interpolation_ == Interpolation::cubic) return cubic(first, second, share);
  return {2, {first, second.sample}, {1 - share, share}};
}

// Hermite's cubic between two samples. The velocity at a sample is that of the parabola through it and its neighbours.
// At the first and the last one of a series that does not repeat it is that of the straight way.
SampleWeights SampleTimes::cubic(std::size_t first, const Neighbour& second, double share) const {
  const double s = share, h = second.distance;
  std::array<double, 4> w = {0.0, (1 + 2 * s) * (1 - s) * (1 - s), s * s * (3 - 2 * s), 0.0};
  // A velocity times h is `outer` times the difference on the outer side, and `inner` times that in between.
  double outer = 0.0, inner = 1.0;
  const auto set_shares = [&](double g) {
    outer = h * h / (g * (g + h));
    inner = g / (g + h);
  };
  const bool has_before = repeat() || first > 0;
  const bool has_after = repeat() || second.sample + 1 < size();
  const Neighbour outside = has_before ? before(first) : Neighbour{};
  if (has_before) set_shares(outside.distance);
  const double at_first = s * (1 - s) * (1 - s);
  w[0] -= at_first * outer;
  w[1] += at_first * (outer - inner);
  w[2] += at_first * inner;
  outer = 0.0, inner = 1.0;
  const Neighbour beyond = has_after ? after(second.sample) : Neighbour{};
  if (has_after) set_shares(beyond.distance);
  const double at_second = s * s * (s - 1);
  w[1] -= at_second * inner;
  w[2] += at_second * (inner - outer);
  w[3] += at_second * outer;
  if (!has_before) return {has_after ? std::size_t{3} : 2, {first, second.sample, beyond.sample}, {w[1], w[2], w[3]}};
  return {has_after ? std::size_t{4} : 3, {outside.sample, first, second.sample, beyond.sample}, w};
}

}  // namespace dartcast
