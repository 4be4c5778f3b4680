// How many particles each particle stands for, and what they weigh. Not installed.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dartcast/simulation.hpp"
#include "simulation/particle_set.hpp"

namespace dartcast {

/// The name of the number of user data that says how many.
inline constexpr const char* parcel_number = "number";
inline constexpr std::uint64_t most_in_parcel = 0xffffffffU;

class Parcels {
 public:
  explicit Parcels(const SimulationOptions& options);

  /// Whether any may stand for several.
  [[nodiscard]] bool exist() const { return column_.has_value(); }
  /// At least 1.
  [[nodiscard]] std::uint64_t number(const ParticleSet& set, std::size_t i) const;
  /// One for each particle; empty if no parcels exist.
  [[nodiscard]] std::vector<std::uint64_t> numbers(const ParticleSet& set) const;
  [[nodiscard]] Parcel parcel(const ParticleSet& set, std::size_t i) const;

 private:
  const SimulationOptions& options_;
  std::optional<std::size_t> column_;
};

/// The impact at each contact of a step. Precondition: it has parcels.
std::vector<Impact> impacts_of(const SimulationStep& step, const SimulationOptions& options);

}  // namespace dartcast
