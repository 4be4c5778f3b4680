// The quantities by cell of a simulation, from its tally.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>

#include "base/closest_word.hpp"
#include "complex/simplex.hpp"
#include "dartcast/cell_tally.hpp"
#include "dartcast/error.hpp"
#include "dartcast/simulation.hpp"
#include "dartcast/statistics.hpp"
#include "simulation/simulation_parts.hpp"

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

bool is_vector(std::string_view quantity) { return quantity.starts_with("momentum"); }

double ratio(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

// The time of the sums, s.
double duration(const Simulation& s) {
  const std::uint64_t every = s.statistics_options().cells_every;
  if (every == 0 || s.steps() == 0) return s.time();
  return static_cast<double>((s.steps() - 1) % every + 1) * s.options().dt;
}

// The values of a class in all cells. Sums of amounts that are shared by time are those of steps.
class ClassArrays {
 public:
  ClassArrays(const Simulation& simulation, const CellTally& tally, const TallyPlan& plan, std::uint32_t of_class)
      : s_(simulation),
        tally_(tally),
        plan_(plan),
        class_(of_class),
        step_(simulation.options().dt / simulation.options().substeps),
        duration_(duration(simulation)) {}

  void append(const std::string& quantity, Cell c, std::vector<double>& values) const {
    if (!is_vector(quantity)) return values.push_back(scalar(quantity, c));
    const double per = quantity == "momentum" ? 1.0 : per_volume(c);
    const std::uint32_t first = plan_.amount_of(quantity);
    for (std::uint32_t k = first; k < first + 3; ++k) values.push_back(tally_.amount(c, k, class_) * per);
  }

 private:
  [[nodiscard]] double per_volume(Cell c) const {
    return ratio(1.0, volume(s_.environment().complex(), c) * duration_);
  }

  [[nodiscard]] double scalar(const std::string& quantity, Cell c) const {
    if (quantity == "track_length") return tally_.track_length(c, class_);
    if (quantity == "residence") return tally_.residence(c, class_) * step_;
    if (quantity == "visits") return static_cast<double>(tally_.visits(c, class_));
    if (quantity == "deposition") return static_cast<double>(tally_.deposited(c, class_));
    if (quantity == "concentration") return tally_.residence(c, class_) * step_ * per_volume(c);
    const double amount = tally_.amount(c, plan_.amount_of(quantity), class_);
    if (quantity == "mean_age") return ratio(amount, tally_.residence(c, class_));
    if (quantity == "energy_source") return amount * per_volume(c);
    return quantity == "energy" ? amount : amount * step_;
  }

  const Simulation& s_;
  const CellTally& tally_;
  const TallyPlan& plan_;
  std::uint32_t class_;
  double step_;      // s
  double duration_;  // s
};

}  // namespace

std::vector<std::string> cell_quantities() {
  return {"track_length", "residence", "visits", "deposition",      "concentration",
          "mean_age",     "momentum",  "energy", "momentum_source", "energy_source"};
}

void check_cell_quantities(std::span<const std::string> names) {
  const std::vector<std::string> known = cell_quantities();
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) == known.end() && !name.starts_with(of_user_data))
      throw InvalidArgument(fmt::format("statistics: there is no quantity \"{}\" by cell{}; there are {}, user:NAME",
                                        name, did_you_mean(name, known), fmt::join(known, ", ")));
    if (std::count(names.begin(), names.end(), name) > 1)
      throw InvalidArgument(fmt::format("statistics: the quantity \"{}\" by cell is asked for twice", name));
  }
}

std::vector<DataArray> Simulation::cell_arrays(const CellTally& tally) const {
  const std::vector<Cell> cells = environment().map().cells();
  const TallyPlan& plan = *parts_->statistics.plan();
  const std::string& classes = statistics_options().classes_of;
  std::vector<DataArray> arrays;
  const auto add = [&](std::uint32_t of_class, const std::string& ending) {
    const ClassArrays values(*this, tally, plan, of_class);
    for (const std::string& quantity : statistics_options().cells) {
      DataArray& array = arrays.emplace_back(DataArray{quantity + ending, is_vector(quantity) ? 3U : 1U, {}});
      for (const Cell c : cells) values.append(quantity, c, array.values);
    }
  };
  add(CellTally::all_classes, "");
  for (std::uint32_t k = 0; !classes.empty() && k < tally.classes(); ++k) add(k, fmt::format("_{}_{}", classes, k));
  return arrays;
}

}  // namespace dartcast
