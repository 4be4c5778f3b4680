// The eddies that carry particles in a turbulent flow: a discrete random walk. Not installed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/keyed_random.hpp"
#include "dartcast/simulation.hpp"
#include "simulation/sampled_fields.hpp"

namespace dartcast {

/// Numbers of user data in which a particle keeps the velocity of its eddy, and how long it stays in it.
inline constexpr std::array<const char*, 4> eddy_numbers = {"eddy_x", "eddy_y", "eddy_z", "eddy_left"};

class Eddies {
 public:
  /// Throws InvalidArgument if the options contradict each other, or lack numbers of user data. They outlive it.
  Eddies(const SimulationOptions& options, bool planar);

  [[nodiscard]] bool act() const { return acts_; }
  [[nodiscard]] RandomMoment moment(std::uint64_t segment) const {
    return {options_.seed, RandomPurpose::eddy, segment};
  }

  /// A particle that crosses eddies. None of these: it goes along with them.
  struct Crossing {
    double slip = 0.0;        ///< m / s, relative to the mean flow
    double relaxation = 0.0;  ///< s
  };
  /// The velocity that a particle's eddy adds in the next `duration` seconds. Draws a new eddy if the last one has ended.
  Vec3 velocity(std::span<double> numbers, const RandomMoment& moment, std::uint64_t id, double duration,
                const Crossing& crossing) const;

  /// The same where a wall damps it: TurbulenceOptions::wall_distance.
  [[nodiscard]] Vec3 damped(const Vec3& velocity, std::span<const double> numbers,
                            const SampledFields::Value& distance) const;

 private:
  struct Eddy {
    double speed = 0.0;  // the standard deviation of each component
    double life = 0.0;   // s; 0: there is none
  };
  [[nodiscard]] Eddy eddy_at(std::span<const double> numbers, const Crossing& crossing) const;

  const SimulationOptions& options_;
  bool acts_;
  bool planar_;
  std::size_t energy_ = 0;  // columns of user data
  std::size_t rate_ = 0;
  std::size_t state_ = 0;
};

}  // namespace dartcast
