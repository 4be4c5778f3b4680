// Watches a step: notes the answers to its contacts, audits its end, and makes a replay of what went wrong.
#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <unordered_map>
#include <vector>

#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/step_replay.hpp"

namespace dartcast {

/// A step of a set of particles, watched for Environment::set_replay_hook().
class WatchedStep {
 public:
  /// Copies the particles as they are before the step. Targets must live as long.
  WatchedStep(const Environment& environment, const Particles& particles, std::span<const Vec3> targets,
              const StepOptions& options, bool simultaneous);

  // Callbacks that answer as these, and note it. An empty one stays empty.
  ContactCallback noted(const ContactCallback& respond);
  RoundCallback noted(const RoundCallback& respond);

  /// Calls `take`. If it throws an InternalError with a replay, the hook gets that.
  template <class Take>
  auto run(Take&& take) const {
    try {
      return take();
    } catch (const InternalError& e) {
      if (e.replay()) environment_.replay_hook()(*e.replay());
      throw;
    }
  }
  /// Audits the states after the step. The hook gets the step of the first particle that fails.
  void check(std::span<const ParticleState> states, std::span<const Weights> weights) const;
  /// The step of a particle, with the answers noted so far.
  [[nodiscard]] StepReplay replay_of(std::uint32_t particle) const;

 private:
  void note(std::uint32_t particle, const AfterContact& answer);

  const Environment& environment_;
  Particles before_;
  std::span<const Vec3> targets_;
  StepOptions options_;
  bool simultaneous_;
  bool responds_ = false;
  std::mutex mutex_;                                                      // of the answers
  std::unordered_map<std::uint32_t, std::vector<AfterContact>> answers_;  // to each particle's contacts, in their order
};

}  // namespace dartcast
