// Whether all implicit simplices are positive: the whole-scene check, a streaming pass.
#pragma once

#include <optional>
#include <vector>

#include "dartcast/cell_complex.hpp"

namespace dartcast {

struct Validity {
  std::size_t cells_checked = 0;
  std::size_t invalid_count = 0;
  std::vector<InvalidCell> first;  ///< at most `max_count`, by cell

  [[nodiscard]] bool valid() const { return invalid_count == 0; }
};

/// The first simplex of a cell that is not positive at the given positions, or nothing. Exact.
std::optional<InvalidCell> check_cell(const CombinatorialMap& map, std::span<const Vec3> positions, Cell c);

/// Checks every cell at the current positions. Cost: linear, parallel; the result does not depend on the threads.
Validity check_validity(const CellComplex& complex, Threads threads = {}, std::size_t max_count = 10);
Validity check_validity(const CombinatorialMap& map, std::span<const Vec3> positions, Threads threads,
                        std::size_t max_count);

}  // namespace dartcast
