// The amounts and classes of particles in a tally.
#include "simulation/tally_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/closest_word.hpp"
#include "dartcast/error.hpp"
#include "dartcast/statistics.hpp"

namespace dartcast {

namespace {

void check_bounds(const std::vector<double>& bounds) {
  constexpr std::size_t most = 255;
  if (bounds.size() > most)
    throw InvalidArgument(fmt::format("statistics: {} bounds of classes: give at most {}", bounds.size(), most));
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    if (!std::isfinite(bounds[i]) || (i > 0 && !(bounds[i - 1] < bounds[i])))
      throw InvalidArgument("statistics: the bounds of classes must be finite, and increase");
  }
}

}  // namespace

TallyPlan::TallyPlan(const StatisticsOptions& statistics, const SimulationOptions& options, const StartTimes& starts)
    : options_(options), starts_(starts), by_class_(!statistics.classes_of.empty()), bounds_(statistics.class_bounds) {
  for (const std::string& quantity : statistics.cells) {
    for (const Source source : sources_of(quantity)) {
      if (!has(source)) sources_.push_back(source);
    }
  }
  if (!by_class_ && !bounds_.empty())
    throw InvalidArgument("statistics: there are bounds of classes: say of which value they are");
  check_bounds(bounds_);
  if (by_class_ && statistics.classes_of != "diameter") class_column_ = column_of(statistics.classes_of);
}

// Those over volume and time have the sources of those that are not.
std::vector<TallyPlan::Source> TallyPlan::sources_of(std::string_view quantity) const {
  if (quantity.starts_with("momentum")) return {Source::momentum_x, Source::momentum_y, Source::momentum_z};
  if (quantity.starts_with("energy")) return {Source::energy};
  if (quantity == "mean_age") return {Source::age};
  if (!quantity.starts_with(of_user_data)) return {};
  return {
      static_cast<Source>(static_cast<std::size_t>(Source::user) + column_of(quantity.substr(of_user_data.size())))};
}

bool TallyPlan::has(Source source) const {
  return std::find(sources_.begin(), sources_.end(), source) != sources_.end();
}

std::size_t TallyPlan::column_of(std::string_view name) const {
  const std::vector<std::string>& names = options_.user_data;
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw InvalidArgument(fmt::format("statistics: particles have no user data \"{}\"{}: name it there", name,
                                      did_you_mean(std::string(name), names)));
  return static_cast<std::size_t>(found - names.begin());
}

std::uint32_t TallyPlan::amount_of(std::string_view quantity) const {
  const auto found = std::find(sources_.begin(), sources_.end(), sources_of(quantity).front());
  return static_cast<std::uint32_t>(found - sources_.begin());
}

std::uint32_t TallyPlan::class_of(const ParticleSet& set, std::size_t i) const {
  if (!by_class_) return 0;
  const double value = class_column_ ? set.user_data(i)[*class_column_] : set.table[set.table.diameter][i];
  return static_cast<std::uint32_t>(std::upper_bound(bounds_.begin(), bounds_.end(), value) - bounds_.begin());
}

std::vector<std::uint32_t> TallyPlan::classes_of(const ParticleSet& set) const {
  std::vector<std::uint32_t> classes;
  for (std::size_t i = 0; by_class_ && i < set.table.rows(); ++i) classes.push_back(class_of(set, i));
  return classes;
}

// Numbers of user data may be infinite, or none: they count as 0. Particles that have left have no amounts.
TallyValues TallyPlan::values(const ParticleSet& set, const Parcels& parcels, std::span<const DragLoss> losses,
                              double middle) const {
  TallyValues v{parcels.numbers(set), classes_of(set), {}};
  const std::size_t count = set.table.rows();
  v.amounts.reserve(count * sources_.size());
  for (std::size_t i = 0; i < count && !sources_.empty(); ++i) {
    const bool left = leaves(set.statuses()[i]);
    const Parcel parcel = parcels.parcel(set, i);
    const auto number = static_cast<double>(parcel.number);
    for (const Source source : sources_) {
      double amount = 0.0;
      switch (source) {
        case Source::momentum_x: amount = parcel.mass * losses[i].momentum.x; break;
        case Source::momentum_y: amount = parcel.mass * losses[i].momentum.y; break;
        case Source::momentum_z: amount = parcel.mass * losses[i].momentum.z; break;
        case Source::energy: amount = parcel.mass * losses[i].energy; break;
        case Source::age: amount = number * (middle - starts_.of(set.ids()[i])); break;
        default:
          amount = number * set.user_data(i)[static_cast<std::size_t>(source) - static_cast<std::size_t>(Source::user)];
      }
      v.amounts.push_back(left || !std::isfinite(amount) ? 0.0 : amount);
    }
  }
  return v;
}

}  // namespace dartcast
