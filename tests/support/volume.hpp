// The volume of a complex, exactly.
#pragma once

#include <gtest/gtest.h>

#include <span>

#include "dartcast/cell_complex.hpp"
#include "support/dyadic.hpp"

namespace dartcast::test {

/// Six times the volume of some cells, exactly.
inline Dyadic volume6(const CellComplex& complex, std::span<const Cell> cells) {
  Dyadic sum;
  for (const Cell c : cells) {
    EXPECT_TRUE(complex.map().contains(c));
    for (std::uint16_t s = 0; s < complex.map().shape(c).simplices().size(); ++s) {
      const Corners v = complex.corners({c, s});
      sum = sum + determinant(v[0], v[1], v[2], v[3]);
    }
  }
  return sum;
}
inline Dyadic volume6(const CellComplex& complex) { return volume6(complex, complex.map().cells()); }

}  // namespace dartcast::test
