// Sums trapezoids once, then finds the piece of a time.
#include "simulation/rate_integral.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dartcast/error.hpp"

namespace dartcast {

namespace {

void check(const Waveform& w) {
  const auto fail = [](const std::string& message) { throw InvalidArgument("an inlet's waveform: " + message); };
  if (w.times.size() != w.factors.size())
    fail(fmt::format("{} times for {} factors", w.times.size(), w.factors.size()));
  for (std::size_t k = 0; k < w.times.size(); ++k) {
    if (!std::isfinite(w.times[k]) || (k > 0 && !(w.times[k] > w.times[k - 1])))
      fail(fmt::format("time {} (counted from 0) is {} s: times must be finite and increase", k, w.times[k]));
    if (!std::isfinite(w.factors[k]) || !(w.factors[k] >= 0.0))
      fail(fmt::format("factor {} (counted from 0) is {}: it must be finite and not negative", k, w.factors[k]));
  }
  if (w.period == 0.0) return;
  if (w.times.size() < 2) fail("it has a period, but not two times");
  if (!std::isfinite(w.period) || !(w.period >= w.times.back() - w.times.front()))
    fail(fmt::format("the period is {} s: it must not be less than the {} s from the first time to the last", w.period,
                     w.times.back() - w.times.front()));
}

}  // namespace

RateIntegral::RateIntegral(const Waveform& waveform)
    : times_(waveform.times), factors_(waveform.factors), period_(waveform.period) {
  check(waveform);
  if (times_.empty()) return;
  largest_ = *std::max_element(factors_.begin(), factors_.end());
  if (period_ > 0.0 && times_.front() + period_ > times_.back()) {
    times_.push_back(times_.front() + period_);
    factors_.push_back(factors_.front());
  }
  sums_.push_back(0.0);
  for (std::size_t k = 1; k < times_.size(); ++k)
    sums_.push_back(sums_.back() + (times_[k] - times_[k - 1]) * (0.5 * (factors_[k] + factors_[k - 1])));
  at_zero_ = from_first_time(0.0);
}

double RateIntegral::operator()(double t) const { return times_.empty() ? t : from_first_time(t) - at_zero_; }

double RateIntegral::from_first_time(double t) const {
  if (period_ > 0.0) {
    const double turns = std::floor((t - times_.front()) / period_);
    return turns * sums_.back() + in_piece(t - turns * period_);
  }
  if (t <= times_.front()) return (t - times_.front()) * factors_.front();
  if (t >= times_.back()) return sums_.back() + (t - times_.back()) * factors_.back();
  return in_piece(t);
}

// Never beyond the sums at the piece's ends: rounding there would take particles back.
double RateIntegral::in_piece(double t) const {
  const auto after = std::upper_bound(times_.begin() + 1, times_.end() - 1, t);
  const auto k = static_cast<std::size_t>(after - times_.begin()) - 1;
  const double h = t - times_[k];
  const double slope = (factors_[k + 1] - factors_[k]) / (times_[k + 1] - times_[k]);
  return std::clamp(sums_[k] + h * (factors_[k] + 0.5 * h * slope), sums_[k], sums_[k + 1]);
}

}  // namespace dartcast
