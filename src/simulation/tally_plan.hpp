// The numbers that the tally of a simulation adds of each particle. Not installed.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "dartcast/cell_tally.hpp"
#include "simulation/force_step.hpp"
#include "simulation/parcels.hpp"
#include "simulation/particle_set.hpp"
#include "simulation/start_times.hpp"

namespace dartcast {

struct StatisticsOptions;  // dartcast/statistics.hpp

/// Quantities that begin so are user data of the name behind it.
inline constexpr std::string_view of_user_data = "user:";

/// The values of TalliedParticles for a segment.
struct TallyValues {
  std::vector<std::uint64_t> numbers;
  std::vector<std::uint32_t> classes;
  std::vector<double> amounts;

  [[nodiscard]] TalliedParticles spans() const { return {numbers, classes, amounts}; }
};

/// The amounts and classes that statistics ask for.
class TallyPlan {
 public:
  /// Throws InvalidArgument if a name is not one of user data, or classes are not as StatisticsOptions says. `starts`: of the
  /// particles, if needs_ages(). Options and starts outlive this.
  TallyPlan(const StatisticsOptions& statistics, const SimulationOptions& options, const StartTimes& starts);

  [[nodiscard]] std::uint32_t classes() const { return static_cast<std::uint32_t>(bounds_.size() + 1); }
  [[nodiscard]] std::uint32_t amounts() const { return static_cast<std::uint32_t>(sources_.size()); }
  [[nodiscard]] bool needs_losses() const { return has(Source::momentum_x) || has(Source::energy); }
  [[nodiscard]] bool needs_ages() const { return has(Source::age); }
  /// The number of the first amount that this quantity is made of. Precondition: it is made of some.
  [[nodiscard]] std::uint32_t amount_of(std::string_view quantity) const;

  [[nodiscard]] std::uint32_t class_of(const ParticleSet& set, std::size_t i) const;
  /// Those of all particles; empty if there are no classes.
  [[nodiscard]] std::vector<std::uint32_t> classes_of(const ParticleSet& set) const;
  /// The values of a segment. `middle`: its time, s. `losses`: by particle, if needs_losses().
  [[nodiscard]] TallyValues values(const ParticleSet& set, const Parcels& parcels, std::span<const DragLoss> losses,
                                   double middle) const;

 private:
  // Where an amount comes from; from `user` on, the columns of user data.
  enum class Source : std::uint32_t { momentum_x, momentum_y, momentum_z, energy, age, user };
  [[nodiscard]] std::vector<Source> sources_of(std::string_view quantity) const;
  [[nodiscard]] bool has(Source source) const;
  [[nodiscard]] std::size_t column_of(std::string_view name) const;

  const SimulationOptions& options_;
  const StartTimes& starts_;
  std::vector<Source> sources_;  // of the amounts
  bool by_class_;
  std::vector<double> bounds_;
  std::optional<std::size_t> class_column_;  // of user data; none: the diameter
};

}  // namespace dartcast
