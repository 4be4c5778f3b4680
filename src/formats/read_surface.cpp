// Reads a file of a surface in space: the ending chooses the format, then the surface is checked and repaired.
#include <fmt/format.h>

#include <string>
#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "formats/checked_file.hpp"
#include "formats/file_text.hpp"
#include "formats/format_table.hpp"
#include "formats/read_memory.hpp"
#include "surface/check_surface.hpp"

namespace dartcast {

ParsedSurface parse_surface(const std::filesystem::path& path, std::uint64_t max_memory) {
  const SurfaceFormat* format = surface_format_of(path);
  if (format == nullptr) {
    throw InvalidMesh(fmt::format("surfaces in files that end in '{}' are not supported; supported are {}",
                                  ending_of(path), in_words(surface_endings(), "and")));
  }
  refuse_zeros(path);
  check_memory(memory_of_text(file_bytes(path)), max_memory);
  const std::string content = read_bytes(path);
  if (content.empty()) throw InvalidMesh("the file is empty");
  // The bytes of a binary .stl may be any: its reader decides.
  return format->read(format->ending == ".stl" ? content : without_byte_order_mark(content), max_memory);
}

bool is_surface_file(const std::filesystem::path& path) { return surface_format_of(path) != nullptr; }

MeshFile check_surface(const std::filesystem::path& path, const ReadOptions& options) {
  return checked_file(path, "surface", [&](MeshFile& out) {
    ParsedSurface parsed = parse_surface(path, options.max_memory);
    check_memory(memory_of_mesh(parsed.mesh), options.max_memory);
    out.mesh = std::move(parsed.mesh);
    out.report = check_and_repair_surface(out.mesh);
    out.report.format = parsed.format;
    out.report.warnings.insert(out.report.warnings.begin(), parsed.warnings.begin(), parsed.warnings.end());
    out.report.repairs.insert(out.report.repairs.begin(), parsed.repairs.begin(), parsed.repairs.end());
  });
}

MeshFile read_surface(const std::filesystem::path& path, const ReadOptions& options) {
  return valid_file(check_surface(path, options));
}

}  // namespace dartcast
