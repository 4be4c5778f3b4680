// At rest a filter in vectors proves most cells positive; exact signs decide the others. A motion is decided as
// dartcast/validity.hpp does it.
#include "dynamics/flat_cells.hpp"

#include <cstdint>

#include "complex/positive_cells.hpp"
#include "dartcast/validity.hpp"

namespace dartcast {

namespace {

// Whether a cell has a simplex that is not positive.
bool is_flat(const CellComplex& complex, Cell c, std::span<const Vec3> positions) {
  const CellView cell = complex.map().view(c);
  const std::uint32_t* v = cell.vertices().data();
  return detail::not_proved_positive(cell.shape(), {v, v, v, v}, positions.data()) != 0 &&
         check_cell(complex.map(), positions, c).has_value();
}

}  // namespace

std::optional<double> first_flat_time(const CellComplex& complex, std::span<const Cell> cells,
                                      const VertexMotion& walls) {
  std::optional<double> first;
  for (const Cell c : cells) {
    if (walls.at_rest()) {
      if (is_flat(complex, c, walls.after)) return 0.0;
      continue;
    }
    const auto flat = first_inversion(complex.map(), walls.before, walls.after, c, first.value_or(1.0));
    if (flat) first = flat->how.safe_time;
  }
  return first;
}

}  // namespace dartcast
