// VTK's XML files: a header that names the arrays, and their bytes behind it as they are in memory, or compressed.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/xml_array.hpp"

namespace dartcast {

struct XmlSection {
  std::string_view name;  ///< PointData, CellData, Points, Cells, Verts ...
  std::vector<XmlArray> arrays;
};

/// A data set of one piece.
struct XmlDataSet {
  std::string_view kind;                                         ///< PolyData or UnstructuredGrid
  std::vector<std::pair<std::string_view, std::size_t>> counts;  ///< by attribute of the piece: NumberOfPoints ...
  std::vector<XmlArray> field;
  std::vector<XmlSection> sections;  ///< in VTK's order

  /// Precondition: there is one of this name.
  [[nodiscard]] XmlSection& section(std::string_view name);
  /// The bytes that the arrays of all sections hold.
  [[nodiscard]] std::size_t bytes() const;
};

/// write_pieces() or replace_file().
using WritePieces = void (*)(const std::filesystem::path& path, std::span<const std::string_view> pieces);

/// Throws Error if the file cannot be written.
void write_xml(const std::filesystem::path& path, const XmlDataSet& data, Compression compression, WritePieces write);

/// A data set of several pieces, in files of their own that hold the same arrays as `data`. `pieces`: their names, from
/// the folder of `path`. Throws as write_xml().
void write_xml_of_pieces(const std::filesystem::path& path, const XmlDataSet& data,
                         std::span<const std::string> pieces);

}  // namespace dartcast
