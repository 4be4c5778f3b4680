// Whose steps are added to a tally.
#pragma once

#include <span>

#include "dartcast/cell_tally.hpp"

namespace dartcast::detail {

/// The tally that steps are added to, and how.
struct Tallied {
  CellTally* tally = nullptr;  ///< null: none
  TalliedParticles particles;
  std::span<const double> radii;  ///< if not empty, only steps of particles with 0 there are added
};

}  // namespace dartcast::detail
