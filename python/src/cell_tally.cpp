// Binds dartcast/cell_tally.hpp. A tally belongs to the environment that it was made for, and is in use when that is.
#include "dartcast/cell_tally.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bind.hpp"
#include "dartcast/complex_edit.hpp"
#include "support/environments.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::cell_tally {
namespace {

struct TallyHandle {
  std::shared_ptr<EnvironmentHandle> environment;
  CellTally tally;
  std::vector<std::uint64_t> numbers;  // of the particles, as the next two
  std::vector<std::uint32_t> classes;
  std::vector<double> amounts;

  TallyHandle(std::shared_ptr<EnvironmentHandle> of, std::uint32_t class_count, std::uint32_t amount_count)
      : environment(std::move(of)), tally(environment->environment->complex(), class_count, amount_count) {}
  TallyHandle(const TallyHandle&) = delete;
  TallyHandle& operator=(const TallyHandle&) = delete;
  ~TallyHandle() {
    if (environment->environment->tally() == &tally) environment->environment->set_tally(nullptr);
  }

  [[nodiscard]] Use use() const { return Use(*environment->usage, "the environment"); }
  void expect_followed() const {
    if (!tally.fits(environment->environment->complex()))
      throw InvalidArgument("CellTally: it has missed an edit: call update_after_edit() after each one");
  }
  // A value for each cell, in the order of CombinatorialMap.cells().
  template <class T, class Get>
  [[nodiscard]] py::array_t<T> of_cells(const Get& get) const {
    const Use in_use = use();
    expect_followed();
    std::vector<T> values;
    for (const Cell c : environment->environment->map().cells()) values.push_back(get(c));
    return array_of(std::move(values));
  }
};

using TallyClass = py::class_<TallyHandle, std::shared_ptr<TallyHandle>>;

constexpr const char* order = "For each cell, in the order of map.cells().";

// None: of all classes.
std::uint32_t class_in(const TallyHandle& t, std::optional<std::uint32_t> of_class) {
  if (of_class && *of_class >= t.tally.classes())
    throw InvalidArgument("CellTally: there is no class " + std::to_string(*of_class) + ": there are " +
                          std::to_string(t.tally.classes()));
  return of_class.value_or(CellTally::all_classes);
}

void require_amount(const TallyHandle& t, std::uint32_t which) {
  if (which >= t.tally.amounts())
    throw InvalidArgument("CellTally: there is no amount " + std::to_string(which) + ": there are " +
                          std::to_string(t.tally.amounts()));
}

void bind_sums(TallyClass& c) {
  const auto of_cells = [&]<class T>(const char* name, T (CellTally::*get)(Cell, std::uint32_t) const) {
    c.def(
        name,
        [get](const TallyHandle& t, std::optional<std::uint32_t> of_class) {
          const std::uint32_t k = class_in(t, of_class);
          return t.of_cells<T>([&](Cell cell) { return (t.tally.*get)(cell, k); });
        },
        py::arg("of_class") = py::none(), about(std::string("CellTally::") + name, order));
  };
  of_cells("track_length", &CellTally::track_length);
  of_cells("residence", &CellTally::residence);
  of_cells("visits", &CellTally::visits);
  of_cells("deposited", &CellTally::deposited);
  c.def(
      "amount",
      [](const TallyHandle& t, std::uint32_t which, std::optional<std::uint32_t> of_class) {
        require_amount(t, which);
        const std::uint32_t k = class_in(t, of_class);
        return t.of_cells<double>([&](Cell cell) { return t.tally.amount(cell, which, k); });
      },
      py::arg("which"), py::arg("of_class") = py::none(), about("CellTally::amount", order));
  c.def_property_readonly(
      "classes", [](const TallyHandle& t) { return t.tally.classes(); }, "The number of classes.");
  c.def_property_readonly(
      "amounts", [](const TallyHandle& t) { return t.tally.amounts(); }, "The number of amounts.");
  c.def(
      "whole_amount",
      [](const TallyHandle& t, std::uint32_t which) {
        const Use in_use = t.use();
        require_amount(t, which);
        return t.tally.whole_amount(which);
      },
      py::arg("which"), "The sum of an amount over all particles.");
  const auto whole = [&](const char* name, auto get) {
    c.def(
        name,
        [get](const TallyHandle& t) {
          const Use in_use = t.use();
          return get(t.tally);
        },
        doc(std::string("CellTally::") + name));
  };
  whole("path_length", [](const CellTally& t) { return t.path_length(); });
  whole("age", [](const CellTally& t) { return t.age(); });
  whole("adds_up", [](const CellTally& t) { return t.adds_up(); });
}

void require_cell(const TallyHandle& t, Cell c) {
  t.expect_followed();
  if (!t.environment->environment->map().contains(c)) throw InvalidArgument("CellTally: the map has no such cell");
}

void bind_changes(TallyClass& c) {
  c.def(
      "take_back",
      [](TallyHandle& t, Cell cell, double time, std::uint32_t of_class) {
        const Use in_use = t.use();
        require_cell(t, cell);
        t.tally.take_back(cell, time, class_in(t, of_class));
      },
      py::arg("c"), py::arg("time"), py::arg("of_class") = 0, about("CellTally::take_back"));
  c.def(
      "take_back_amounts",
      [](TallyHandle& t, Cell cell, const std::vector<double>& amounts, std::uint32_t of_class) {
        const Use in_use = t.use();
        require_cell(t, cell);
        if (amounts.size() != t.tally.amounts() ||
            !std::all_of(amounts.begin(), amounts.end(), [](double a) { return std::isfinite(a); }))
          throw InvalidArgument("take_back_amounts: give a finite number for each amount of the tally");
        t.tally.take_back_amounts(cell, amounts, class_in(t, of_class));
      },
      py::arg("c"), py::arg("amounts"), py::arg("of_class") = 0, about("CellTally::take_back_amounts"));
  c.def(
      "deposit",
      [](TallyHandle& t, Cell cell, std::uint64_t number, std::uint32_t of_class) {
        const Use in_use = t.use();
        require_cell(t, cell);
        t.tally.deposit(cell, number, class_in(t, of_class));
      },
      py::arg("c"), py::arg("number") = 1, py::arg("of_class") = 0, about("CellTally::deposit"));
  c.def(
      "update_after_edit",
      [](TallyHandle& t) {
        const Use in_use = t.use();
        t.tally.update_after_edit(t.environment->environment->complex(), t.environment->environment->last_edit());
      },
      "Follows the environment's last edit: the sums of cells that it removed go to the cells in their place, by "
      "volume. "
      "Call it once after each edit.");
  c.def(
      "reset",
      [](TallyHandle& t) {
        const Use in_use = t.use();
        t.tally.reset(t.environment->environment->complex());
      },
      "Begins anew, without sums.");
}

}  // namespace

void bind(py::module_& m) {
  TallyClass c(m, "CellTally", doc("CellTally"));
  c.def(py::init<std::shared_ptr<EnvironmentHandle>, std::uint32_t, std::uint32_t>(),
        py::arg("environment").none(false), py::arg("classes") = 1, py::arg("amounts") = 0,
        about("CellTally::CellTally", "environment: the one whose steps and edits it will follow."));
  bind_sums(c);
  bind_changes(c);
  EnvironmentClass e = m.attr("Environment");
  e.def(
      "set_tally",
      [](const EnvironmentHandle& h, const std::shared_ptr<TallyHandle>& t,
         std::optional<std::vector<std::uint64_t>> numbers, std::optional<std::vector<std::uint32_t>> classes,
         std::optional<std::vector<double>> amounts) {
        const Use in_use = h.use();
        Environment& environment = h.changeable("ask for StatisticsOptions.cells");
        if (!t) return environment.set_tally(nullptr);
        if (t->environment->environment != &environment)
          throw InvalidArgument("set_tally: the tally is of another environment: make one of this");
        t->numbers = std::move(numbers).value_or(std::vector<std::uint64_t>());
        t->classes = std::move(classes).value_or(std::vector<std::uint32_t>());
        t->amounts = std::move(amounts).value_or(std::vector<double>());
        environment.set_tally(&t->tally, {t->numbers, t->classes, t->amounts});
      },
      py::arg("tally"), py::arg("numbers") = py::none(), py::arg("classes") = py::none(),
      py::arg("amounts") = py::none(), py::keep_alive<1, 2>(),
      about("Environment::set_tally",
            "numbers, classes: one for each particle, or none. amounts: those of one particle after the other."));
}

}  // namespace dartcast::python::cell_tally
