// Surfaces as .vtp files, in text.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <vector>

#include "dartcast/vec3.hpp"

namespace dartcast::test {

/// A .vtp file of polygons; `arrays`: more XML, in the elements of arrays at points and at cells.
inline std::string vtp_text(const std::vector<Vec3>& points, const std::vector<std::vector<std::uint32_t>>& faces,
                            const std::string& at_points = "", const std::string& at_cells = "") {
  std::string xyz, corners, offsets;
  std::size_t end = 0;
  for (const Vec3& p : points) xyz += fmt::format("{:.17g} {:.17g} {:.17g}\n", p.x, p.y, p.z);
  for (const auto& face : faces) {
    for (const std::uint32_t p : face) corners += fmt::format("{} ", p);
    offsets += fmt::format("{} ", end += face.size());
  }
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\"><PolyData>\n"
      "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
      "NumberOfPolys=\"{}\">\n"
      "<PointData>{}</PointData>\n<CellData>{}</CellData>\n<Points>\n<DataArray type=\"Float64\" "
      "NumberOfComponents=\"3\" "
      "format=\"ascii\">\n{}</DataArray></Points>\n<Polys>\n<DataArray type=\"Int64\" Name=\"connectivity\" "
      "format=\"ascii\">\n{}</DataArray>\n<DataArray type=\"Int64\" Name=\"offsets\" "
      "format=\"ascii\">\n{}</DataArray>\n"
      "</Polys></Piece></PolyData></VTKFile>\n",
      points.size(), faces.size(), at_points, at_cells, xyz, corners, offsets);
}

/// An array of whole numbers.
inline std::string vtp_array(const std::string& name, const std::vector<std::int64_t>& values) {
  std::string text;
  for (const std::int64_t v : values) text += std::to_string(v) + " ";
  return fmt::format("<DataArray type=\"Int64\" Name=\"{}\" format=\"ascii\">{}</DataArray>", name, text);
}

}  // namespace dartcast::test
