// Pickles of reports, which have no constructor in Python: the bytes of their lists and numbers.
#pragma once

#include <pybind11/pybind11.h>

#include <cstring>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "dartcast/error.hpp"

namespace dartcast::python {

template <class T>
pybind11::bytes bytes_of(const T& x) {
  static_assert(std::is_trivially_copyable_v<T>);
  return {reinterpret_cast<const char*>(&x), sizeof(T)};
}
template <class T>
pybind11::bytes bytes_of(const std::vector<T>& list) {
  static_assert(std::is_trivially_copyable_v<T>);
  return {reinterpret_cast<const char*>(list.data()), list.size() * sizeof(T)};
}

inline void expect_bytes(bool whole) {
  if (!whole) throw InvalidArgument("the pickle is of another version of dartcast: make it again with this one");
}
template <class T>
void take_bytes(std::string_view bytes, T& x) {
  expect_bytes(bytes.size() == sizeof(T));
  std::memcpy(&x, bytes.data(), sizeof(T));
}
template <class T>
void take_bytes(std::string_view bytes, std::vector<T>& list) {
  expect_bytes(bytes.size() % sizeof(T) == 0);
  list.resize(bytes.size() / sizeof(T));
  if (!list.empty()) std::memcpy(list.data(), bytes.data(), bytes.size());
}

/// `members`: of a T&, a tuple of references to numbers, plain structs and vectors of these; all that T has.
template <class T, class... Options, class Members>
void pickle_by_bytes(pybind11::class_<T, Options...>& c, const Members& members) {
  const auto save = [members](T& t) {
    return std::apply([](const auto&... member) { return pybind11::make_tuple(bytes_of(member)...); }, members(t));
  };
  const auto load = [members](const pybind11::tuple& saved) {
    T t;
    std::apply(
        [&](auto&... member) {
          expect_bytes(saved.size() == sizeof...(member));
          std::size_t i = 0;
          (take_bytes(std::string_view(pybind11::cast<pybind11::bytes>(saved[i++])), member), ...);
        },
        members(t));
    return t;
  };
  c.def(pybind11::pickle(save, load));
}

}  // namespace dartcast::python
