#include <fmt/format.h>

#include <string>
#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "formats/checked_file.hpp"
#include "formats/file_text.hpp"
#include "formats/obj.hpp"
#include "formats/off.hpp"
#include "formats/parsed_surface.hpp"
#include "formats/ply.hpp"
#include "formats/read_memory.hpp"
#include "formats/stl.hpp"
#include "surface/check_surface.hpp"

namespace dartcast {
namespace {

ParsedSurface parse_surface(const std::filesystem::path& path, const ReadOptions& options) {
  const std::string ending = ending_of(path);
  const bool stl = ending == ".stl";
  const bool obj = ending == ".obj";
  const bool ply = ending == ".ply";
  if (!is_surface_file(path)) {
    throw InvalidMesh(fmt::format(
        "surfaces in files that end in '{}' are not supported; supported are .stl, .obj, .ply and .off", ending));
  }
  check_memory(memory_of_text(file_bytes(path)), options.max_memory);
  const std::string content = read_bytes(path);
  if (content.empty()) throw InvalidMesh("the file is empty");
  if (stl) return parse_stl(content);
  if (obj) return parse_obj(content);
  return ply ? parse_ply(content) : parse_off(content);
}

}  // namespace

bool is_surface_file(const std::filesystem::path& path) {
  const std::string ending = ending_of(path);
  return ending == ".stl" || ending == ".obj" || ending == ".ply" || ending == ".off";
}

MeshFile check_surface(const std::filesystem::path& path, const ReadOptions& options) {
  return checked_file(path, "surface", [&](MeshFile& out) {
    ParsedSurface parsed = parse_surface(path, options);
    check_memory(memory_of_mesh(parsed.mesh), options.max_memory);
    out.mesh = std::move(parsed.mesh);
    out.report = check_and_repair_surface(out.mesh);
    out.report.format = parsed.format;
    if (parsed.short_faces.count > 0)
      out.report.warnings.insert(out.report.warnings.begin(), std::move(parsed.short_faces));
    out.report.repairs.insert(out.report.repairs.begin(), parsed.repairs.begin(), parsed.repairs.end());
  });
}

MeshFile read_surface(const std::filesystem::path& path, const ReadOptions& options) {
  return valid_file(check_surface(path, options));
}

}  // namespace dartcast
