// Whose steps are added to a tally.
#pragma once

#include <span>

namespace dartcast {
class CellTally;  // dartcast/cell_tally.hpp
}

namespace dartcast::detail {

/// The tally that steps are added to; null: none. `radii`: if not empty, only steps of particles with 0 there are.
struct Tallied {
  CellTally* tally = nullptr;
  std::span<const double> radii;
};

}  // namespace dartcast::detail
