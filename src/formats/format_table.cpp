// The table of all mesh and surface formats, and look-ups by ending.
#include "formats/format_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/file_text.hpp"
#include "formats/gmsh.hpp"
#include "formats/medit.hpp"
#include "formats/mesh_pieces.hpp"
#include "formats/read_memory.hpp"
#include "formats/surface_formats.hpp"
#include "formats/surface_write.hpp"
#include "formats/tetgen_files.hpp"
#include "formats/vtk.hpp"
#include "formats/vtp_surface.hpp"
#include "formats/vtu_write.hpp"

namespace dartcast {
namespace {

namespace fs = std::filesystem;

template <std::string (*format)(const MeshData&)>
void write_text(const MeshData& mesh, const fs::path& file) {
  write_bytes(file, format(mesh));
}

template <ParsedMesh (*parse)(std::string_view, bool)>
ParsedMesh read_text(const fs::path& /*path*/, std::string_view content, const ReadOptions& options) {
  return parse(content, options.linearise);
}

template <ParsedSurface (*parse)(std::string_view)>
ParsedSurface read_surface_text(std::string_view content, std::uint64_t /*max_memory*/) {
  return parse(content);
}

// The pieces are checked one by one.
std::uint64_t memory_of_index(std::uint64_t file) { return file; }
std::uint64_t memory_of_xml(std::uint64_t file) { return memory_of_vtk({.file = file}); }

}  // namespace

std::span<const MeshFormat> mesh_formats() {
  static const std::vector<MeshFormat> formats = {
      {"VTK", "", {{".vtu", write_vtu}}, true, true, memory_of_xml, parse_vtu},
      {"VTK", "in pieces", {{".pvtu", nullptr}}, false, true, memory_of_index, read_pieces},
      {"VTK", "legacy", {{".vtk", write_legacy_vtk}}, true, true, memory_of_text, parse_legacy_vtk},
      {"Gmsh",
       "Gmsh 1, 2 or 4",
       {{".msh", write_text<format_gmsh_2>},
        {".msh2", write_text<format_gmsh_2>},
        {".msh4", write_text<format_gmsh_4>}},
       false,
       false,
       memory_of_text,
       read_text<parse_gmsh>},
      {"Medit", "Medit", {{".mesh", write_text<format_medit>}}, false, false, memory_of_text, read_text<parse_medit>},
      {"Medit", "Medit, binary", {{".meshb", nullptr}}, false, false, memory_of_text, read_text<parse_meshb>},
      {"TetGen", "TetGen", {{".ele", nullptr}, {".node", nullptr}}, false, false, memory_of_text, parse_tetgen}};
  return formats;
}

std::span<const SurfaceFormat> surface_formats() {
  static const std::vector<SurfaceFormat> formats = {
      {"Stereolithography", ".stl", read_surface_text<parse_stl>, write_text<format_stl>},
      {"Wavefront", ".obj", read_surface_text<parse_obj>, write_text<format_obj>},
      {"Stanford", ".ply", read_surface_text<parse_ply>, write_text<format_ply>},
      {"Geomview", ".off", read_surface_text<parse_off>, write_text<format_off>},
      {"VTK", ".vtp", parse_vtp_surface, write_vtp_surface}};
  return formats;
}

std::string ending_of(const fs::path& path) { return in_lower_case(path.extension().string()); }

const FormatEnding* mesh_ending_of(const fs::path& path) {
  const std::string ending = ending_of(path);
  for (const MeshFormat& format : mesh_formats()) {
    for (const FormatEnding& e : format.endings) {
      if (e.ending == ending) return &e;
    }
  }
  return nullptr;
}

const MeshFormat* mesh_format_of(const fs::path& path) {
  const FormatEnding* ending = mesh_ending_of(path);
  for (const MeshFormat& format : mesh_formats()) {
    for (const FormatEnding& e : format.endings) {
      if (&e == ending) return &format;
    }
  }
  return nullptr;
}

const SurfaceFormat* surface_format_of(const fs::path& path) {
  const std::string ending = ending_of(path);
  for (const SurfaceFormat& format : surface_formats()) {
    if (format.ending == ending) return &format;
  }
  return nullptr;
}

std::string in_words(std::span<const std::string> items, std::string_view last) {
  if (items.size() < 2) return fmt::format("{}", fmt::join(items, ""));
  return fmt::format("{} {} {}", fmt::join(items.first(items.size() - 1), ", "), last, items.back());
}

std::vector<std::string> mesh_endings() {
  std::vector<std::string> endings;
  for (const MeshFormat& format : mesh_formats()) {
    for (const FormatEnding& e : format.endings) endings.emplace_back(e.ending);
  }
  return endings;
}

std::vector<std::string> writable_mesh_endings() {
  std::vector<std::string> endings;
  for (const MeshFormat& format : mesh_formats()) {
    for (const FormatEnding& e : format.endings) {
      if (e.write != nullptr) endings.emplace_back(e.ending);
    }
  }
  return endings;
}

std::vector<std::string> surface_endings() {
  std::vector<std::string> endings;
  for (const SurfaceFormat& format : surface_formats()) {
    endings.emplace_back(format.ending);
  }
  return endings;
}

}  // namespace dartcast
