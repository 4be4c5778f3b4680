// Docstrings, and the names and defaults of arguments: from the public headers (tools/make_bindings.py writes docs.inl).
#pragma once

#include <pybind11/pybind11.h>

#include <span>
#include <string>
#include <string_view>

namespace dartcast::python {

/// The comment of a public C++ name, as "Environment::advance"; those of several overloads one after another. Empty
/// if the header has none. Throws std::logic_error if no header has the name: importing the package then fails.
const char* doc(std::string_view name);

/// Whether a header has the name.
bool is_public(std::string_view name);

/// An argument of a C++ function. `value` makes its default; null: it has none.
struct Argument {
  const char* name;
  pybind11::object (*value)() = nullptr;
};

/// The comment of a name in the headers, and its arguments, for a definition in Python. If a definition names its
/// arguments itself, these come first, and count.
struct About {
  std::string text;
  std::span<const Argument> arguments;

  /// For pybind11. Throws std::logic_error if the function of Python has more arguments, or fewer.
  void add_to(pybind11::detail::function_record& function) const;
};
/// `more`: a text behind the comment, after an empty line.
About about(std::string_view name, std::string_view more = {});

}  // namespace dartcast::python

namespace pybind11::detail {

template <>
struct process_attribute<dartcast::python::About> : process_attribute_default<dartcast::python::About> {
  static void init(const dartcast::python::About& a, function_record* r) { a.add_to(*r); }
  static void init(const dartcast::python::About& a, type_record* r) { r->doc = a.text.c_str(); }
};

}  // namespace pybind11::detail
