// Arrays from and to NumPy: checks with messages that say what was expected and what came.
#include "support/arrays.hpp"

#include <cstring>
#include <limits>

#include "dartcast/error.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

std::string shape_of(const py::array& a) {
  std::string text = py::str(a.dtype()).cast<std::string>() + " (";
  for (py::ssize_t i = 0; i < a.ndim(); ++i) text += (i > 0 ? ", " : "") + std::to_string(a.shape(i));
  return text + (a.ndim() == 1 ? ",)" : ")");
}

std::string description(const py::object& x) {
  if (!py::isinstance<py::array>(x)) return "a " + py::type::of(x).attr("__name__").cast<std::string>();
  const auto a = py::reinterpret_borrow<py::array>(x);
  std::string text = shape_of(a);
  if ((a.flags() & py::array::c_style) == 0) text += ", not C-contiguous";
  return text;
}

bool is_contiguous(const py::array& a) {
  return (a.flags() & py::array::c_style) != 0 &&
         (py::detail::array_proxy(a.ptr())->flags & py::detail::npy_api::NPY_ARRAY_ALIGNED_) != 0;
}

bool is_vectors(const py::object& x) {
  if (!py::isinstance<py::array_t<double>>(x)) return false;
  const auto a = py::reinterpret_borrow<py::array>(x);
  return a.ndim() == 2 && a.shape(1) == 3 && is_contiguous(a);
}

constexpr const char* convert_vectors = "numpy.ascontiguousarray(x, dtype=float).reshape(-1, 3)";
constexpr const char* convert_numbers = "numpy.ascontiguousarray(x, dtype=float)";

}  // namespace

void refuse_array(const py::object& x, const char* name, const char* expected, const char* remedy) {
  throw py::type_error(std::string(name) + ": expected " + expected + "; got " + description(x) + ". Convert it by " +
                       remedy);
}

bool is_array(const py::object& x, int dimensions) {
  return py::isinstance<py::array>(x) && py::reinterpret_borrow<py::array>(x).ndim() == dimensions;
}

std::span<const Vec3> vectors(const py::object& x, const char* name) {
  if (!is_vectors(x)) refuse_array(x, name, "float64 (n, 3), C-contiguous", convert_vectors);
  const auto a = py::reinterpret_borrow<py::array>(x);
  return {static_cast<const Vec3*>(a.data()), static_cast<std::size_t>(a.shape(0))};
}

std::span<Vec3> writable_vectors(const py::object& x, const char* name) {
  if (!is_vectors(x)) refuse_array(x, name, "float64 (n, 3), C-contiguous", convert_vectors);
  auto a = py::reinterpret_borrow<py::array>(x);
  if (!a.writeable()) refuse_array(x, name, "a writable array", "x.copy()");
  return {static_cast<Vec3*>(a.mutable_data()), static_cast<std::size_t>(a.shape(0))};
}

std::span<const double> numbers(const py::object& x, const char* name) {
  const bool right = py::isinstance<py::array_t<double>>(x) && py::reinterpret_borrow<py::array>(x).ndim() == 1 &&
                     is_contiguous(py::reinterpret_borrow<py::array>(x));
  if (!right) refuse_array(x, name, "float64 (n,), C-contiguous", convert_numbers);
  const auto a = py::reinterpret_borrow<py::array>(x);
  return {static_cast<const double*>(a.data()), static_cast<std::size_t>(a.size())};
}

std::span<const std::uint8_t> marks(const py::object& x, const char* name) {
  const bool right = (py::isinstance<py::array_t<bool>>(x) || py::isinstance<py::array_t<std::uint8_t>>(x)) &&
                     py::reinterpret_borrow<py::array>(x).ndim() == 1 &&
                     is_contiguous(py::reinterpret_borrow<py::array>(x));
  if (!right) refuse_array(x, name, "bool or uint8 (n,), C-contiguous", "numpy.ascontiguousarray(x, dtype=bool)");
  const auto a = py::reinterpret_borrow<py::array>(x);
  return {static_cast<const std::uint8_t*>(a.data()), static_cast<std::size_t>(a.size())};
}

std::vector<std::uint32_t> indices(const py::object& x, const char* name) {
  constexpr const char* expected = "whole numbers (n,)";
  constexpr const char* remedy = "numpy.asarray(x, dtype=numpy.uint32)";
  const auto a = py::array::ensure(x);
  if (!a) {
    PyErr_Clear();
    refuse_array(x, name, expected, remedy);
  }
  const char kind = a.dtype().kind();
  if (a.ndim() != 1 || (kind != 'i' && kind != 'u' && a.size() > 0)) refuse_array(a, name, expected, remedy);
  const auto wide = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>::ensure(a);
  std::vector<std::uint32_t> found(static_cast<std::size_t>(wide.size()));
  for (std::size_t i = 0; i < found.size(); ++i) {
    const std::int64_t value = wide.data()[i];
    if (value < 0 || value > std::numeric_limits<std::uint32_t>::max()) {
      throw InvalidArgument(std::string(name) + ": entry " + std::to_string(i) + " is " + std::to_string(value) +
                            ", which is no number from 0 to 2^32 - 1");
    }
    found[i] = static_cast<std::uint32_t>(value);
  }
  return found;
}

Vec3 vector(const py::object& x, const char* name) {
  py::detail::make_caster<Vec3> caster;
  if (!caster.load(x, true)) refuse_array(x, name, "three numbers", "[x, y, z]");
  return py::detail::cast_op<Vec3&>(caster);
}

py::array_t<double> array_of(std::span<const Vec3> vectors) {
  py::array_t<double> made({static_cast<py::ssize_t>(vectors.size()), py::ssize_t{3}});
  if (!vectors.empty()) std::memcpy(made.mutable_data(), vectors.data(), vectors.size_bytes());
  return made;
}

py::array_t<double> array_of(const Vec3& v) {
  py::array_t<double> made(3);
  std::memcpy(made.mutable_data(), &v, sizeof v);
  return made;
}

}  // namespace dartcast::python

namespace pybind11::detail {

bool type_caster<dartcast::Vec3>::load(handle from, bool /*convert*/) {
  if (isinstance<str>(from) || !PySequence_Check(from.ptr()) || PySequence_Size(from.ptr()) != 3) {
    PyErr_Clear();
    return false;
  }
  std::array<double, 3> x{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto item = reinterpret_steal<object>(PySequence_GetItem(from.ptr(), static_cast<ssize_t>(i)));
    if (!item) throw error_already_set();
    x[i] = PyFloat_AsDouble(item.ptr());
    if (PyErr_Occurred() != nullptr) {
      PyErr_Clear();
      return false;
    }
  }
  value = {x[0], x[1], x[2]};
  return true;
}

}  // namespace pybind11::detail
