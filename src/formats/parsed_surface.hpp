// The result of a reader of one surface format, before the surface is checked.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_data.hpp"
#include "formats/file_text.hpp"

namespace dartcast {

/// Cells are triangles, quadrilaterals and polygons. Ids that name no point are kept as 0xffffffff, for
/// check_and_repair_surface() to find.
struct ParsedSurface {
  MeshData mesh;
  std::string format;
  std::vector<Finding> repairs;
  std::vector<Finding> warnings;  ///< of the format itself; finish() adds short_faces
  Finding short_faces{"short_faces", 0, {}, "faces of one or two corners; they have been left out"};

  /// Adds a face of 3 to 1000 corners; a face of one or two is left out. Throws InvalidMesh with the line, or with
  /// the byte in binary parts, if it has none or more, or if there are too many faces.
  void add_face(std::span<const std::uint32_t> corners, const FileText& text, bool binary = false);
  /// Throws InvalidMesh, likewise, if a coordinate is not finite or there are too many points.
  void add_point(const Vec3& point, const FileText& text, bool binary = false);
  /// Faces that follow are in the region of this name (without the white space around it); with an empty one in none.
  void enter_region(std::string_view name);
  /// Counts one more place if the file is not written as the format says.
  void warn(std::string_view message);
  /// To be called at the end: without a region regions stay empty. Throws InvalidMesh if there is no face.
  void finish();

 private:
  std::int32_t region_ = 0;
  std::map<std::string, std::int32_t, std::less<>> tags_;
};

/// Reads the file by its ending, unchecked. Throws InvalidMesh with the line or byte. `max_memory` as ReadOptions.
ParsedSurface parse_surface(const std::filesystem::path& path, std::uint64_t max_memory);

}  // namespace dartcast
