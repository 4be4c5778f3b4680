// Vectors and arrays between NumPy and C++.
//
// An argument that is float64 of shape (n, 3) and C-contiguous is taken without a copy. Lists, frames of pandas, strided
// arrays and arrays of other numbers are copied, if each number is a double to the bit. All else is refused with a
// message that says what was expected, what came, and how to convert it. An array that a call writes to is never copied.
// A result is a fresh array. One that is an attribute is read-only: writing to it would change nothing.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "dartcast/vec3.hpp"
#include "support/typed.hpp"

namespace dartcast::python {

static_assert(sizeof(Vec3) == 3 * sizeof(double));

// Arguments. The spans are valid as long as the object. `name`: of the argument, for messages. All throw TypeError.

/// float64 (n, 3), C-contiguous, without a copy.
std::span<const Vec3> vectors(const pybind11::object& x, const char* name);
/// The same, writable.
std::span<Vec3> writable_vectors(const pybind11::object& x, const char* name);
/// float64 (n,), C-contiguous, without a copy.
std::span<const double> numbers(const pybind11::object& x, const char* name);
/// bool or uint8 (n,), without a copy.
std::span<const std::uint8_t> marks(const pybind11::object& x, const char* name);
/// Whole numbers from 0 to 2^32 - 1: any integer dtype, (n,), or a list. A copy.
std::vector<std::uint32_t> indices(const pybind11::object& x, const char* name);
/// One vector: any three numbers.
Vec3 vector(const pybind11::object& x, const char* name);

/// Whether it is an array with this number of dimensions.
bool is_array(const pybind11::object& x, int dimensions);
/// Throws TypeError: what was expected, what came.
[[noreturn]] void refuse_array(const pybind11::object& x, const char* name, const char* expected, const char* remedy);

// Results.

/// A fresh array (n, 3).
pybind11::array_t<double> array_of(std::span<const Vec3> vectors);
/// A fresh array (3,).
pybind11::array_t<double> array_of(const Vec3& v);
/// A fresh array of values or of plain records (PYBIND11_NUMPY_DTYPE), which takes the vector's memory over.
template <class T>
pybind11::array_t<T> array_of(std::vector<T>&& values) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  const T* data = kept->data();
  const auto size = static_cast<pybind11::ssize_t>(kept->size());
  pybind11::capsule owner(kept.release(), [](void* p) { delete static_cast<std::vector<T>*>(p); });
  return pybind11::array_t<T>(size, data, owner);
}
template <class T>
pybind11::array_t<T> array_of(std::span<const T> values) {
  return pybind11::array_t<T>(static_cast<pybind11::ssize_t>(values.size()), values.data());
}
/// A fresh array (n, N).
template <std::size_t N>
pybind11::array_t<std::uint32_t> array_of_rows(const std::vector<std::array<std::uint32_t, N>>& rows) {
  pybind11::array_t<std::uint32_t> made(
      {static_cast<pybind11::ssize_t>(rows.size()), static_cast<pybind11::ssize_t>(N)});
  for (std::size_t i = 0; i < rows.size(); ++i) std::copy(rows[i].begin(), rows[i].end(), made.mutable_data() + i * N);
  return made;
}
/// The array, made read-only: for attributes.
template <class Array>
Array read_only(Array a) {
  pybind11::detail::array_proxy(a.ptr())->flags &= ~pybind11::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return a;
}

}  // namespace dartcast::python

namespace pybind11::detail {

/// Three numbers in, an array (3,) out.
template <>
struct type_caster<dartcast::Vec3> {
  PYBIND11_TYPE_CASTER(dartcast::Vec3, const_name("three numbers"));
  bool load(handle from, bool convert);
  static handle cast(const dartcast::Vec3& v, return_value_policy /*policy*/, handle /*parent*/) {
    return dartcast::python::array_of(v).release();
  }
};

/// As dartcast::python::vectors() and array_of(), for members and results.
template <>
struct type_caster<std::vector<dartcast::Vec3>> {
  PYBIND11_TYPE_CASTER(std::vector<dartcast::Vec3>, const_name("float64 (n, 3)"));
  bool load(handle from, bool /*convert*/) {
    const object converted = dartcast::python::converted_vectors(from);
    const auto v = dartcast::python::vectors(converted, "the array");
    value.assign(v.begin(), v.end());
    return true;
  }
  static handle cast(const std::vector<dartcast::Vec3>& v, return_value_policy /*policy*/, handle /*parent*/) {
    return dartcast::python::array_of(std::span<const dartcast::Vec3>(v)).release();
  }
};
template <>
struct type_caster<std::span<const dartcast::Vec3>> {
  static constexpr auto name = const_name("float64 (n, 3)");
  static handle cast(std::span<const dartcast::Vec3> v, return_value_policy /*policy*/, handle /*parent*/) {
    return dartcast::python::array_of(v).release();
  }
};

/// Numbers: any one-dimensional array or list that converts without loss in, a fresh array out.
template <class T>
struct number_list_caster {
  PYBIND11_TYPE_CASTER(std::vector<T>, const_name("numbers (n,)[") + npy_format_descriptor<T>::name + const_name("]"));
  bool load(handle from, bool convert) {
    if (isinstance<str>(from) || (!isinstance<array>(from) && !PySequence_Check(from.ptr()))) return false;
    if constexpr (std::is_integral_v<T>) {
      value.clear();
      for (const handle item : reinterpret_borrow<object>(from)) {
        make_caster<T> number;
        if (!number.load(item, convert)) return false;
        value.push_back(cast_op<T>(number));
      }
    } else {
      const auto a = array_t<T, array::c_style | array::forcecast>::ensure(from);
      if (!a || a.ndim() != 1) return false;
      value.assign(a.data(), a.data() + a.size());
    }
    return true;
  }
  static handle cast(const std::vector<T>& v, return_value_policy /*policy*/, handle /*parent*/) {
    return dartcast::python::array_of(std::span<const T>(v)).release();
  }
};
template <>
struct type_caster<std::vector<double>> : number_list_caster<double> {};
template <>
struct type_caster<std::vector<std::uint8_t>> : number_list_caster<std::uint8_t> {};
template <>
struct type_caster<std::vector<std::int32_t>> : number_list_caster<std::int32_t> {};
template <>
struct type_caster<std::vector<std::uint32_t>> : number_list_caster<std::uint32_t> {};
template <>
struct type_caster<std::vector<std::uint64_t>> : number_list_caster<std::uint64_t> {};

}  // namespace pybind11::detail
