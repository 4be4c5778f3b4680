#include "support/volume.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace dartcast::test {

Dyadic volume6(const CellComplex& complex, std::span<const Cell> cells) {
  Dyadic sum;
  for (const Cell c : cells) {
    EXPECT_TRUE(complex.map().contains(c));
    for (std::uint16_t s = 0; s < complex.map().shape(c).simplices().size(); ++s) {
      const Corners v = complex.corners({c, s});
      sum += determinant(v[0], v[1], v[2], v[3]);
    }
  }
  return sum;
}

Dyadic volume6(const CellComplex& complex) { return volume6(complex, complex.map().cells()); }

Dyadic free_volume6(const CellComplex& complex) {
  std::vector<Cell> free;
  for (const Cell c : complex.map().cells()) {
    if (complex.map().is_free(c)) free.push_back(c);
  }
  return volume6(complex, free);
}

}  // namespace dartcast::test
