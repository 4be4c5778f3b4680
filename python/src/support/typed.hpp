// Objects of Python that a function takes or gives as they are, with the type that signatures show:
// `const Typed<"Points | None">& positions`.
#pragma once

#include <pybind11/pybind11.h>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace dartcast::python {

template <std::size_t N>
struct TypeText {
  char text[N];  // NOLINT(modernize-avoid-c-arrays): a value of a template
  consteval TypeText(const char (&from)[N]) { std::copy(from, from + N, text); }  // NOLINT: taken from a literal
};

template <TypeText Type>
struct Typed : pybind11::object {
  using pybind11::object::object;
  Typed(pybind11::object of) : object(std::move(of)) {}  // NOLINT(google-explicit-constructor): it is the same object
  static bool check_(pybind11::handle /*of*/) { return true; }
};

}  // namespace dartcast::python

template <dartcast::python::TypeText Type>
struct pybind11::detail::handle_type_name<dartcast::python::Typed<Type>> {
  static constexpr auto name = const_name(Type.text);
};

namespace dartcast::python {

/// A value of a member as an object of Python, which signatures show as a T.
template <class T>
struct As : pybind11::object {
  using pybind11::object::object;
  As(pybind11::object of) : object(std::move(of)) {}  // NOLINT(google-explicit-constructor): it is the same object
};

/// One result, or many of them, as the arguments are.
template <class One, class Many>
struct Either : pybind11::object {
  using pybind11::object::object;
  Either(pybind11::object of) : object(std::move(of)) {}  // NOLINT(google-explicit-constructor): it is the same object
};

}  // namespace dartcast::python

template <class One, class Many>
struct pybind11::detail::handle_type_name<dartcast::python::Either<One, Many>> {
  static constexpr auto name = make_caster<One>::name + const_name(" or ") + make_caster<Many>::name;
};
template <class T>
struct pybind11::detail::handle_type_name<dartcast::python::As<T>> {
  static constexpr auto name = make_caster<T>::name;
};
