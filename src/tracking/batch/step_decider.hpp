// Decides steps in place of Stepper: those of points that meet walls while both move.
#pragma once

#include <cstdint>
#include <span>

#include "dartcast/contact.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/step.hpp"

namespace dartcast::detail {

/// The part of the program that takes a step.
enum class StepTaker : std::uint8_t {
  decider,  ///< the decider
  walk,     ///< a walk that meets no wall and ends at the target, if there is one; else the decider
  carried   ///< the batch and Stepper, with contacts
};

/// Any number of threads may call it at once.
class StepDecider {
 public:
  StepDecider() = default;
  StepDecider(const StepDecider&) = delete;
  StepDecider& operator=(const StepDecider&) = delete;
  virtual ~StepDecider() = default;

  /// For each particle.
  virtual void choose(std::span<const ParticleState> states, std::span<const Vec3> targets,
                      std::span<StepTaker> takers) const = 0;
  /// As Stepper::step().
  virtual StepResult step(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                          ContactList& contacts, Counters& counters) const = 0;
};

}  // namespace dartcast::detail
