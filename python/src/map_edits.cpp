// Binds dartcast/map_edits.hpp: drafts, edits, orbits, integrity. The class Transaction is in transaction.cpp.
#include "dartcast/map_edits.hpp"

#include "bind.hpp"
#include "support/edits.hpp"
#include "support/map_checks.hpp"
#include "support/python.hpp"
#include "transaction.hpp"

namespace py = pybind11;

namespace dartcast::python::map_edits {
namespace {

void bind_drafts(py::module_& m) {
  Record<DraftCorner>(m, "DraftCorner")
      .field("vertex", &DraftCorner::vertex)
      .field("straight", &DraftCorner::straight)
      .field("coplanar", &DraftCorner::coplanar)
      .finish();
  Record<DraftLink>(m, "DraftLink")
      .field("face", &DraftLink::face)
      .field("draft", &DraftLink::draft)
      .field("draft_face", &DraftLink::draft_face)
      .finish()
      .attr("NO_DRAFT") = DraftLink::no_draft;
  Record<DraftFace>(m, "DraftFace")
      .field("corners", &DraftFace::corners)
      .field("across", &DraftFace::across)
      .field("from_", &DraftFace::from, "from")
      .field("patch", &DraftFace::patch)
      .field("point", &DraftFace::point)
      .finish();
  Record<CellDraft>(m, "CellDraft")
      .field("faces", &CellDraft::faces)
      .field("point", &CellDraft::point)
      .field("free", &CellDraft::free)
      .field("source", &CellDraft::source)
      .finish();
  Record<DraftForm>(m, "DraftForm")
      .field("pool", &DraftForm::pool)
      .field("corners", &DraftForm::corners)
      .field("local", &DraftForm::local)
      .field("face", &DraftForm::face)
      .field("defect", &DraftForm::defect)
      .finish();
}

void expect_dimension(unsigned dimension) {
  if (dimension != 2 && dimension != 3) throw InvalidArgument("dimension: expected 2 or 3");
}

void bind_forms(py::module_& m) {
  m.def(
      "draft_of",
      [](const MapHandle& h, Cell c) {
        return read(h, [&](const CombinatorialMap& map) {
          expect_cell(map, c);
          return draft_of(map, c);
        });
      },
      py::arg("map"), py::arg("c"), doc("draft_of"));
  m.def(
      "form_of",
      [](const CellDraft& draft, unsigned dimension) {
        expect_dimension(dimension);
        return form_of(draft, dimension);
      },
      py::arg("draft"), py::arg("dimension") = 3, doc("form_of"));
  m.def(
      "forms_of",
      [](const std::vector<CellDraft>& drafts, unsigned dimension) {
        expect_dimension(dimension);
        return forms_of(drafts, dimension);
      },
      py::arg("drafts"), py::arg("dimension"), "form_of() of several drafts.");
}

void bind_reports(py::module_& m) {
  Record<CreatedVertex>(m, "CreatedVertex")
      .field("vertex", &CreatedVertex::vertex)
      .field("from_", &CreatedVertex::from, "from")
      .field("other", &CreatedVertex::other)
      .finish();
  Record<MergedVertex>(m, "MergedVertex")
      .field("gone", &MergedVertex::gone)
      .field("merged_into", &MergedVertex::merged_into)
      .finish();
  Record<EditReport>(m, "EditReport")
      .field("removed", &EditReport::removed)
      .field("added", &EditReport::added)
      .field("marked", &EditReport::marked)
      .field("created", &EditReport::created)
      .field("merged", &EditReport::merged)
      .field("deleted", &EditReport::deleted)
      .finish();
  Record<SplitEdge>(m, "SplitEdge").field("vertex", &SplitEdge::vertex).field("cells", &SplitEdge::cells).finish();
}

// An edit with one argument, or two, of a transaction. It checks them itself.
template <class Result, class A>
void bind_edit(py::module_& m, const char* name, Result (*edit)(Transaction&, A), const char* a) {
  m.def(
      name, [edit](const TransactionHandle& h, A x) { return change(h, [&](Transaction& t) { return edit(t, x); }); },
      py::arg("t"), py::arg(a), doc(name));
}
template <class Result>
void bind_edit(py::module_& m, const char* name, Result (*edit)(Transaction&, Dart, Dart)) {
  m.def(
      name,
      [edit](const TransactionHandle& h, Dart a, Dart b) {
        return change(h, [&](Transaction& t) { return edit(t, a, b); });
      },
      py::arg("t"), py::arg("a"), py::arg("b"), doc(name));
}

void bind_edits(py::module_& m) {
  bind_edit(m, "split_edge", &split_edge, "d");
  bind_edit(m, "split_face", &split_face);
  m.def(
      "split_cell",
      [](const TransactionHandle& h, const std::vector<Dart>& path) {
        return change(h, [&](Transaction& t) {
          for (const Dart d : path) expect_dart(t.map(), d);
          const auto cells = split_cell(t, path);
          return std::vector<Cell>(cells.begin(), cells.end());
        });
      },
      py::arg("t"), py::arg("path"), doc("split_cell"));
  bind_edit(m, "merge_cells", &merge_cells, "f");
  bind_edit(m, "merge_faces", &merge_faces, "d");
  bind_edit(m, "merge_edges", &merge_edges, "d");
  bind_edit(m, "sew", &sew);
  bind_edit(m, "unsew", &unsew, "f");
  bind_edit(m, "remove", static_cast<void (*)(Transaction&, Cell)>(&dartcast::remove), "c");
}

void bind_orbit(py::module_& m, const char* name, std::vector<Dart> (*orbit)(const CombinatorialMap&, Dart)) {
  m.def(
      name,
      [orbit](const MapHandle& h, Dart d) {
        return read(h, [&](const CombinatorialMap& map) {
          expect_dart(map, d);
          return orbit(map, d);
        });
      },
      py::arg("map"), py::arg("d"), doc(name));
}

void bind_questions(py::module_& m) {
  m.def(
      "find_dart",
      [](const MapHandle& h, Cell c, Vertex from, Vertex to) {
        return read(h, [&](const CombinatorialMap& map) { return find_dart(map, c, from, to); });
      },
      py::arg("map"), py::arg("c"), py::arg("from_"), py::arg("to"), doc("find_dart"));
  bind_orbit(m, "vertex_orbit", &vertex_orbit);
  bind_orbit(m, "edge_orbit", &edge_orbit);
  bind_orbit(m, "face_orbit", &face_orbit);
  bind_orbit(m, "cell_orbit", &cell_orbit);
  Record<Violation>(m, "Violation")
      .field("constraint", &Violation::constraint)
      .field("dart", &Violation::dart)
      .field("message", &Violation::message)
      .finish();
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
  bind_drafts(m);
  bind_forms(m);
  bind_reports(m);
  transaction::bind(m);
  bind_edits(m);
  bind_questions(m);
}

}  // namespace dartcast::python::map_edits
