// Arrays of whole numbers from NumPy.
#include "support/integers.hpp"

namespace py = pybind11;

namespace dartcast::python {

py::array_t<std::int64_t> wide_integers(const py::object& x, const std::string& name, std::size_t columns) {
  const std::string expected =
      columns == 0 ? std::string("whole numbers (n,)") : "whole numbers (n, " + std::to_string(columns) + ")";
  constexpr const char* remedy = "numpy.asarray(x, dtype=numpy.int64)";
  const auto a = py::array::ensure(x);
  if (!a) {
    PyErr_Clear();
    refuse_array(x, name.c_str(), expected.c_str(), remedy);
  }
  const bool is_empty = a.size() == 0 && a.ndim() == 1;  // an empty list has no integers, and no columns
  const bool right_kind = a.dtype().kind() == 'i' || a.dtype().kind() == 'u';
  const bool right_shape =
      columns == 0 ? a.ndim() == 1 : a.ndim() == 2 && a.shape(1) == static_cast<py::ssize_t>(columns);
  if (!is_empty && !(right_kind && right_shape)) refuse_array(a, name.c_str(), expected.c_str(), remedy);
  return py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>::ensure(a);
}

}  // namespace dartcast::python
