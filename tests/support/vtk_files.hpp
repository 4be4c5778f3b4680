// Small files of VTK, made array by array, for the tests of their readers.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "support/sample_mesh.hpp"

namespace dartcast::test {

/// How a VTK XML file holds the numbers of its arrays.
enum class XmlData { ascii, inline_base64, appended_base64, appended_raw };

inline std::vector<XmlData> xml_data_kinds() {
  return {XmlData::ascii, XmlData::inline_base64, XmlData::appended_base64, XmlData::appended_raw};
}

/// Writes the arrays of one XML file; appended data are collected.
class XmlArrays {
 public:
  explicit XmlArrays(XmlData how) : how_(how) {}

  /// One <DataArray>; `attributes`: its name, components and whatever else. `type`: of VTK.
  std::string add(std::string_view type, std::string_view attributes, const std::vector<double>& values) {
    const std::string head = fmt::format("<DataArray type=\"{}\" {}", type, attributes);
    if (how_ == XmlData::ascii)
      return fmt::format("{} format=\"ascii\">{}</DataArray>\n", head, fmt::join(values, " "));
    Bytes data;
    for (const double x : values) add_number(data, type, x);
    Bytes size;
    size.number(static_cast<std::uint32_t>(data.out.size()));
    const std::string bytes = how_ == XmlData::appended_raw ? size.out + data.out : base64(size.out + data.out);
    if (how_ == XmlData::inline_base64) return fmt::format("{} format=\"binary\">{}</DataArray>\n", head, bytes);
    appended_ += bytes;
    return fmt::format("{} format=\"appended\" offset=\"{}\"/>\n", head, appended_.size() - bytes.size());
  }

  /// The text behind the data set.
  [[nodiscard]] std::string appended() const {
    if (how_ == XmlData::ascii || how_ == XmlData::inline_base64) return "";
    return fmt::format("<AppendedData encoding=\"{}\">\n_{}\n</AppendedData>\n",
                       how_ == XmlData::appended_raw ? "raw" : "base64", appended_);
  }

 private:
  static void add_number(Bytes& data, std::string_view type, double x) {
    if (type == "Float64") data.number(x);
    if (type == "Float32") data.number(static_cast<float>(x));
    if (type == "Int64") data.number(static_cast<std::int64_t>(x));
    if (type == "Int32") data.number(static_cast<std::int32_t>(x));
    if (type == "UInt8" || type == "String") data.number(static_cast<std::uint8_t>(x));
  }

  XmlData how_;
  std::string appended_;
};

/// The texts' characters as an array of type String has them.
inline std::vector<double> characters(const std::vector<std::string>& texts) {
  std::vector<double> out;
  for (const std::string& text : texts) {
    for (const char c : text) out.push_back(static_cast<unsigned char>(c));
    out.push_back(0.0);
  }
  return out;
}

/// Two hexahedra beside each other in one piece or, one each, in two, with arrays in all sections. `more`: further
/// arrays in <CellData>.
inline std::string cubes_vtu(XmlData how, int pieces = 1, bool point_data = true) {
  XmlArrays arrays(how);
  std::string out =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt32\">\n<UnstructuredGrid>\n<FieldData>\n";
  out += arrays.add("Float64", "Name=\"TimeValue\" NumberOfTuples=\"1\"", {0.5});
  out += arrays.add("String", "Name=\"title\" NumberOfTuples=\"1\"", characters({"two cubes"})) + "</FieldData>\n";
  for (int p = 0; p < pieces; ++p) {
    const int cells = 3 - pieces;
    std::vector<double> points;
    std::vector<double> corners;
    for (int x = 0; x <= cells; ++x) {
      for (int k = 0; k < 4; ++k)
        points.insert(points.end(), {static_cast<double>(x + p), k > 1 ? 1.0 : 0.0, k % 2 == 1 ? 1.0 : 0.0});
    }
    for (int c = 0; c < cells; ++c) {
      for (const int k : {0, 4, 6, 2, 1, 5, 7, 3}) corners.push_back(4 * c + k);
    }
    const auto n = static_cast<std::size_t>(cells);
    out += fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", points.size() / 3, cells);
    if (point_data) {
      out += "<PointData Scalars=\"heat\">\n" +
             arrays.add("Float64", "Name=\"heat\"", std::vector<double>(points.size() / 3, 1.5)) +
             arrays.add("Float32", "Name=\"speed\" NumberOfComponents=\"3\"", points) + "</PointData>\n";
    }
    out += "<CellData>\n" + arrays.add("UInt8", "Name=\"free\"", std::vector<double>(n, 1.0)) +
           arrays.add("Int32", "Name=\"region\"", std::vector<double>(n, 4.0)) +
           arrays.add("Float64", "Name=\"flow\" NumberOfComponents=\"2\"", std::vector<double>(2 * n, 0.25)) +
           "</CellData>\n<Points>\n" + arrays.add("Float64", "Name=\"Points\" NumberOfComponents=\"3\"", points) +
           "</Points>\n<Cells>\n" + arrays.add("Int64", "Name=\"connectivity\"", corners) +
           arrays.add("Int64", "Name=\"offsets\"", n == 1 ? std::vector<double>{8} : std::vector<double>{8, 16}) +
           arrays.add("UInt8", "Name=\"types\"", std::vector<double>(n, 12.0)) + "</Cells>\n</Piece>\n";
  }
  return out + "</UnstructuredGrid>\n" + arrays.appended() + "</VTKFile>\n";
}

/// Three points with a vertex cell each, as PolyData.
inline std::string points_vtp(XmlData how) {
  XmlArrays arrays(how);
  std::string out =
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt32\">\n<PolyData>\n"
      "<Piece NumberOfPoints=\"3\" NumberOfVerts=\"2\" NumberOfLines=\"1\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n";
  out += "<PointData>\n" + arrays.add("Float64", "Name=\"radius\"", {1, 2, 3}) +
         arrays.add("Float64", "Name=\"velocity\" NumberOfComponents=\"3\"", {1, 0, 0, 0, 1, 0, 0, 0, 1}) +
         "</PointData>\n<CellData>\n" + arrays.add("Int32", "Name=\"kind\"", {1, 2, 3}) + "</CellData>\n<Points>\n" +
         arrays.add("Float64", "Name=\"Points\" NumberOfComponents=\"3\"", {0, 0, 0, 1, 0, 0, 0, 1, 0}) +
         "</Points>\n<Verts>\n" + arrays.add("Int64", "Name=\"connectivity\"", {0, 1}) +
         arrays.add("Int64", "Name=\"offsets\"", {1, 2}) + "</Verts>\n<Lines>\n" +
         arrays.add("Int64", "Name=\"connectivity\"", {1, 2}) + arrays.add("Int64", "Name=\"offsets\"", {2}) +
         "</Lines>\n</Piece>\n</PolyData>\n";
  return out + arrays.appended() + "</VTKFile>\n";
}

/// The same two hexahedra in the legacy format, section by section.
inline std::vector<std::string> cubes_vtk_sections(bool binary) {
  const auto numbers = [&](std::string_view type, const std::vector<double>& values) {
    if (!binary) return fmt::format("{}\n", fmt::join(values, " "));
    Bytes data(true);
    for (const double x : values) {
      if (type == "double") data.number(x);
      if (type == "int") data.number(static_cast<std::int32_t>(x));
    }
    return data.out + "\n";
  };
  std::vector<double> points;
  for (int x = 0; x <= 2; ++x) {
    for (int k = 0; k < 4; ++k)
      points.insert(points.end(), {static_cast<double>(x), k > 1 ? 1.0 : 0.0, k % 2 == 1 ? 1.0 : 0.0});
  }
  return {
      fmt::format("# vtk DataFile Version 3.0\ntwo cubes\n{}\nDATASET UNSTRUCTURED_GRID\n",
                  binary ? "BINARY" : "ASCII"),
      "FIELD FieldData 1\nTimeValue 1 1 double\n" + numbers("double", {0.5}),
      "POINTS 12 double\n" + numbers("double", points),
      "CELLS 2 18\n" + numbers("int", {8, 0, 4, 6, 2, 1, 5, 7, 3, 8, 4, 8, 10, 6, 5, 9, 11, 7}),
      "CELL_TYPES 2\n" + numbers("int", {12, 12}),
      "CELL_DATA 2\n",
      "SCALARS region int 1\nLOOKUP_TABLE default\n" + numbers("int", {4, 4}),
      "VECTORS flow double\n" + numbers("double", {1, 2, 3, 4, 5, 6}),
      "FIELD FieldData 2\nfree 1 2 int\n" + numbers("int", {1, 1}) + "heat 1 2 double\n" + numbers("double", {7, 8}),
      "POINT_DATA 12\n",
      "SCALARS speed double 3\nLOOKUP_TABLE default\n" + numbers("double", points),
      "FIELD FieldData 1\nheat 1 12 double\n" + numbers("double", std::vector<double>(12, 1.5))};
}

inline std::string joined(const std::vector<std::string>& parts) {
  std::string out;
  for (const std::string& part : parts) out += part;
  return out;
}

}  // namespace dartcast::test
