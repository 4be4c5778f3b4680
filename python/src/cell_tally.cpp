// Binds dartcast/cell_tally.hpp. A tally belongs to the environment that it was made for, and is in use when that is.
#include "dartcast/cell_tally.hpp"

#include <memory>

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

  explicit TallyHandle(std::shared_ptr<EnvironmentHandle> of)
      : environment(std::move(of)), tally(environment->environment->complex()) {}
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

void bind_sums(TallyClass& c) {
  c.def(
      "track_length",
      [](const TallyHandle& t) { return t.of_cells<double>([&](Cell cell) { return t.tally.track_length(cell); }); },
      about("CellTally::track_length", order));
  c.def(
      "residence",
      [](const TallyHandle& t) { return t.of_cells<double>([&](Cell cell) { return t.tally.residence(cell); }); },
      about("CellTally::residence", order));
  c.def(
      "visits",
      [](const TallyHandle& t) { return t.of_cells<std::uint64_t>([&](Cell cell) { return t.tally.visits(cell); }); },
      about("CellTally::visits", order));
  c.def(
      "deposited",
      [](const TallyHandle& t) {
        return t.of_cells<std::uint64_t>([&](Cell cell) { return t.tally.deposited(cell); });
      },
      about("CellTally::deposited", order));
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

}  // namespace

void bind(py::module_& m) {
  TallyClass c(m, "CellTally", doc("CellTally"));
  c.def(py::init<std::shared_ptr<EnvironmentHandle>>(), py::arg("environment").none(false),
        about("CellTally::CellTally", "environment: the one whose steps and edits it will follow."));
  bind_sums(c);
  c.def(
      "take_back",
      [](TallyHandle& t, Cell cell, double time) {
        const Use in_use = t.use();
        require_cell(t, cell);
        t.tally.take_back(cell, time);
      },
      about("CellTally::take_back"));
  c.def(
      "deposit",
      [](TallyHandle& t, Cell cell, std::uint64_t number) {
        const Use in_use = t.use();
        require_cell(t, cell);
        t.tally.deposit(cell, number);
      },
      about("CellTally::deposit"));
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
  EnvironmentClass e = m.attr("Environment");
  e.def(
      "set_tally",
      [](const EnvironmentHandle& h, const std::shared_ptr<TallyHandle>& t) {
        const Use in_use = h.use();
        Environment& environment = h.changeable("ask for StatisticsOptions.cells");
        if (t && t->environment->environment != &environment)
          throw InvalidArgument("set_tally: the tally is of another environment: make one of this");
        environment.set_tally(t ? &t->tally : nullptr);
      },
      py::arg("tally"), py::keep_alive<1, 2>(), doc("Environment::set_tally"));
}

}  // namespace dartcast::python::cell_tally
