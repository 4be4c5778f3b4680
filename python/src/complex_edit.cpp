// Binds dartcast/complex_edit.hpp. An edit of a complex alone is a context manager. An edit of an environment is open
// during the call of the function given to edit().
#include "dartcast/complex_edit.hpp"

#include "bind.hpp"
#include "support/edit_reports.hpp"
#include "support/members.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::complex_edit {
namespace {

using Class = py::class_<EditHandle, std::shared_ptr<EditHandle>>;

py::array_t<double> updated(const ComplexEditReport& report, std::size_t size, const Typed<"Floats">& given) {
  const bool is_flat = is_array(given, 1);
  const bool right = py::isinstance<py::array_t<double, py::array::c_style>>(given) &&
                     (is_flat || py::reinterpret_borrow<py::array>(given).ndim() == 2);
  if (!right)
    refuse_array(given, "values", "float64 (n,) or (n, components), C-contiguous",
                 "numpy.ascontiguousarray(x, dtype=float)");
  const auto values = py::reinterpret_borrow<py::array_t<double>>(given);
  expect_report(report, size);
  const auto rows = static_cast<std::size_t>(values.shape(0));
  const std::size_t columns = is_flat ? 1 : static_cast<std::size_t>(values.shape(1));
  std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(size)};
  if (!is_flat) shape.push_back(static_cast<py::ssize_t>(columns));
  py::array_t<double> made(shape);
  for (std::size_t k = 0; k < columns; ++k) {
    std::vector<double> column(rows);
    for (std::size_t i = 0; i < rows; ++i) column[i] = values.data()[i * columns + k];
    update_after_edit(report, size, column);
    for (std::size_t i = 0; i < size; ++i) made.mutable_data()[i * columns + k] = column[i];
  }
  return made;
}

void bind_positions(Class& c) {
  c.def(
      "position",
      [](const EditHandle& h, const Typed<"Vertex | Integers">& v) -> py::array_t<double> {
        if (!py::isinstance<py::array>(v)) {
          const auto one = v.cast<Vertex>();
          return py::cast(change(h, [&](ComplexEdit& e) { return e.position(one); }));
        }
        const auto vertices = v.cast<std::vector<Vertex>>();
        return py::cast(change(h, [&](ComplexEdit& e) {
          std::vector<Vec3> positions;
          for (const Vertex w : vertices) positions.push_back(e.position(w));
          return positions;
        }));
      },
      about("ComplexEdit::position", "Of an array of vertices: float64 (n, 3)."));
  c.def(
      "place", [](const EditHandle& h, Vertex v, const Vec3& x) { change(h, [&](ComplexEdit& e) { e.place(v, x); }); },
      py::arg("v"), py::arg("x"), doc("ComplexEdit::place"));
  c.def(
      "place",
      [](const EditHandle& h, Vertex v, const std::vector<Vertex>& of, const std::vector<double>& weights) {
        change(h, [&](ComplexEdit& e) { e.place(v, of, weights); });
      },
      py::arg("v"), py::arg("of"), py::arg("weights"));
}

ComplexEditReport commit(const EditHandle& h) {
  return change(h, [&](ComplexEdit& e) {
    if (!h.own) throw InvalidArgument("the call that opened this edit commits it, when the function returns");
    h.savepoints->clear();
    return e.commit();
  });
}

void bind_ends(Class& c) {
  c.def(
      "savepoint",
      [](const EditHandle& h) {
        return change(h, [&](ComplexEdit& e) { return SavepointHandle{h.savepoints->add(e.savepoint())}; });
      },
      "A point in the sequence to which roll_back() can return.");
  c.def(
      "roll_back",
      [](const EditHandle& h, const SavepointHandle& to) {
        change(h, [&](ComplexEdit& e) { e.roll_back(h.savepoints->return_to(to.number)); });
      },
      py::arg("to"),
      "Undoes everything after the savepoint. Raises InvalidArgument where that is none of this edit, or was itself "
      "undone.");
  members_of_ComplexEdit(c);
  c.def("commit", &commit,
        about("ComplexEdit::commit",
              "Raises InvalidArgument in an edit of an environment: that commits it when the function returns."));
  c.def("__enter__", [](const std::shared_ptr<EditHandle>& h) {
    static_cast<void>(h->open());
    return h;
  });
  c.def("__exit__", [](EditHandle& h, const py::args& /*raised*/) {
    if (!h.own) throw InvalidArgument("this edit is no context manager: it ends with the call that made it");
    h.end();
  });
}

}  // namespace

void bind(py::module_& m) {
  Class c(m, "ComplexEdit",
          about("ComplexEdit",
                "An edit of a complex of its own is a context manager: leaving its block without commit() undoes it. "
                "While it is open, the complex can be read through `edit.map` and `edit.position()` only. An "
                "environment gives an edit to the function of its edit()."));
  c.def(py::init([](const std::shared_ptr<ComplexHandle>& complex) {
          auto made = std::make_shared<EditHandle>();
          const py::gil_scoped_release release;
          made->own = std::make_unique<OwnEdit>(complex);
          made->edit = &made->own->edit;
          return made;
        }),
        py::arg("complex").none(false),
        "Opens an edit. Raises InvalidArgument where the complex belongs to an environment, and InUse where another "
        "edit of it is open.");
  c.def_property_readonly(
      "topology",
      [](const std::shared_ptr<EditHandle>& h) {
        static_cast<void>(h->open());
        return std::make_shared<TransactionHandle>(TransactionHandle{h, nullptr, h->usage, h->savepoints});
      },
      doc("ComplexEdit::topology"));
  c.def_property_readonly(
      "map", [](const std::shared_ptr<EditHandle>& h) { return map_of(h); },
      "The map as it is now. It can be read until the edit ends.");
  bind_positions(c);
  bind_ends(c);
  m.def("update_after_edit", &updated, py::arg("report"), py::arg("size"), py::arg("values"),
        about("update_after_edit", "values: float64 (n,) or (n, components). Returns a fresh array of `size` rows."));
}

}  // namespace dartcast::python::complex_edit
