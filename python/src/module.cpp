// The extension module dartcast._core. The package (python/dartcast) gives its names to users.
#include <pybind11/pybind11.h>

#include <cstddef>
#include <exception>

#include "bind.hpp"
#include "dartcast/run.hpp"

namespace py = pybind11;

namespace {

// A class of pybind11 without a C++ type, such as the base of all, has no objects. Python asks that base for one when it
// pickles with protocol 0 or 1. pybind11 would throw through Python's code, which ends the process.
PyObject* new_object(PyTypeObject* type, PyObject* arguments, PyObject* /*named*/) {
  try {
    if (!py::detail::all_type_info(type).empty()) return py::detail::make_new_instance(type);
    if (PyTuple_GET_SIZE(arguments) == 1) {
      PyErr_Format(PyExc_TypeError, "cannot pickle '%s' object", Py_TYPE(PyTuple_GET_ITEM(arguments, 0))->tp_name);
    } else {
      PyErr_Format(PyExc_TypeError, "cannot create '%s' instances", type->tp_name);
    }
  } catch (const std::exception&) {
    PyErr_NoMemory();
  }
  return nullptr;
}

// An object that Class.__new__(Class) made has no C++ object. pybind11 would give it memory without content at its first
// use, and asks this function for it.
void* refuse_first_use(std::size_t /*size*/) {
  throw py::type_error("this object was never initialised: make it by a call of its class, which runs __init__()");
}

void refuse_first_uses(const py::module_& m) {
  for (const auto& [cpp_type, info] : py::detail::get_internals().registered_types_cpp) {
    const py::handle made(reinterpret_cast<PyObject*>(info->type));
    if (made.attr("__module__").equal(m.attr("__name__"))) info->operator_new = refuse_first_use;
  }
}

}  // namespace

PYBIND11_MODULE(_core, m) {
  // Classes inherit it when they are made.
  reinterpret_cast<PyTypeObject*>(py::detail::get_internals().instance_base)->tp_new = new_object;
  using namespace dartcast::python;  // NOLINT(google-build-using-namespace): a function for each header
  m.doc() = "Bindings of the C++ library dartcast.";
  m.attr("__version__") = dartcast::version();
  py::options options;
  options.disable_function_signatures();
  errors::bind(m);
  ids::bind(m);

  mesh_data::bind(m);
  mesh_check::bind(m);
  mesh_files::bind(m);
  mesh_selection::bind(m);
  decompose::bind(m);
  generators::bind(m);
  mesh_part::bind(m);

  predicates::bind(m);
  cell_shape::bind(m);
  combinatorial_map::bind(m);
  map_edits::bind(m);
  cell_complex::bind(m);
  complex_edit::bind(m);
  cutting::bind(m);
  remeshing::bind(m);
  validity::bind(m);

  threads::bind(m);
  particle_state::bind(m);
  contact::bind(m);
  step::bind(m);
  response::bind(m);
  environment::bind(m);
  audit::bind(m);
  shared_environment::bind(m);
  spheres::bind(m);
  dynamics::bind(m);
  trajectory::bind(m);
  deformation::bind(m);
  vector_field::bind(m);

  surface::bind(m);
  solids::bind(m);
  bodies::bind(m);
  catheter::bind(m);
  statistics::bind(m);
  simulation::bind(m);
  events::bind(m);
  scene::bind(m);
  report::bind(m);
  plan::bind(m);
  run::bind(m);
  refuse_first_uses(m);
}
