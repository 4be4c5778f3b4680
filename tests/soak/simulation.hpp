// A simulation as the one who moves the vertices, with all that it can have in it, and twins that must reach its state.
#pragma once

#include <memory>
#include <string>

#include "soak/movers.hpp"

namespace dartcast::soak {

std::unique_ptr<Mover> make_simulation_mover(const Case& c, const SceneMesh& scene, Environment& environment);

}  // namespace dartcast::soak
