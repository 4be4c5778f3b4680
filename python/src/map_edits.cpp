// Binds dartcast/map_edits.hpp: drafts, edits, orbits, integrity. The class Transaction is in transaction.cpp.
#include "dartcast/map_edits.hpp"

#include "bind.hpp"
#include "support/members.hpp"
#include "support/python.hpp"
#include "transaction.hpp"

namespace py = pybind11;

namespace dartcast::python::map_edits {
namespace {

void expect_dimension(unsigned dimension) {
  if (dimension != 2 && dimension != 3) throw InvalidArgument("dimension: expected 2 or 3");
}

void bind_forms(py::module_& m) {
  m.def(
      "form_of",
      [](const CellDraft& draft, unsigned dimension) {
        expect_dimension(dimension);
        return form_of(draft, dimension);
      },
      about("form_of"));
  m.def(
      "forms_of",
      [](const std::vector<CellDraft>& drafts, unsigned dimension) {
        expect_dimension(dimension);
        return forms_of(drafts, dimension);
      },
      py::arg("drafts"), py::arg("dimension"), "form_of() of several drafts.");
}

void bind_edits(py::module_& m) {
  m.def(
      "split_cell",
      [](const TransactionHandle& h, const std::vector<Dart>& path) {
        return change(h, [&](Transaction& t) {
          for (const Dart d : path) expect_dart(t.map(), d);
          const auto cells = split_cell(t, path);
          return std::vector<Cell>(cells.begin(), cells.end());
        });
      },
      about("split_cell"));
  function(m, "remove", static_cast<void (*)(Transaction&, Cell)>(&dartcast::remove));
}

void bind_questions(py::module_& m) {
  m.def(
      "find_dart",
      [](const MapHandle& h, Cell c, Vertex from, Vertex to) {
        return read(h, [&](const CombinatorialMap& map) { return or_none(find_dart(map, c, from, to)); });
      },
      about("find_dart"));
  m.def(
      "check_integrity",
      [](const MapHandle& h, const std::optional<std::vector<Cell>>& cells, std::size_t max_count) {
        return read_long(h, [&](const CombinatorialMap& map) {
          if (!cells) return check_integrity(map, max_count);
          for (const Cell c : *cells) expect_cell(map, c);
          return check_integrity(map, *cells, max_count);
        });
      },
      py::arg("map"), py::arg("cells") = py::none(), py::arg("max_count") = 100, doc("check_integrity"));
}

}  // namespace

void bind(py::module_& m) {
  bind_forms(m);
  transaction::bind(m);
  bind_edits(m);
  bind_questions(m);
}

}  // namespace dartcast::python::map_edits
