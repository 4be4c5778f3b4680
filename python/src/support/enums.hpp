// Enumerations as Python's own enum.IntEnum: members are numbers, have names, and compare with the values in arrays.
//
// tools/make_bindings.py lists them: DARTCAST_ENUM(Kind) gives a type its conversion, and bind_enum() makes its class.
// A caller may also give the name as a text, in either case: "reflect".
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <initializer_list>
#include <utility>

#include "dartcast/dartcast.hpp"

namespace dartcast::python {

/// Makes the class dartcast.NAME with these members.
void make_enum(pybind11::module_& m, const char* name, const pybind11::dict& members);
/// The number of a member; false if the object is none of the class, no number and no name of a member.
bool load_enum(const char* name, pybind11::handle from, std::int64_t& value);
pybind11::handle cast_enum(const char* name, std::int64_t value);

}  // namespace dartcast::python

namespace pybind11::detail {

#define DARTCAST_ENUM(Type)                                                               \
  template <>                                                                             \
  struct type_caster<dartcast::Type> {                                                    \
    PYBIND11_TYPE_CASTER(dartcast::Type, const_name(#Type));                              \
    bool load(handle from, bool /*convert*/) {                                            \
      std::int64_t number = 0;                                                            \
      if (!dartcast::python::load_enum(#Type, from, number)) return false;                \
      value = static_cast<dartcast::Type>(number);                                        \
      return true;                                                                        \
    }                                                                                     \
    static handle cast(dartcast::Type e, return_value_policy /*policy*/, handle /*up*/) { \
      return dartcast::python::cast_enum(#Type, static_cast<std::int64_t>(e));            \
    }                                                                                     \
  };
#include "enums.inl"
#undef DARTCAST_ENUM

}  // namespace pybind11::detail

namespace dartcast::python {

template <class E>
void bind_enum(pybind11::module_& m, const char* name, std::initializer_list<std::pair<const char*, E>> members) {
  pybind11::dict values;
  for (const auto& [member, value] : members) values[member] = static_cast<std::int64_t>(value);
  make_enum(m, name, values);
}

}  // namespace dartcast::python
