// Points with data, lines and polygons, as a .vtp file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/vec3.hpp"
#include "formats/xml_write.hpp"

namespace dartcast {

/// A file under construction: points first, then lines and polygons, then data.
class VtpFile {
 public:
  explicit VtpFile(std::vector<Vec3> points);

  /// Makes every point visible.
  void add_vertices();
  /// A line through all points in their order, if there are any.
  void add_line();
  /// Polygons: corners of one after the other, polygon i from offsets[i] to offsets[i + 1].
  void add_polygons(std::span<const std::size_t> offsets, std::span<const std::uint32_t> corners);
  /// Lines in the same way.
  void add_lines(std::span<const std::size_t> offsets, std::span<const std::uint32_t> corners);
  /// A value for each point.
  template <class T>
  void add(std::string name, std::vector<T> values) {
    data_.section("PointData").arrays.emplace_back(std::move(name), std::move(values));
  }
  /// A value for each line or polygon.
  template <class T>
  void add_for_cells(std::string name, std::vector<T> values) {
    data_.section("CellData").arrays.emplace_back(std::move(name), std::move(values));
  }
  /// Texts that belong to the whole.
  void add_texts(std::string name, std::span<const std::string> texts);

  [[nodiscard]] const XmlDataSet& data() const { return data_; }

 private:
  void add_cells(std::string_view section, std::vector<std::uint32_t> connectivity, std::vector<std::int64_t> offsets);

  std::size_t count_;
  XmlDataSet data_;
};

}  // namespace dartcast
