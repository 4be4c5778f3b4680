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

/// "BoxOptions(cells=[1, 1, 1], ...)".
std::string representation(const pybind11::object& record, const std::vector<std::string>& members);
/// The values of all members.
pybind11::tuple member_values(const pybind11::object& record, const std::vector<std::string>& members);
/// Whether all members are equal; arrays entry by entry.
bool equal_members(const pybind11::object& a, const pybind11::object& b, const std::vector<std::string>& members);
/// The named values of a call: positional ones in the order of the members, then keywords. Throws TypeError for a name
/// that is none of a member, for too many values, and for a value given twice.
pybind11::dict named_values(const char* record, const std::vector<std::string>& members, const pybind11::args& values,
                            const pybind11::kwargs& named);
/// Makes an array read-only; leaves anything else as it is.
pybind11::object without_writing(pybind11::object value);
/// Throws TypeError: the member, what was expected, what came.
[[noreturn]] void refuse_member(const std::string& member, const std::string& expected, pybind11::handle value);

/// A record under construction. `name`: in Python; `cpp`: in C++, where it differs.
template <class T>
class Record {
 public:
  Record(pybind11::handle scope, const char* name, const char* cpp = nullptr)
      : name_(name), cpp_(cpp != nullptr ? cpp : name), class_(scope, name, doc(cpp_)) {}

  /// A member that can be read and set. A member that is an array is given out as a read-only copy. `cpp_member`: its
  /// name in C++, where it differs.
  template <class M>
  Record& field(const char* name, M T::*member, const char* cpp_member = nullptr) {
    members_->push_back(name);
    const std::string full = name_ + "." + name;
    const auto set = [member, full](T& t, pybind11::handle value) {
      pybind11::detail::make_caster<M> caster;
      if (!caster.load(value, true)) {
        constexpr auto expected = pybind11::detail::make_caster<M>::name;
        refuse_member(full, expected.text, value);
      }
      t.*member = pybind11::detail::cast_op<M&>(caster);
    };
    setters_->push_back(set);
    class_.def_property(
        name, [member](const T& t) { return without_writing(pybind11::cast(t.*member)); },
        [set](T& t, const pybind11::object& value) { set(t, value); },
        doc(cpp_ + "::" + (cpp_member != nullptr ? cpp_member : name)));
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
  pybind11::class_<T>& finish() {
    namespace py = pybind11;
    const auto make = [name = name_, members = members_, setters = setters_](const py::args& values,
                                                                             const py::kwargs& named) {
      T made{};
      const py::dict all = named_values(name.c_str(), *members, values, named);
      for (std::size_t i = 0; i < members->size(); ++i) {
        const char* member = (*members)[i].c_str();
        if (all.contains(member)) (*setters)[i](made, all[member]);
      }
      return made;
    };
    class_.def(py::init(make));
    class_.def("__repr__", [members = members_](const py::object& self) { return representation(self, *members); });
    class_.def("__eq__", [members = members_](const py::object& self, const py::object& other) {
      return py::isinstance<T>(other) && equal_members(self, other, *members);
    });
    class_.def("__copy__", [](const T& t) { return T(t); });
    class_.def("__deepcopy__", [](const T& t, const py::dict& /*memo*/) { return T(t); });
    class_.def(py::pickle([members = members_](const py::object& self) { return member_values(self, *members); },
                          [make](const py::tuple& values) { return make(py::args(values), py::kwargs()); }));
    return class_;
  }

 private:
  using Setter = std::function<void(T&, pybind11::handle)>;

  std::string name_;
  std::string cpp_;
  pybind11::class_<T> class_;
  std::shared_ptr<std::vector<std::string>> members_ = std::make_shared<std::vector<std::string>>();
  std::shared_ptr<std::vector<Setter>> setters_ = std::make_shared<std::vector<Setter>>();
};

}  // namespace dartcast::python
