// The extension module dartcast._core. The package (python/dartcast) gives its names to users.
#include <pybind11/pybind11.h>

#include <cstddef>
#include <exception>

#include "bind.hpp"
#include "dartcast/run.hpp"
#include "support/records.hpp"
#include "support/signatures.hpp"

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

// An object that Class.__new__(Class) made has no C++ object. At its first use pybind11 would give it memory without
// content, and asks this function for it.
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
  prepare_records(m);
#define DARTCAST_BIND(name) name::bind(m);
  DARTCAST_PARTS(DARTCAST_BIND)
#undef DARTCAST_BIND
  records::bind_in_classes(m);
  refuse_first_uses(m);
  write_signatures(m);
}
