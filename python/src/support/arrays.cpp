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

bool is_numbers(const py::object& x) {
  return py::isinstance<py::array_t<double>>(x) && py::reinterpret_borrow<py::array>(x).ndim() == 1 &&
         is_contiguous(py::reinterpret_borrow<py::array>(x));
}

// The code that makes vectors of the object; numbers alone do not say which of them belong together.
const char* vectors_from(const py::object& x) {
  if (py::isinstance<py::array>(x)) {
    const auto a = py::reinterpret_borrow<py::array>(x);
    if (a.ndim() == 2 && a.shape(0) == 3 && a.shape(1) != 3) return "x.T: a row for each point";
    if (a.ndim() == 1 && a.size() % 3 == 0) return "x.reshape(-1, 3), if x, y and z of a point stand together";
  }
  return "numpy.asarray(x, dtype=float), with a row of three numbers for each point";
}

constexpr const char* numbers_from = "numpy.asarray(x, dtype=float)";

// Whether each of its numbers is a double.
bool are_doubles(const py::array& a) {
  const char kind = a.dtype().kind();
  const py::ssize_t bytes = a.dtype().itemsize();
  if (kind == 'f') return bytes <= 8;
  if (kind != 'i' && kind != 'u') return false;
  if (bytes < 8) return true;
  constexpr std::int64_t limit = std::int64_t{1} << 53;
  const auto within = [&](const char* compare, std::int64_t bound) {
    return a.attr(compare)(bound).attr("all")().cast<bool>();
  };
  return within("__le__", limit) && (kind == 'u' || within("__ge__", -limit));
}

// A copy as doubles, C-contiguous, of an object that numpy.asarray() makes an array of these dimensions; else the object.
py::object converted(py::handle x, py::ssize_t dimensions) {
  auto given = py::reinterpret_borrow<py::object>(x);
  const bool is_list = PySequence_Check(x.ptr()) != 0 && !py::isinstance<py::str>(x) && !py::isinstance<py::bytes>(x);
  if (!py::isinstance<py::array>(x) && !is_list && !py::hasattr(x, "__array__")) return given;
  const auto a = py::array::ensure(x);
  if (!a) {
    PyErr_Clear();
    return given;
  }
  if (a.ndim() != dimensions || (dimensions == 2 && a.shape(1) != 3) || !are_doubles(a)) return given;
  py::array_t<double> made(std::vector<py::ssize_t>(a.shape(), a.shape() + a.ndim()));
  made[py::ellipsis()] = a;
  return made;
}

}  // namespace

py::object converted_vectors(py::handle x) {
  const auto given = py::reinterpret_borrow<py::object>(x);
  return is_vectors(given) ? given : converted(x, 2);
}

py::object converted_numbers(py::handle x) {
  const auto given = py::reinterpret_borrow<py::object>(x);
  return is_numbers(given) ? given : converted(x, 1);
}

void refuse_array(const py::object& x, const char* name, const char* expected, const char* remedy) {
  throw py::type_error(std::string(name) + ": expected " + expected + "; got " + description(x) + ". Convert it by " +
                       remedy);
}

bool is_array(const py::object& x, int dimensions) {
  return py::isinstance<py::array>(x) && py::reinterpret_borrow<py::array>(x).ndim() == dimensions;
}

std::span<const Vec3> vectors(const py::object& x, const char* name) {
  if (!is_vectors(x)) refuse_array(x, name, "float64 (n, 3), C-contiguous", vectors_from(x));
  const auto a = py::reinterpret_borrow<py::array>(x);
  return {static_cast<const Vec3*>(a.data()), static_cast<std::size_t>(a.shape(0))};
}

std::span<Vec3> writable_vectors(const py::object& x, const char* name) {
  if (!is_vectors(x)) refuse_array(x, name, "float64 (n, 3), C-contiguous", vectors_from(x));
  auto a = py::reinterpret_borrow<py::array>(x);
  if (!a.writeable()) refuse_array(x, name, "a writable array", "x.copy()");
  return {static_cast<Vec3*>(a.mutable_data()), static_cast<std::size_t>(a.shape(0))};
}

std::span<const double> numbers(const py::object& x, const char* name) {
  if (!is_numbers(x)) refuse_array(x, name, "float64 (n,), C-contiguous", numbers_from);
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
