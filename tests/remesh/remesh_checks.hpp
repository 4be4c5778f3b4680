// What must hold of a complex whatever was done to it, and what tells two complexes apart but for cells' numbers.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "dartcast/geometry/complex.hpp"
#include "dartcast/geometry/validity.hpp"
#include "dartcast/map/integrity.hpp"
#include "exact/dyadic.hpp"

namespace dartcast::test {

inline void expect_good(const Complex& complex) {
  const auto violations = check_integrity(complex.map(), 3);
  for (const Violation& v : violations) ADD_FAILURE() << v.constraint << ": " << v.message;
  const Validity validity = check_validity(complex, Threads{1}, 3);
  for (const InvalidCell& c : validity.first) ADD_FAILURE() << c.message;
}

/// Six times the volume of all implicit simplices, exactly.
inline Dyadic volume6(const Complex& complex) {
  Dyadic sum;
  for (const Cell c : complex.map().cells()) {
    for (std::uint16_t s = 0; s < complex.map().shape(c).simplices().size(); ++s) {
      const Corners v = complex.corners({c, s});
      sum = sum + determinant(v[0], v[1], v[2], v[3]);
    }
  }
  return sum;
}

/// A cell by its vertices: source, mark, and each face with its patch, its marks, and whether it is open.
inline std::string written(const Map& map, Cell c) {
  const Shape& s = map.shape(c);
  std::vector<std::string> faces;
  for (std::uint16_t f = 0; f < s.face_count(); ++f) {
    std::string face;
    for (std::uint16_t d = s.first_dart(f); d < s.first_dart(f) + s.degree(f); ++d) {
      const Map::Flat flat = map.flat({c, d});
      face += std::to_string(map.origin({c, d}).value) + (flat.straight ? "s" : "") + (flat.coplanar ? "c" : "") + " ";
    }
    const CellFace other = map.opposite({c, f});
    face += "| patch " + std::to_string(map.patch(CellFace{c, f}).value) +
            (other.valid() ? " to " + std::to_string(map.source(other.cell)) : " open");
    faces.push_back(face);
  }
  std::sort(faces.begin(), faces.end());
  std::string text = std::to_string(map.source(c)) + (map.is_free(c) ? " free" : " blocked");
  for (const std::string& face : faces) text += "; " + face;
  return text;
}

inline std::vector<std::string> written(const Map& map) {
  std::vector<std::string> cells;
  for (const Cell c : map.cells()) cells.push_back(written(map, c));
  std::sort(cells.begin(), cells.end());
  return cells;
}

}  // namespace dartcast::test
