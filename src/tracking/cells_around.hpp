// The cells around a particle's way as a small mesh of their own, for a replay of its step.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/error.hpp"
#include "dartcast/step_replay.hpp"

namespace dartcast::detail {

/// The vertices of a scene before and after a move; the same span twice if there was none.
struct ReplayPlaces {
  std::span<const Vec3> before;
  std::span<const Vec3> after;
};

/// A replay of a step from `state` to `target`. It has the cells whose boxes, grown by their own size, meet one of the
/// straight `ways`, and those in `passed`. Cost: linear in the scene.
StepReplay replay_of(const CombinatorialMap& map, const ReplayPlaces& places, const ParticleState& state,
                     const Vec3& target, std::span<const std::pair<Vec3, Vec3>> ways, std::vector<Cell> passed = {});

/// An error that has the replay of the step that met it. `what`: in words, from whom and what.
InternalError error_with_replay(const std::string& what, StepReplay replay);

}  // namespace dartcast::detail
