// Plain records of C++ as classes of Python: BoxOptions(cells=[4, 4, 4]), with members, a representation, copies and
// pickles, all from one list of members.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
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
  using Getter = std::function<pybind11::object(const pybind11::object& self)>;
  using Setter = std::function<void(const pybind11::object& self, const pybind11::object& value)>;

  /// `record`: its class. `name`: in Python.
  RecordMembers(const pybind11::object& record, const char* name) : record_(record), name_(name) {}

  /// "BoxOptions.cells".
  [[nodiscard]] std::string full_name(const char* member) const { return name_ + "." + member; }
  void add(const char* name, const Getter& get, const Setter& set, const char* doc);
  /// Representation, comparison, copies and pickles. To be called when all members are there.
  void finish() const;
  /// Sets what a call of the constructor names: positional values in the order of the members, then keywords. Throws
  /// TypeError for a name that is none of a member, for too many values, and for a value given twice.
  void set(const pybind11::object& self, const pybind11::args& values, const pybind11::kwargs& named) const;

 private:
  pybind11::handle record_;  // the module keeps it
  std::string name_;
  std::vector<std::string> members_;
};

/// A member in Python. A member that is an array is given out as a read-only copy.
template <class M>
pybind11::object member_value(const M& member) {
  return without_writing(pybind11::cast(member));
}
template <class M>
void set_member(M& member, const pybind11::object& value, const std::string& full_name) {
  pybind11::detail::make_caster<M> caster;
  if (!caster.load(value, true)) {
    constexpr auto expected = pybind11::detail::make_caster<M>::name;
    refuse_member(full_name, expected.text, value);
  }
  member = pybind11::detail::cast_op<M&>(caster);
}

/// A record under construction. `name`: in Python; `cpp`: in C++, where it differs.
template <class T>
class Record {
 public:
  Record(pybind11::handle scope, const char* name, const char* cpp = nullptr)
      : cpp_(cpp != nullptr ? cpp : name),
        class_(scope, name, doc(cpp_)),
        members_(std::make_shared<RecordMembers>(class_, name)) {}

  /// A member that can be read and set. `cpp_member`: its name in C++, where it differs.
  template <class M>
  Record& field(const char* name, M T::*member, const char* cpp_member = nullptr) {
    const auto get = [member](const pybind11::object& self) { return member_value(self.cast<const T&>().*member); };
    const auto set = [member, full = members_->full_name(name)](const pybind11::object& self,
                                                                const pybind11::object& value) {
      set_member(self.cast<T&>().*member, value, full);
    };
    members_->add(name, get, set, doc(cpp_ + "::" + (cpp_member != nullptr ? cpp_member : name)));
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
    namespace py = pybind11;
    class_.def(py::init([members = members_](const py::args& values, const py::kwargs& named) {
      auto made = std::make_unique<T>();
      members->set(py::cast(made.get(), py::return_value_policy::reference), values, named);
      return made;
    }));
    members_->finish();
    return class_;
  }

 private:
  std::string cpp_;
  pybind11::class_<T> class_;
  std::shared_ptr<RecordMembers> members_;
};

}  // namespace dartcast::python
