// Arrays of whole numbers from NumPy: any integer dtype, as meshes of other libraries have them.
#pragma once

#include <pybind11/numpy.h>

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "support/arrays.hpp"

namespace dartcast::python {

/// The array as int64, C-contiguous; without a copy where it is that already. `columns`: 0 for the shape (n,), else
/// that of (n, columns). Throws TypeError for another shape or no integers.
pybind11::array_t<std::int64_t> wide_integers(const pybind11::object& x, const std::string& name, std::size_t columns);

/// Adds the numbers to a vector, row by row. Throws InvalidArgument, which names the row, if T cannot hold a number
/// or it is not below `end`.
template <class T>
void append_integers(const pybind11::object& x, const std::string& name, std::size_t columns, std::vector<T>& to,
                     std::int64_t end = std::numeric_limits<std::int64_t>::max()) {
  const auto wide = wide_integers(x, name, columns);
  const std::int64_t* data = wide.data();
  const auto size = static_cast<std::size_t>(wide.size());
  constexpr auto low = static_cast<std::int64_t>(std::numeric_limits<T>::min());
  constexpr auto high = sizeof(T) < sizeof(std::int64_t) ? static_cast<std::int64_t>(std::numeric_limits<T>::max())
                                                         : std::numeric_limits<std::int64_t>::max();
  to.reserve(to.size() + size);
  for (std::size_t i = 0; i < size; ++i) {
    if (data[i] < low || data[i] > high || data[i] >= end) {
      throw InvalidArgument(name + ": row " + std::to_string(columns > 0 ? i / columns : i) + " has " +
                            std::to_string(data[i]) + ", which is out of range");
    }
    to.push_back(static_cast<T>(data[i]));
  }
}

/// The numbers in an array (n,).
template <class T>
std::vector<T> integers(const pybind11::object& x, const std::string& name) {
  std::vector<T> numbers;
  append_integers(x, name, 0, numbers);
  return numbers;
}

/// A fresh array (n, columns).
template <class T>
pybind11::array_t<T> rows_of(const std::vector<T>& values, std::size_t columns) {
  return pybind11::array_t<T>(
      {static_cast<pybind11::ssize_t>(values.size() / columns), static_cast<pybind11::ssize_t>(columns)},
      values.data());
}

}  // namespace dartcast::python
