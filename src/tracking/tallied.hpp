// Whose steps are added to a tally.
#pragma once

#include <cstdint>
#include <span>

namespace dartcast {
class CellTally;  // dartcast/cell_tally.hpp
}

namespace dartcast::detail {

/// The tally that steps are added to, and how.
struct Tallied {
  CellTally* tally = nullptr;              ///< null: none
  std::span<const std::uint64_t> numbers;  ///< how often each particle's step is added; empty: once
  std::span<const double> radii;           ///< if not empty, only steps of particles with 0 there are added
};

}  // namespace dartcast::detail
