// Definitions that call one function of C++: functions, methods and properties of objects in handles.
//
// A handle has functions `call(f)` and, if Python may change its object, `change(f)`. They call f(object) under the
// object's mark of use, and change() without Python's lock. Arguments are copies, for another thread may change what
// Python holds; arrays of points are not. Results are copies, too. Names of arguments, defaults and docstrings are
// those of the headers, but for a text that is given here.
#pragma once

#include <pybind11/pybind11.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "dartcast/dartcast.hpp"
#include "support/docs.hpp"
#include "support/edits.hpp"
#include "support/ids.hpp"
#include "support/map_checks.hpp"
#include "support/meshes.hpp"
#include "support/records.hpp"

namespace dartcast::python {

/// The object of Python that is given for an argument, and the argument's name.
template <class T>
struct From {
  const T& given;
  const char* name;
};

// A tuple of these is made from what Python gives, so they convert by themselves.
// NOLINTBEGIN(google-explicit-constructor)

/// An argument of a C++ function, from what Python gives for it. It is made and ended with Python's lock.
template <class Argument>
struct Given {
  using Python = std::remove_cvref_t<Argument>;
  Python value;
  Given(const From<Python>& from) : value(from.given) {}
};
template <class T>
struct Given<std::span<const T>> {
  using Python = std::vector<T>;
  Python value;
  Given(const From<Python>& from) : value(from.given) {}
};
template <>
struct Given<std::span<const Vec3>> {
  using Python = Typed<"Points">;
  Python array;
  std::span<const Vec3> value;
  Given(const From<Python>& from) : array(from.given), value(vectors(array, from.name)) {}
};
template <>
struct Given<std::span<const double>> {
  using Python = Typed<"Floats">;
  Python array;
  std::span<const double> value;
  Given(const From<Python>& from) : array(from.given), value(numbers(array, from.name)) {}
};
template <>
struct Given<std::span<const std::uint32_t>> {
  using Python = Typed<"Integers">;
  std::vector<std::uint32_t> value;
  Given(const From<Python>& from) : value(indices(from.given, from.name)) {}
};
template <>
struct Given<std::span<const std::uint8_t>> {
  using Python = Typed<"Marks">;
  std::vector<std::uint8_t> value;
  Given(const From<Python>& from) {
    const auto given = marks(from.given, from.name);
    value.assign(given.begin(), given.end());
  }
};
template <>
struct Given<Threads> {
  using Python = Threads;
  Threads value;
  Given(const From<Threads>& from) : value(from.given) { check_threads(value); }
};
template <>
struct Given<const MeshData&> {
  using Python = MeshData;
  const MeshData& value;
  MeshUse use;
  Given(const From<MeshData>& from) : value((check_arrays(from.given), from.given)), use(from.given) {}
};
template <>
struct Given<MeshData&> {
  using Python = MeshData;
  MeshData& value;
  MeshUse use;
  Given(const From<MeshData>& from) : value(const_cast<MeshData&>(from.given)), use(from.given, true) {
    check_arrays(value);
  }
};
template <class Object, class Handle>
struct GivenInHandle {
  using Python = Handle;
  Use use;
  Object& value;
  GivenInHandle(const From<Handle>& from) : use(from.given.use()), value(object(from.given)) {}

 private:
  static Object& object(const Handle& handle) {
    if constexpr (std::is_const_v<Object>) {
      return handle.object();
    } else {
      return handle.target();
    }
  }
};
// clang-format off
template <> struct Given<const CombinatorialMap&> : GivenInHandle<const CombinatorialMap, MapHandle> { using GivenInHandle::GivenInHandle; };
template <> struct Given<const CellComplex&> : GivenInHandle<const CellComplex, ComplexHandle> { using GivenInHandle::GivenInHandle; };
template <> struct Given<const Environment&> : GivenInHandle<const Environment, EnvironmentHandle> { using GivenInHandle::GivenInHandle; };
template <> struct Given<const Particles&> : GivenInHandle<const Particles, ParticlesHandle> { using GivenInHandle::GivenInHandle; };
template <> struct Given<ComplexEdit&> : GivenInHandle<ComplexEdit, EditHandle> { using GivenInHandle::GivenInHandle; };
template <> struct Given<Transaction&> : GivenInHandle<Transaction, TransactionHandle> { using GivenInHandle::GivenInHandle; };
// clang-format on
// NOLINTEND(google-explicit-constructor)

// Ids must be those of the map. All else C++ checks by itself.
inline void expect(const CombinatorialMap& map, Cell c) { expect_cell(map, c); }
inline void expect(const CombinatorialMap& map, Dart d) { expect_dart(map, d); }
inline void expect(const CombinatorialMap& map, CellFace f) { expect_face(map, f); }
inline void expect(const CombinatorialMap& map, Vertex v) { expect_vertex(map, v); }
inline void expect(const CellComplex& complex, SimplexId s) { expect_simplex(complex.map(), s); }
inline void expect(const Transaction& transaction, Vertex v) { expect_vertex(transaction.map(), v); }
inline void expect(const ComplexEdit& /*edit*/, const Plane& plane) { expect_plane(plane); }
inline void expect(const CellComplex& /*complex*/, const Plane& plane) { expect_plane(plane); }
inline void expect(const ComplexEdit& /*edit*/, const std::vector<ConvexTool>& tools) {
  for (const ConvexTool& tool : tools) std::for_each(tool.planes.begin(), tool.planes.end(), expect_plane);
}
inline void expect(const Bodies& bodies, std::size_t body) {
  if (body >= bodies.size())
    throw InvalidArgument("there is no body " + std::to_string(body) + ": there are " + std::to_string(bodies.size()));
}
template <class Object, class T>
void expect(const Object& /*object*/, const T& /*argument*/) {}

/// A copy of a result.
template <class T>
T kept(const T& value) {
  return value;
}
template <class T>
auto kept(std::span<T> values) {
  using Value = std::conditional_t<std::is_enum_v<T>, std::uint8_t, std::remove_const_t<T>>;
  std::vector<Value> copies;
  copies.reserve(values.size());
  for (const T& value : values) copies.push_back(static_cast<Value>(value));
  return copies;
}
template <class T, std::size_t N>
std::vector<T> kept(const std::array<T, N>& values) {
  return {values.begin(), values.end()};
}
inline std::shared_ptr<ParticlesHandle> kept(const Particles& particles) {
  return std::make_shared<ParticlesHandle>(ParticlesHandle{particles});
}
template <class Function, class... Arguments>
auto kept_result(const Function& f, Arguments&&... arguments) {
  if constexpr (std::is_void_v<decltype(f(std::forward<Arguments>(arguments)...))>) {
    f(std::forward<Arguments>(arguments)...);
  } else {
    return kept(f(std::forward<Arguments>(arguments)...));
  }
}

/// Calls use(given...) with all arguments as C++ takes them.
template <class... Arguments, class Function, std::size_t... I>
auto with_given(std::span<const Argument> names, const Function& use, std::index_sequence<I...> /*all*/,
                const typename Given<Arguments>::Python&... python) {
  if constexpr (sizeof...(Arguments) == 0) {
    return use();
  } else {
    std::tuple<Given<Arguments>...> given(
        From<typename Given<Arguments>::Python>{python, I < names.size() ? names[I].name : ""}...);
    return use(std::get<I>(given).value...);
  }
}

/// A function of Python that calls a member function, or f(object, arguments...).
template <class Handle, class Object, class... Arguments, class Function>
auto calling_of(std::span<const Argument> names, const Function& f) {
  using Held = std::conditional_t<std::is_const_v<Object>, const Handle, Handle>;
  return [names, f](Held& handle, const typename Given<Arguments>::Python&... python) {
    return with_given<Arguments...>(
        names,
        [&](auto&... given) {
          const auto on = [&](Object& object) {
            (expect(object, given), ...);
            return kept_result([&](auto&... all) -> decltype(auto) { return f(object, all...); }, given...);
          };
          if constexpr (std::is_same_v<std::remove_const_t<Object>, Handle>) {
            return on(handle);
          } else if constexpr (std::is_const_v<Object>) {
            return read(handle, on);
          } else {
            return change(handle, on);
          }
        },
        std::index_sequence_for<Arguments...>(), python...);
  };
}
template <class Handle, class Result, class Object, class... Arguments>
auto calling(Result (Object::*f)(Arguments...) const, std::span<const Argument> names = {}) {
  return calling_of<Handle, const Object, Arguments...>(
      names, [f](const Object& o, auto&... given) -> decltype(auto) { return (o.*f)(given...); });
}
template <class Handle, class Result, class Object, class... Arguments>
auto calling(Result (Object::*f)(Arguments...), std::span<const Argument> names = {}) {
  return calling_of<Handle, Object, Arguments...>(
      names, [f](Object& o, auto&... given) -> decltype(auto) { return (o.*f)(given...); });
}
template <class Handle, class Result, class Object, class... Arguments>
auto calling(Result (*f)(const Object&, Arguments...), std::span<const Argument> names = {}) {
  return calling_of<Handle, const Object, Arguments...>(names, f);
}

inline About about_member(pybind11::handle type, const char* name, std::string_view text) {
  const std::string full = type.attr("__name__").cast<std::string>() + "::" + name;
  if (text.empty() || is_public(full)) {
    About found = about(full);
    if (!text.empty()) found.text = text;
    return found;
  }
  return {std::string(text), {}};
}

/// A method. `text`: its docstring, if the header does not say it.
template <class Handle, class... Options, class Function>
void method(pybind11::class_<Handle, Options...>& c, const char* name, Function f, std::string_view text = {}) {
  const About said = about_member(c, name, text);
  c.def(name, calling<Handle>(f, said.arguments), said);
}
/// The same without Python's lock: for what takes long.
template <class Handle, class... Options, class Result, class Object, class... Arguments>
void long_method(pybind11::class_<Handle, Options...>& c, const char* name, Result (Object::*f)(Arguments...) const,
                 std::string_view text = {}) {
  const About said = about_member(c, name, text);
  const auto unlocked = [f](const Object& object, auto&... given) {
    const pybind11::gil_scoped_release release;
    return (object.*f)(given...);
  };
  c.def(name, calling_of<Handle, const Object, Arguments...>(said.arguments, unlocked), said);
}
/// A property that can be read. Arrays are read-only.
template <class Handle, class... Options, class Function>
void property(pybind11::class_<Handle, Options...>& c, const char* name, Function f, std::string_view text = {}) {
  const auto get = [call = calling<Handle>(f)](const Handle& handle) { return reading(call(handle)); };
  c.def_property_readonly(name, get, about_member(c, name, text));
}

// Questions about a map are short.
struct Locked {};
template <class First>
using Unlocked =
    std::conditional_t<std::is_same_v<First, const CombinatorialMap&>, Locked, pybind11::gil_scoped_release>;

/// A function of the module. It runs without Python's lock, but for questions about a map. `said`: its arguments and
/// docstring, if there are several functions of this name.
template <class Result, class First, class... Arguments>
void function(pybind11::module_& m, const char* name, Result (*f)(First, Arguments...), const About& said) {
  const auto call = [f, names = said.arguments](const typename Given<First>::Python& first,
                                                const typename Given<Arguments>::Python&... python) {
    return with_given<First, Arguments...>(
        names,
        [&](auto& object, auto&... given) {
          [[maybe_unused]] const Unlocked<First> lock{};
          (expect(object, given), ...);
          return kept_result(f, object, given...);
        },
        std::make_index_sequence<1 + sizeof...(Arguments)>(), first, python...);
  };
  m.def(name, call, said);
}
template <class Function>
void function(pybind11::module_& m, const char* name, Function f, std::string_view more = {}) {
  function(m, name, f, about(name, more));
}

#include "members.inl"

}  // namespace dartcast::python
