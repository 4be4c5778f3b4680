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

/// An argument of points, as the next functions take it: the same object, or a copy of its numbers as float64 (n, 3),
/// C-contiguous. The same object, too, if it has other numbers or another shape.
pybind11::object converted_vectors(pybind11::handle x);
/// The same of float64 (n,).
pybind11::object converted_numbers(pybind11::handle x);

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

namespace pybind11::detail {

/// Arguments that a call only reads: converted, and kept as long as the call.
template <class Type, object (*convert)(handle)>
struct converting_caster : pyobject_caster<Type> {
  bool load(handle from, bool /*convert*/) {
    this->value = Type(convert(from));
    return true;
  }
};
template <>
struct type_caster<dartcast::python::Typed<"Points">>
    : converting_caster<dartcast::python::Typed<"Points">, dartcast::python::converted_vectors> {};
template <>
struct type_caster<dartcast::python::Typed<"Vector or Points">>
    : converting_caster<dartcast::python::Typed<"Vector or Points">, dartcast::python::converted_vectors> {};
template <>
struct type_caster<dartcast::python::Typed<"Vector | Points">>
    : converting_caster<dartcast::python::Typed<"Vector | Points">, dartcast::python::converted_vectors> {};
template <>
struct type_caster<dartcast::python::Typed<"Floats">>
    : converting_caster<dartcast::python::Typed<"Floats">, dartcast::python::converted_numbers> {};
template <>
struct type_caster<dartcast::python::Typed<"float | Floats">>
    : converting_caster<dartcast::python::Typed<"float | Floats">, dartcast::python::converted_numbers> {};

}  // namespace pybind11::detail
