// Records of C++ as rows of structured arrays: contacts, walls, states, locations. Rows are copies. The columns are in
// tools/make_bindings.py, which writes rows.inl.
#pragma once

#include <pybind11/numpy.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "dartcast/dartcast.hpp"
#include "support/arrays.hpp"
#include "support/docs.hpp"
#include "support/records.hpp"

namespace dartcast::python {

using Row3 = std::array<double, 3>;

/// A contact, with what its first wall has.
struct ContactAtWall : Contact {
  Patch patch;
  Vec3 normal;
};

// Entries of rows: numbers, and arrays of them.
inline Row3 column(const Vec3& v) { return {v.x, v.y, v.z}; }
inline std::array<Row3, 2> column(const std::array<Vec3, 2>& v) { return {column(v[0]), column(v[1])}; }
inline std::array<Row3, 3> column(const std::array<Vec3, 3>& v) { return {column(v[0]), column(v[1]), column(v[2])}; }
inline std::uint32_t column(Cell c) { return c.value; }
inline std::uint16_t column(Patch p) { return p.value; }
template <class T>
auto column(const T& x) {
  if constexpr (std::is_enum_v<T>) {
    return static_cast<std::uint8_t>(x);
  } else {
    return x;
  }
}
inline std::array<std::uint32_t, 3> cells_of(const std::array<CellFace, 3>& f) {
  return {f[0].cell.value, f[1].cell.value, f[2].cell.value};
}
inline std::array<std::uint16_t, 3> faces_of(const std::array<CellFace, 3>& f) {
  return {f[0].face, f[1].face, f[2].face};
}

#include "rows.inl"

/// Makes the dtypes known. To be called once, first.
void register_rows();

/// A fresh array with a row for each item.
template <class Items>
pybind11::array rows_of(const Items& items) {
  std::vector<decltype(row_of(*items.begin()))> rows(items.size());  // gaps are zero
  {
    const pybind11::gil_scoped_release release;
    for (std::size_t i = 0; i < rows.size(); ++i) fill(items[i], rows[i]);
  }
  return array_of(std::move(rows));
}
pybind11::array rows_of(const std::vector<Contact>& contacts, std::span<const WallHit> walls);

/// A struct that Python can only read, under construction.
template <class T>
class ReadOnly {
 public:
  ReadOnly(const pybind11::module_& m, const char* name) : class_(m, name, doc(name)), name_(name) {}

  template <class M>
  ReadOnly& member(const char* name, M T::*member) {
    class_.def_property_readonly(
        name, [member](const T& t) { return reading(t.*member); }, about(name_ + "::" + name));
    return *this;
  }
  /// A structured array. `text`: its columns.
  template <class M>
  ReadOnly& rows(const char* name, M T::*member, const char* text) {
    class_.def_property_readonly(
        name, [member](const T& t) { return rows_of(t.*member); }, about(name_ + "::" + name, text));
    return *this;
  }

 private:
  pybind11::class_<T> class_;
  std::string name_;
};

/// An array (n,) of this dtype, from one whose fields have the same names and types. Where they stand makes no
/// difference: numpy.concatenate() packs them. Throws TypeError for another array; `expected` and `remedy`: of its text.
pybind11::array structured(const pybind11::object& x, const pybind11::dtype& wanted, const char* name,
                           const char* expected, const char* remedy);

/// States from an array as rows_of() makes it. Throws TypeError for another dtype.
std::vector<ParticleState> states_of(const pybind11::object& x, const char* name);
/// Weights from float64 (count, 4); None: no particle is held. Throws TypeError for another array.
std::vector<Weights> weights_of(const pybind11::object& given, std::size_t count);

}  // namespace dartcast::python
