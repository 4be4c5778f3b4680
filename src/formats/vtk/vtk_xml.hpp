// The pieces, sections and arrays of one of VTK's XML files, checked before VTK reads them.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "formats/vtk/vtu_array.hpp"

namespace dartcast {

/// Sections are Points, PointData and CellData, and those of cells: Cells of an UnstructuredGrid; Verts, Lines, Strips
/// and Polys of PolyData.
struct VtkXmlPiece {
  std::map<std::string, std::uint64_t, std::less<>> items;             ///< points or cells by section, as announced
  std::map<std::string, std::vector<VtuArray>, std::less<>> sections;  ///< the arrays of each section there is

  [[nodiscard]] std::uint64_t points() const { return items.at("Points"); }
  [[nodiscard]] std::uint64_t cells() const;
  /// The arrays of a section; none if it is missing.
  [[nodiscard]] const std::vector<VtuArray>& arrays(std::string_view section) const;
};

struct VtkXmlFile {
  VtuEncoding encoding;
  std::vector<VtkXmlPiece> pieces;
  std::vector<VtuArray> field;
};

/// Reads all tags of a file of this kind, "UnstructuredGrid" or "PolyData". VTK finds sections and arrays by their
/// names and by their order, and does not stop if one is missing. So each section must be in its place, once, and
/// hold nothing but arrays. Each array must have a unique name in its section. All pieces must have the same arrays
/// at points and cells. Throws InvalidMesh, with the line or the array, if that does not hold, a tag is damaged, or the
/// file is of another kind. Sizes and data are not checked.
VtkXmlFile read_vtk_xml(std::string_view content, std::string_view kind);

}  // namespace dartcast
