// Checks that hold for a complex after every edit, and the differences of two complexes apart from cell numbers.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/validity.hpp"
#include "support/volume.hpp"

namespace dartcast::test {

void expect_sound(const CellComplex& complex);

/// A cell by the names of its vertices: source, mark, and each face with its patch, its marks, and what is beyond.
template <class Name>
std::string written(const CombinatorialMap& map, Cell c, Name&& name) {
  const Shape& s = map.shape(c);
  std::vector<std::string> faces;
  for (std::uint16_t f = 0; f < s.face_count(); ++f) {
    std::vector<std::string> corners;
    for (std::uint16_t d = s.first_dart(f); d < s.first_dart(f) + s.degree(f); ++d) {
      const CombinatorialMap::Flat flat = map.flat({c, d});
      corners.push_back(name(map.origin({c, d})) + (flat.straight ? "s" : "") + (flat.coplanar ? "c" : "") + " ");
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    std::string face;
    for (const std::string& corner : corners) face += corner;
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

template <class Name>
std::vector<std::string> written(const CombinatorialMap& map, Name&& name) {
  std::vector<std::string> cells;
  for (const Cell c : map.cells()) cells.push_back(written(map, c, name));
  std::sort(cells.begin(), cells.end());
  return cells;
}

std::vector<std::string> written(const CombinatorialMap& map);

/// Vertices by where they are: what does not depend on the order of edits.
std::vector<std::string> written_by_place(const CellComplex& complex);

}  // namespace dartcast::test
