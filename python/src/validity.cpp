// Binds dartcast/validity.hpp.
#include "dartcast/validity.hpp"

#include "bind.hpp"
#include "support/map_checks.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::validity {
namespace {

void expect_time(double time, const char* name) {
  if (!(time >= 0.0 && time <= 1.0)) throw InvalidArgument(std::string(name) + ": expected a time from 0 to 1");
}

void bind_checks(py::module_& m) {
  m.def(
      "check_cell",
      [](const MapHandle& h, const Typed<"Points">& given, Cell c) {
        const auto positions = vectors(given, "positions");
        return read(h, [&](const CombinatorialMap& map) {
          expect_positions(map, positions.size(), "positions");
          expect_cell(map, c);
          return check_cell(map, positions, c);
        });
      },
      about("check_cell"));
  m.def(
      "check_validity",
      [](const ComplexHandle& h, Threads threads, std::size_t max_count) {
        check_threads(threads);
        return read_long(h, [&](const CellComplex& complex) { return check_validity(complex, threads, max_count); });
      },
      py::arg("complex"), py::arg("threads") = Threads{}, py::arg("max_count") = 10, doc("check_validity"));
  m.def(
      "check_validity",
      [](const MapHandle& h, const Typed<"Points">& given, Threads threads, std::size_t max_count) {
        check_threads(threads);
        const auto positions = vectors(given, "positions");
        return read_long(h, [&](const CombinatorialMap& map) {
          expect_positions(map, positions.size(), "positions");
          return check_validity(map, positions, threads, max_count);
        });
      },
      py::arg("map"), py::arg("positions"), py::arg("threads") = Threads{}, py::arg("max_count") = 10,
      "The same for a map and the positions of all its vertices.");
}

void bind_inversions(py::module_& m) {
  m.def(
      "find_inversion",
      [](const Corners& before, const Corners& after, double until) {
        expect_time(until, "until");
        return find_inversion(before, after, until);
      },
      about("find_inversion"));
  m.def(
      "first_inversion",
      [](const ComplexHandle& h, Threads threads) {
        check_threads(threads);
        return read_long(h, [&](const CellComplex& complex) { return first_inversion(complex, threads); });
      },
      py::arg("complex"), py::arg("threads") = Threads{}, doc("first_inversion"));
  m.def(
      "first_inversion",
      [](const MapHandle& h, const Typed<"Points">& given_before, const Typed<"Points">& given_after,
         std::optional<Cell> cell, double until, Threads threads) {
        check_threads(threads);
        expect_time(until, "until");
        const auto before = vectors(given_before, "before");
        const auto after = vectors(given_after, "after");
        if (!cell && until != 1.0) throw InvalidArgument("until: name a cell, too");
        return read_long(h, [&](const CombinatorialMap& map) {
          expect_positions(map, before.size(), "before");
          expect_positions(map, after.size(), "after");
          if (!cell) return first_inversion(map, before, after, threads);
          expect_cell(map, *cell);
          return first_inversion(map, before, after, *cell, until);
        });
      },
      py::arg("map"), py::arg("before"), py::arg("after"), py::arg("c") = py::none(), py::arg("until") = 1.0,
      py::arg("threads") = Threads{},
      "The same for a map and any motion of its vertices: float64 (vertex_count, 3); or for one cell, up to a time.");
  m.def(
      "move_towards",
      [](const ComplexHandle& h, const Typed<"Points">& given_before, const Typed<"Points">& given_after, double time,
         Threads threads) -> Typed<"tuple[float, Points]"> {
        check_threads(threads);
        expect_time(time, "time");
        const auto before = vectors(given_before, "before");
        const auto after = vectors(given_after, "after");
        std::vector<Vec3> positions(before.size());
        const double reached = read_long(h, [&](const CellComplex& c) {
          return move_towards(c.map(), c.steiner_weights(), before, after, time, positions, threads);
        });
        return py::make_tuple(reached, array_of(std::span<const Vec3>(positions)));
      },
      py::arg("complex"), py::arg("before"), py::arg("after"), py::arg("time"), py::arg("threads") = Threads{},
      about("move_towards",
            "before, after: float64 (n, 3), of all vertices. Returns (time, positions). The weights are those of the "
            "complex."));
}

}  // namespace

void bind(py::module_& m) {
  bind_checks(m);
  bind_inversions(m);
}

}  // namespace dartcast::python::validity
