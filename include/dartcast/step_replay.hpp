// One step of one particle with the cells around it: enough to take the step again, alone (dartcast/replay.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dartcast/contact.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/step.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

/// A step that went wrong, or may have. Cells and faces are those of `mesh`, as an Environment made from it numbers them.
struct StepReplay {
  /// The patch of the faces behind which the replay has no cells.
  static constexpr const char* cut_patch = "cut off";

  std::string reason;         ///< what is wrong, in words
  MeshData mesh;              ///< the cells around, as they were before the move
  std::vector<Vec3> moved;    ///< the points after the move; empty: there was none
  bool simultaneous = false;  ///< taken by SimultaneousStepper::advance(), else by Environment::advance()
  ParticleState state;        ///< before the step
  Weights weights{};          ///< of a held particle
  Vec3 target;
  StepOptions options;
  bool responds = false;              ///< else the particle stops at its first contact
  std::vector<AfterContact> answers;  ///< to its contacts, in their order. It stops after the last one
  std::optional<Vec3> end;            ///< where the step ended
};

}  // namespace dartcast
