// The quantities by cell of a simulation, from its tally.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/closest_word.hpp"
#include "complex/simplex.hpp"
#include "dartcast/cell_tally.hpp"
#include "dartcast/error.hpp"
#include "dartcast/simulation.hpp"
#include "dartcast/statistics.hpp"

namespace dartcast {

namespace {

// In the plane its area.
double volume(const CellComplex& complex, Cell c) {
  const bool plane = complex.map().dimension() == 2;
  double sum = 0.0;
  for (std::uint16_t s = 0; s < complex.map().shape(c).simplices().size(); ++s)
    sum += volume_value(complex.corners({c, s}));
  return std::max(sum, 0.0) / (plane ? 2.0 : 6.0);
}

double value(const Simulation& s, const CellTally& tally, const std::string& quantity, Cell c) {
  const double step = s.options().dt / s.options().substeps;
  if (quantity == "track_length") return tally.track_length(c);
  if (quantity == "residence") return tally.residence(c) * step;
  if (quantity == "visits") return static_cast<double>(tally.visits(c));
  if (quantity == "deposition") return static_cast<double>(tally.deposited(c));
  const double whole = volume(s.environment().complex(), c) * s.time();
  return whole > 0.0 ? tally.residence(c) * step / whole : 0.0;
}

}  // namespace

std::vector<std::string> cell_quantities() {
  return {"track_length", "residence", "visits", "deposition", "concentration"};
}

void check_cell_quantities(std::span<const std::string> names) {
  const std::vector<std::string> known = cell_quantities();
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw InvalidArgument(fmt::format("statistics: there is no quantity \"{}\" by cell{}; there are {}", name,
                                        did_you_mean(name, known), fmt::join(known, ", ")));
    if (std::count(names.begin(), names.end(), name) > 1)
      throw InvalidArgument(fmt::format("statistics: the quantity \"{}\" by cell is asked for twice", name));
  }
}

std::vector<DataArray> Simulation::cell_arrays(const CellTally& tally) const {
  const std::vector<Cell> cells = environment().map().cells();
  std::vector<DataArray> arrays;
  for (const std::string& quantity : statistics_options().cells) {
    DataArray& array = arrays.emplace_back(DataArray{quantity, 1, {}});
    for (const Cell c : cells) array.values.push_back(value(*this, tally, quantity, c));
  }
  return arrays;
}

}  // namespace dartcast
