// Size distributions: normal deviates are drawn until one lies between the cuts, all others are inverted.
#include "simulation/size_sampler.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/elementary.hpp"
#include "base/keyed_random.hpp"
#include "base/normal_deviates.hpp"
#include "dartcast/error.hpp"

namespace dartcast {

namespace {

void refuse_unless(bool fits, const char* what, double value) {
  if (!fits) throw InvalidArgument(fmt::format("simulation: a size distribution's {}: it is {}", what, value));
}

bool is_size(double d) { return d >= smallest_density && d <= largest_density; }

// Simpson's rule.
template <class Function>
double integral(double low, double high, Function&& f) {
  constexpr int pieces = 8192;  // even
  const double step = (high - low) / pieces;
  double sum = f(low) + f(high);
  for (int i = 1; i < pieces; ++i) sum += (i % 2 == 1 ? 4.0 : 2.0) * f(low + i * step);
  return sum * step / 3.0;
}

constexpr double per_root_of_turn = 0.3989422804014327;  // 1 / sqrt(2 pi)
constexpr double share_to_leave = 0.01;

}  // namespace

SizeSampler::SizeSampler(const SizeDistribution& sizes, std::uint64_t seed) : sizes_(sizes), seed_(seed) {
  if (sizes_.law == SizeLaw::table) {
    take_table();
    return;
  }
  refuse_unless(is_size(sizes_.size), "size must be between 2^-100 and 2^100", sizes_.size);
  const bool lognormal = sizes_.law == SizeLaw::lognormal;
  refuse_unless(sizes_.spread > (lognormal ? 1.0 : 0.0) && std::isfinite(sizes_.spread),
                lognormal ? "geometric deviation must be above 1" : "spread must be above 0", sizes_.spread);
  refuse_unless(sizes_.min >= 0.0, "min must not be negative", sizes_.min);
  refuse_unless(sizes_.max > sizes_.min && is_size(sizes_.max), "max must be above min, and at most 2^100", sizes_.max);
  is_normal() ? take_normal() : take_rosin_rammler();
}

void SizeSampler::take_table() {
  refuse_unless(!sizes_.diameters.empty() && sizes_.diameters.size() == sizes_.shares.size(),
                "table needs a share for each diameter", static_cast<double>(sizes_.shares.size()));
  double sum = 0.0;
  for (std::size_t i = 0; i < sizes_.shares.size(); ++i) {
    const double d = sizes_.diameters[i];
    refuse_unless(is_size(d), "diameters must be between 2^-100 and 2^100", d);
    refuse_unless(sizes_.shares[i] >= 0.0 && std::isfinite(sizes_.shares[i]), "shares must be finite and not negative",
                  sizes_.shares[i]);
    up_to_.push_back(sum += sizes_.shares[i]);
    mean_cube_ += sizes_.shares[i] * d * d * d;
  }
  refuse_unless(sum > 0.0 && std::isfinite(sum), "shares must have a sum above 0", sum);
  mean_cube_ /= sum;
}

double SizeSampler::at_deviate(double z) const {
  if (sizes_.law == SizeLaw::normal) return sizes_.size + sizes_.spread * z;
  return sizes_.size * exponential(logarithm(sizes_.spread) * z);
}

double SizeSampler::cut_deviate(double diameter) const {
  if (sizes_.law == SizeLaw::normal) return (diameter - sizes_.size) / sizes_.spread;
  return logarithm(diameter / sizes_.size) / logarithm(sizes_.spread);
}

// The cube of a lognormal size has its mass 3 logarithmic deviations farther out.
void SizeSampler::take_normal() {
  const double out = sizes_.law == SizeLaw::normal ? 9.0 : 9.0 + 3.0 * logarithm(sizes_.spread);
  const double low = std::max(-9.0, cut_deviate(sizes_.min));
  const double high = std::min(out, cut_deviate(sizes_.max));
  const auto density = [](double z) { return per_root_of_turn * exponential(-0.5 * z * z); };
  const double share = low < high ? integral(low, high, density) : 0.0;
  refuse_unless(share >= share_to_leave, "cuts must leave 1% of it at least", share);
  const auto cube = [&](double z) {
    const double d = at_deviate(z);
    return d * d * d * density(z);
  };
  mean_cube_ = integral(low, high, cube) / share;
}

// The share below d is 1 - exp(-(d / size)^spread). The mean is taken over the logarithm of d.
void SizeSampler::take_rosin_rammler() {
  const auto above = [&](double d) { return exponential(-power(d / sizes_.size, sizes_.spread)); };
  least_ = 1.0 - above(sizes_.min);
  most_ = 1.0 - above(sizes_.max);
  refuse_unless(most_ - least_ >= share_to_leave, "cuts must leave 1% of it at least", most_ - least_);
  const double low = std::max(-50.0 / sizes_.spread, sizes_.min > 0.0 ? logarithm(sizes_.min / sizes_.size) : -1e300);
  const double high = std::min(logarithm(60.0) / sizes_.spread, logarithm(sizes_.max / sizes_.size));
  const auto cube = [&](double y) {
    const double t = exponential(sizes_.spread * y);
    return sizes_.spread * t * exponential(-t) * exponential(3.0 * y);
  };
  mean_cube_ = integral(low, high, cube) / (most_ - least_) * (sizes_.size * sizes_.size * sizes_.size);
}

double SizeSampler::diameter(std::uint64_t id) const {
  KeyedRandom random(seed_, RandomPurpose::size, id);
  if (sizes_.law == SizeLaw::table) {
    const double place = random.uniform() * up_to_.back();
    const auto found = std::upper_bound(up_to_.begin(), up_to_.end() - 1, place);
    return sizes_.diameters[static_cast<std::size_t>(found - up_to_.begin())];
  }
  if (!is_normal()) {
    const double share = least_ + random.uniform() * (most_ - least_);
    const double d = sizes_.size * power(-logarithm(1.0 - share), 1.0 / sizes_.spread);
    return std::clamp(d, std::max(sizes_.min, smallest_density), sizes_.max);
  }
  // Each draw has a chance of 1% at least: so many fail less often than once in 10^40.
  for (int tries = 0; tries < 10'000; ++tries) {
    const std::uint64_t bits = random.next();
    const double z =
        normal_deviates({static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(bits >> 32U), 0, 0})[0];
    const double d = at_deviate(z);
    if (d >= sizes_.min && d <= sizes_.max && is_size(d)) return d;
  }
  return sizes_.size;
}

}  // namespace dartcast
