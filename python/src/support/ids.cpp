// Numbers from and to Python.
#include "support/ids.hpp"

#include <string>

namespace py = pybind11;

namespace dartcast::python {

py::handle tuple_type(const char* name) { return py::module_::import("dartcast._ids").attr(name).ptr(); }

bool load_integer(py::handle from, std::uint64_t largest, std::uint64_t& value) {
  if (PyIndex_Check(from.ptr()) == 0) return false;
  const auto number = py::reinterpret_steal<py::object>(PyNumber_Index(from.ptr()));
  if (!number) throw py::error_already_set();
  value = PyLong_AsUnsignedLongLong(number.ptr());
  const bool failed = PyErr_Occurred() != nullptr;
  if (failed) PyErr_Clear();
  if (failed || value > largest) {
    throw py::value_error(py::str(number).cast<std::string>() + " is no number from 0 to " + std::to_string(largest));
  }
  return true;
}

namespace {

// Whether this is a row of a structured array, such as each item of Surface.triangles().
bool is_row(py::handle from) { return py::hasattr(from, "dtype") && !from.attr("dtype").attr("names").is_none(); }

}  // namespace

bool load_pair(py::handle from, std::array<std::uint64_t, 2>& values) {
  if ((!py::isinstance<py::tuple>(from) && !is_row(from)) || PyObject_Length(from.ptr()) != 2) {
    PyErr_Clear();
    return false;
  }
  const auto pair = py::reinterpret_borrow<py::sequence>(from);
  return load_integer(pair[0], 0xffffffffU, values[0]) && load_integer(pair[1], 0xffffU, values[1]);
}

}  // namespace dartcast::python
