// Points with data, lines and polygons, as a .vtp file that VTK writes.
#pragma once

#include <vtkNew.h>
#include <vtkPolyData.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "dartcast/vec3.hpp"

namespace dartcast {

/// A file under construction: points first, then lines and polygons, then data. Float64, flags UInt8.
class VtpWriter {
 public:
  VtpWriter(std::size_t count, const std::function<Vec3(std::size_t)>& point);

  /// Makes every point visible.
  void add_vertices();
  /// A line through all points in their order, where there are any.
  void add_line();
  /// Polygons: corners of one after the other, polygon i from offsets[i] to offsets[i + 1].
  void add_polygons(std::span<const std::size_t> offsets, std::span<const std::uint32_t> corners);

  void add(const std::string& name, const std::function<double(std::size_t)>& value);
  /// 0 or 1.
  void add_flags(const std::string& name, const std::function<bool(std::size_t)>& flag);
  void add_vectors(const std::string& name, const std::function<Vec3(std::size_t)>& value);

  /// Throws Error where the file cannot be written.
  void write(const std::filesystem::path& path) const;

 private:
  std::size_t count_;
  vtkNew<vtkPolyData> data_;
};

}  // namespace dartcast
