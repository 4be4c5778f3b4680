// The volume of a complex, exactly.
#pragma once

#include <span>

#include "dartcast/cell_complex.hpp"
#include "support/dyadic.hpp"

namespace dartcast::test {

/// Six times the volume of some cells; of all of them; of those that are free.
Dyadic volume6(const CellComplex& complex, std::span<const Cell> cells);
Dyadic volume6(const CellComplex& complex);
Dyadic free_volume6(const CellComplex& complex);

}  // namespace dartcast::test
