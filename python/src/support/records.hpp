// Plain records of C++ as classes of Python: BoxOptions(cells=[4, 4, 4]), with members, a representation, copies and
// pickles, all from one list of members.
#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "support/arrays.hpp"
#include "support/docs.hpp"

namespace dartcast::python {

/// Makes an array read-only; leaves anything else as it is.
pybind11::object without_writing(pybind11::object value);
/// Throws TypeError: the member, what was expected, what came.
[[noreturn]] void refuse_member(const std::string& member, const std::string& expected, pybind11::handle value);

/// The part of a record under construction that does not depend on its type. It is compiled once: of each member, only
/// its conversions are compiled for its type.
class RecordMembers {
 public:
  using Getter = pybind11::object (*)(const void* member);
  using Setter = void (*)(void* member, const pybind11::object& value, const std::string& full_name);
  using Maker = std::unique_ptr<void, void (*)(void*)> (*)();

  /// `record`: its class. `name`: in Python; `cpp`: in C++.
  RecordMembers(const pybind11::object& record, const char* name, const char* cpp)
      : record_(record), name_(name), cpp_(cpp) {}

  /// `offset`: of the member, in bytes. `cpp_name`: in C++.
  void add(const char* name, const char* cpp_name, std::ptrdiff_t offset, Getter get, Setter set);
  /// Constructor, representation, comparison, copies and pickles. To be called when all members are there.
  void finish(Maker make) const;

 private:
  /// Sets what a call of the constructor names: positional values in the order of the members, then keywords. Throws
  /// TypeError for a name that is none of a member, for too many values, and for a value given twice.
  void set_all(const pybind11::object& self, const pybind11::args& values, const pybind11::kwargs& named) const;
  void define_constructor(Maker make) const;

  pybind11::handle record_;  // the module keeps it
  std::string name_, cpp_;
  std::vector<std::string> members_;
};

/// A member in Python. A member that is an array is given out as a read-only copy.
template <class M>
pybind11::object member_value(const void* member) {
  return without_writing(pybind11::cast(*static_cast<const M*>(member)));
}
template <class M>
void set_member(void* member, const pybind11::object& value, const std::string& full_name) {
  pybind11::detail::make_caster<M> caster;
  if (!caster.load(value, true)) {
    constexpr auto expected = pybind11::detail::make_caster<M>::name;
    refuse_member(full_name, expected.text, value);
  }
  *static_cast<M*>(member) = pybind11::detail::cast_op<M&>(caster);
}

/// A record under construction. `name`: in Python; `cpp`: in C++, where it differs.
template <class T>
class Record {
 public:
  Record(pybind11::handle scope, const char* name, const char* cpp = nullptr)
      : class_(scope, name, doc(cpp != nullptr ? cpp : name)), members_(class_, name, cpp != nullptr ? cpp : name) {}

  /// A member that can be read and set. `cpp_member`: its name in C++, where it differs.
  template <class M>
  Record& field(const char* name, M T::*member, const char* cpp_member = nullptr) {
    const auto offset =
        reinterpret_cast<const std::byte*>(&(sample_.*member)) - reinterpret_cast<const std::byte*>(&sample_);
    members_.add(name, cpp_member != nullptr ? cpp_member : name, offset, &member_value<M>, &set_member<M>);
    return *this;
  }
  /// Further definitions: methods, properties.
  template <class... Arguments>
  Record& def(Arguments&&... arguments) {
    class_.def(std::forward<Arguments>(arguments)...);
    return *this;
  }
  template <class... Arguments>
  Record& def_property_readonly(Arguments&&... arguments) {
    class_.def_property_readonly(std::forward<Arguments>(arguments)...);
    return *this;
  }

  /// The constructor, with values by position or by name, and all else that needs the list of members. To be called
  /// last.
  pybind11::class_<T> finish() {
    members_.finish([]() -> std::unique_ptr<void, void (*)(void*)> {
      return {new T(), [](void* made) { delete static_cast<T*>(made); }};
    });
    return class_;
  }

 private:
  pybind11::class_<T> class_;
  RecordMembers members_;
  T sample_{};  // its members show where they are in a record
};

}  // namespace dartcast::python
