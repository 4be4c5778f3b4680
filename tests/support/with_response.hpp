// Options of a simulation with a response at all walls.
#pragma once

#include "dartcast/simulation.hpp"

namespace dartcast::test {

inline SimulationOptions with_response(SimulationOptions options, const WallResponse& response) {
  options.response = response;
  return options;
}

}  // namespace dartcast::test
