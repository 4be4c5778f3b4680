// Reads a mesh file: the ending chooses the format, then the mesh is checked and repaired.
#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_files.hpp"
#include "formats/checked_file.hpp"
#include "formats/file_text.hpp"
#include "formats/format_table.hpp"
#include "formats/openfoam.hpp"
#include "formats/read_memory.hpp"
#include "formats/vtp_surface.hpp"

namespace dartcast {
namespace {

/// As ".msh (Gmsh 1, 2 or 4; also .msh2, .msh4)".
std::string described(const MeshFormat& format) {
  std::string note(format.note);
  for (std::size_t i = 1; i < format.endings.size(); ++i)
    note += fmt::format("{}{}", i == 1 ? "; also " : ", ", format.endings[i].ending);
  const std::string_view ending = format.endings.front().ending;
  return note.empty() ? std::string(ending) : fmt::format("{} ({})", ending, note);
}

std::string supported() {
  std::vector<std::string> list;
  for (const MeshFormat& format : mesh_formats()) list.push_back(described(format));
  list.emplace_back("folders of OpenFOAM and SimVascular");
  return in_words(list, "and");
}

std::string endings_with_arrays() {
  std::vector<std::string> list;
  for (const MeshFormat& format : mesh_formats()) {
    if (format.arrays) list.emplace_back(format.endings.front().ending);
  }
  return in_words(list, "and");
}

ParsedMesh parse_folder(const std::filesystem::path& path, const ReadOptions& options) {
  if (!options.patch_array.empty())
    throw InvalidMesh(
        fmt::format("patches from the cell array '{}': a folder of OpenFOAM or SimVascular has patches of its own",
                    options.patch_array));
  return is_simvascular(path) ? parse_simvascular(path, options) : parse_openfoam(path, options);
}

ParsedMesh parse(const std::filesystem::path& path, const ReadOptions& options) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error) || ending_of(path) == ".foam" || is_openfoam(path))
    return parse_folder(path, options);
  const MeshFormat* format = mesh_format_of(path);
  if (format == nullptr) {
    throw InvalidMesh(fmt::format("files that end in '{}' are not supported; supported are {}{}", ending_of(path),
                                  supported(),
                                  is_surface_file(path) ? "; a surface in space is read by read_surface()" : ""));
  }
  if (!format->arrays && !options.patch_array.empty())
    throw InvalidMesh(fmt::format(
        "patches from the cell array '{}': arrays are in {} files; in this one groups of faces are the patches",
        options.patch_array, endings_with_arrays()));
  refuse_zeros(path);
  check_memory(format->memory(file_bytes(path)), options.max_memory);
  const std::string content = read_bytes(path);
  if (content.empty()) throw InvalidMesh("the file is empty");
  return format->read(path, without_byte_order_mark(content), options);
}

}  // namespace

MeshFile read_mesh(const std::filesystem::path& path, const ReadOptions& options) {
  return checked_file(path, "mesh", [&](MeshFile& out) {
    enter_stage(options, "reading the file");
    ParsedMesh parsed = parse(path, options);
    enter_stage(options, "checking the cells");
    check_memory(memory_of_mesh(parsed.mesh), options.max_memory);
    out.mesh = std::move(parsed.mesh);
    if (!out.mesh.types.empty()) out.report = check_and_repair(out.mesh);
    out.report.format = parsed.format;
    add_finding(out.report.defects, parsed.second_order);
    add_finding(out.report.defects, parsed.unsupported);
    add_finding(parsed.warnings, parsed.linearised);
    out.report.warnings.insert(out.report.warnings.begin(), parsed.warnings.begin(), parsed.warnings.end());
  });
}

MeshFile read_valid_mesh(const std::filesystem::path& path, const ReadOptions& options) {
  return valid_file(read_mesh(path, options));
}

}  // namespace dartcast
