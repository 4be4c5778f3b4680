// Plain records of C++ as classes of Python: BoxOptions(cells=[4, 4, 4]), with members, a representation, copies and
// pickles, all from one list of members. tools/make_bindings.py writes these lists.
#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "support/arrays.hpp"
#include "support/docs.hpp"
#include "support/signatures.hpp"
#include "support/typed.hpp"

namespace dartcast::python {

/// Makes records ready to be bound. To be called once, first.
void prepare_records(pybind11::module_& m);

/// Makes an array read-only; leaves anything else as it is.
pybind11::object without_writing(pybind11::object value);
/// A copy of a value, to be read only.
template <class T>
As<std::remove_cvref_t<T>> reading(T&& value) {
  if constexpr (std::is_base_of_v<pybind11::object, std::remove_cvref_t<T>>) {
    return without_writing(std::forward<T>(value));
  } else {
    return without_writing(pybind11::cast(std::remove_cvref_t<T>(std::forward<T>(value))));
  }
}
/// Throws TypeError: the member, what was expected, what came.
[[noreturn]] void refuse_member(const std::string& member, const std::string& expected, pybind11::handle value);

/// The part of a record under construction that does not depend on its type. It is compiled once: of each member, only
/// its conversions are compiled for its type.
class RecordMembers {
 public:
  using Getter = pybind11::object (*)(const void* member);
  using Setter = void (*)(void* member, const pybind11::object& value, const std::string& full_name);
  using Maker = std::unique_ptr<void, void (*)(void*)> (*)();
  using TypeText = std::string (*)();

  /// `record`: its class. `name`: in Python; `cpp`: in C++.
  RecordMembers(const pybind11::object& record, const char* name, const char* cpp)
      : record_(record), name_(name), cpp_(cpp) {}

  /// `offset`: of the member, in bytes. `cpp_name`: in C++.
  void add(const char* name, const char* cpp_name, std::ptrdiff_t offset, Getter get, Setter set, TypeText type);
  /// Constructor, representation, comparison, copies and pickles. To be called when all members are there.
  void finish(Maker make) const;
  /// For inspect.signature(): names, types and defaults.
  [[nodiscard]] pybind11::object signature() const;

 private:
  /// Sets what a call of the constructor names: positional values in the order of the members, then keywords. Throws
  /// TypeError for a name that is none of a member, for too many values, and for a value given twice.
  void set_all(const pybind11::object& self, const pybind11::args& values, const pybind11::kwargs& named) const;
  void define_constructor(Maker make) const;

  pybind11::handle record_;  // the module keeps it
  std::string name_, cpp_;
  std::vector<std::string> members_;
  std::vector<TypeText> types_;
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

template <class M>
std::string type_text() {
  constexpr auto name = pybind11::detail::make_caster<M>::name;
  static const auto types = decltype(name)::types();
  return type_name(name.text, types.data());
}

/// The class of a record that is there, for further definitions.
template <class T>
pybind11::class_<T> class_of() {
  return pybind11::reinterpret_borrow<pybind11::class_<T>>(pybind11::type::of<T>());
}

/// A record under construction. `name`: in Python; `cpp`: in C++, if it differs.
template <class T>
class Record {
 public:
  Record(pybind11::handle scope, const char* name, const char* cpp = nullptr)
      : class_(scope, name, doc(cpp != nullptr ? cpp : name)), members_(class_, name, cpp != nullptr ? cpp : name) {}

  /// A member that can be read and set. `cpp_member`: its name in C++, if it differs.
  template <class M>
  Record& field(const char* name, M T::*member, const char* cpp_member = nullptr) {
    const auto offset =
        reinterpret_cast<const std::byte*>(&(sample_.*member)) - reinterpret_cast<const std::byte*>(&sample_);
    members_.add(name, cpp_member != nullptr ? cpp_member : name, offset, &member_value<M>, &set_member<M>,
                 &type_text<M>);
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
