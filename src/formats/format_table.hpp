// The table of all mesh and surface formats. A new format adds a row here, and a file with its functions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dartcast/mesh_data.hpp"
#include "dartcast/mesh_files.hpp"
#include "formats/parsed_mesh.hpp"
#include "formats/parsed_surface.hpp"

namespace dartcast {

/// An ending, with its dot, in lower case, and the function that writes such files; null if none does.
struct FormatEnding {
  std::string_view ending;
  void (*write)(const MeshData& mesh, const std::filesystem::path& file);
};

struct MeshFormat {
  std::string_view name;
  std::string_view note;  ///< the versions, for lists of formats; empty: none
  std::vector<FormatEnding> endings;
  // The data that it can hold beside points, simple cells, regions and patches.
  bool arrays;     ///< of values at points and cells
  bool polyhedra;  ///< and polygons and faces of more than four corners
  /// Memory that reading a file of so many bytes takes at least.
  std::uint64_t (*memory)(std::uint64_t file);
  ParsedMesh (*read)(const std::filesystem::path& path, std::string_view content, const ReadOptions& options);
};

struct SurfaceFormat {
  std::string_view name;
  std::string_view ending;
  ParsedSurface (*read)(std::string_view content, std::uint64_t max_memory);
  void (*write)(const MeshData& surface, const std::filesystem::path& file);
};

std::span<const MeshFormat> mesh_formats();
std::span<const SurfaceFormat> surface_formats();

/// The format of a path's ending; none if the table has no such ending.
const MeshFormat* mesh_format_of(const std::filesystem::path& path);
const SurfaceFormat* surface_format_of(const std::filesystem::path& path);
/// The function that writes files of a path's ending; none likewise.
const FormatEnding* mesh_ending_of(const std::filesystem::path& path);

/// The ending of a path with its dot, in lower case.
std::string ending_of(const std::filesystem::path& path);

/// A list in words: "a, b and c", with `last` between the last two.
std::string in_words(std::span<const std::string> items, std::string_view last);

}  // namespace dartcast
