// The step of one particle, cut where it passes from cell to cell: Environment::trace().
#pragma once

#include <vector>

#include "dartcast/contact.hpp"
#include "dartcast/particle_state.hpp"
#include "tracking/crossing.hpp"
#include "tracking/step.hpp"

namespace dartcast {

/// What a particle does on its way to one target. Its cell goes from `before` through each crossing to `after`.
struct Trace {
  ParticleState before;
  Forecast start;  ///< of `before`: the paper's kind and dart; of no meaning where it is held
  std::vector<Crossing> crossings;
  ContactList contacts;  ///< by time
  ParticleState after;   ///< the bits that Environment::advance() gives
  Forecast end;          ///< of `after`, as `start`
  StepResult result;     ///< whether it was held, or stopped at its last contact
};

}  // namespace dartcast
