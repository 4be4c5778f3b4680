// Numbers of things as Python sees them: plain integers, and named tuples of them (dartcast/_ids.py). None stands for
// an invalid one.
#pragma once

#include <pybind11/pybind11.h>

#include <array>
#include <cstdint>
#include <optional>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/ids.hpp"
#include "dartcast/threads.hpp"
#include "support/arrays.hpp"

namespace dartcast::python {

/// The named tuple of this name in dartcast/_ids.py.
pybind11::handle tuple_type(const char* name);

/// The integer in a Python object, NumPy's included; at most `largest`. Throws ValueError beyond it; false if the
/// object is no integer.
bool load_integer(pybind11::handle from, std::uint64_t largest, std::uint64_t& value);

/// An id that may be none.
template <class T>
std::optional<T> or_none(const T& id) {
  return id.valid() ? std::optional<T>(id) : std::nullopt;
}

/// Two integers of a tuple, or of a row of a structured array; false if it is none of two.
bool load_pair(pybind11::handle from, std::array<std::uint64_t, 2>& values);

}  // namespace dartcast::python

namespace pybind11::detail {

template <class Id>
struct id_caster {
  PYBIND11_TYPE_CASTER(Id, (const_name<std::is_same_v<Id, dartcast::Cell>>("Cell", "Vertex")));
  bool load(handle from, bool /*convert*/) {
    if (from.is_none()) {
      value = Id{};
      return true;
    }
    std::uint64_t number = 0;
    if (!dartcast::python::load_integer(from, 0xffffffffU, number)) return false;
    value = Id{static_cast<std::uint32_t>(number)};
    return true;
  }
  static handle cast(Id id, return_value_policy /*policy*/, handle /*parent*/) {
    return id.valid() ? int_(id.value).release() : none().release();
  }
};
template <class Tag>
struct type_caster<dartcast::Id<Tag>> : id_caster<dartcast::Id<Tag>> {};
template <>
struct type_caster<dartcast::Cell> : id_caster<dartcast::Cell> {};

/// Cells or vertices: any integers in, an array uint32 (n,) out.
template <class Id>
struct id_list_caster {
  PYBIND11_TYPE_CASTER(std::vector<Id>, const_name("whole numbers (n,)"));
  bool load(handle from, bool /*convert*/) {
    if (isinstance<str>(from) || (!isinstance<array>(from) && !PySequence_Check(from.ptr()))) return false;
    value.clear();
    for (const std::uint32_t number : dartcast::python::indices(reinterpret_borrow<object>(from), "the array"))
      value.emplace_back(number);
    return true;
  }
  static handle cast(const std::vector<Id>& ids, return_value_policy /*policy*/, handle /*parent*/) {
    std::vector<std::uint32_t> numbers;
    numbers.reserve(ids.size());
    for (const Id id : ids) numbers.push_back(id.value);
    return dartcast::python::array_of(std::move(numbers)).release();
  }
};
template <class Tag>
struct type_caster<std::vector<dartcast::Id<Tag>>> : id_list_caster<dartcast::Id<Tag>> {};
template <>
struct type_caster<std::vector<dartcast::Cell>> : id_list_caster<dartcast::Cell> {};

template <>
struct type_caster<dartcast::Patch> {
  PYBIND11_TYPE_CASTER(dartcast::Patch, const_name("Patch"));
  bool load(handle from, bool /*convert*/) {
    std::uint64_t number = 0;
    if (!dartcast::python::load_integer(from, 0xffffU, number)) return false;
    value = dartcast::Patch{static_cast<std::uint16_t>(number)};
    return true;
  }
  static handle cast(dartcast::Patch p, return_value_policy /*policy*/, handle /*parent*/) {
    return int_(p.value).release();
  }
};

/// A number of threads; 0: all.
template <>
struct type_caster<dartcast::Threads> {
  PYBIND11_TYPE_CASTER(dartcast::Threads, const_name("int"));
  bool load(handle from, bool /*convert*/) {
    std::uint64_t number = 0;
    if (!dartcast::python::load_integer(from, 0xffffffffU, number)) return false;
    value = {static_cast<unsigned>(number)};
    return true;
  }
  static handle cast(dartcast::Threads t, return_value_policy /*policy*/, handle /*parent*/) {
    return int_(t.count).release();
  }
};

/// A cell and a number in it. `Number`: the member with the number.
template <class T, auto Number>
struct numbered_caster {
  static handle cast_as(const char* name, const T& t) {
    if (!t.cell.valid()) return none().release();
    return dartcast::python::tuple_type(name)(t.cell.value, t.*Number).release();
  }
  static bool load_as(handle from, T& value) {
    std::array<std::uint64_t, 2> values{};
    if (from.is_none()) {
      value = T{};
      return true;
    }
    if (!dartcast::python::load_pair(from, values)) return false;
    value.cell = dartcast::Cell{static_cast<std::uint32_t>(values[0])};
    value.*Number = static_cast<std::uint16_t>(values[1]);
    return true;
  }
};

#define DARTCAST_NUMBERED(Type, member)                                                          \
  template <>                                                                                    \
  struct type_caster<dartcast::Type> {                                                           \
    using Pair = numbered_caster<dartcast::Type, &dartcast::Type::member>;                       \
    PYBIND11_TYPE_CASTER(dartcast::Type, const_name(#Type));                                     \
    bool load(handle from, bool /*convert*/) { return Pair::load_as(from, value); }              \
    static handle cast(const dartcast::Type& t, return_value_policy /*policy*/, handle /*up*/) { \
      return Pair::cast_as(#Type, t);                                                            \
    }                                                                                            \
  };
DARTCAST_NUMBERED(Dart, number)
DARTCAST_NUMBERED(CellFace, face)
DARTCAST_NUMBERED(SimplexId, simplex)
DARTCAST_NUMBERED(CellHandle, version)
#undef DARTCAST_NUMBERED

}  // namespace pybind11::detail
