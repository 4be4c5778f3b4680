#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string>

#include "dartcast/error.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_files.hpp"
#include "formats/checked_file.hpp"
#include "formats/file_text.hpp"
#include "formats/gmsh.hpp"
#include "formats/medit.hpp"
#include "formats/parsed_mesh.hpp"
#include "formats/read_memory.hpp"
#include "formats/vtk_mesh.hpp"

namespace dartcast {
namespace {

constexpr std::string_view supported =
    ".vtu, .vtk (legacy), .msh (Gmsh 1, 2 or 4; also .msh2, .msh4) and .mesh (Medit)";

bool starts(std::string_view text, std::string_view with) { return text.substr(0, with.size()) == with; }

/// The content from its first byte that is not white space.
std::string_view body(std::string_view content) {
  return content.substr(std::min(content.find_first_not_of(" \t\r\n"), content.size()));
}

ParsedMesh parse_msh(std::string_view content) {
  const std::string_view text = body(content);
  if (starts(text, "("))
    throw InvalidMesh("this .msh is of ANSYS Fluent, which is not supported; convert it to Gmsh's");
  if (starts(text, "$")) return parse_gmsh(content);
  if (starts(text, "MeshVersionFormatted")) throw InvalidMesh("this .msh is of Medit; rename it to .mesh");
  throw InvalidMesh("this .msh is not of Gmsh: it does not start with '$'");
}

ParsedMesh parse_mesh(std::string_view content) {
  const std::string_view text = body(content);
  if (starts(text, "MFEM NC mesh")) {
    throw InvalidMesh(
        "this .mesh is of MFEM, non-conforming (MFEM NC mesh), which is not supported; make it conforming and write "
        "Gmsh's or VTK's format");
  }
  if (starts(text, "MFEM ")) {
    throw InvalidMesh(fmt::format("this .mesh is of MFEM ({}), which is not supported; write Gmsh's or VTK's format",
                                  text.substr(0, std::min<std::size_t>(text.find_first_of("\r\n"), 40))));
  }
  return parse_medit(content);
}

ParsedMesh parse(const std::filesystem::path& path, const ReadOptions& options) {
  const std::string ending = ending_of(path);
  const bool vtu = ending == ".vtu";
  const bool vtk = ending == ".vtk";
  const bool msh = ending == ".msh" || ending == ".msh2" || ending == ".msh4";
  if (!vtu && !vtk && !msh && ending != ".mesh") {
    const bool surface = is_surface_file(path);
    throw InvalidMesh(fmt::format("files that end in '{}' are not supported; supported are {}{}", ending, supported,
                                  surface ? "; a surface in space is read by read_surface()" : ""));
  }
  if (!vtu && !vtk && !options.patch_array.empty())
    throw InvalidMesh(
        fmt::format("patches from the cell array '{}': arrays are in .vtu and .vtk files; in this one groups of faces "
                    "are the patches",
                    options.patch_array));
  check_memory(vtu ? memory_of_vtk({.file = 2 * file_bytes(path)}) : memory_of_text(file_bytes(path)),
               options.max_memory);
  const std::string content = read_bytes(path);
  if (content.empty()) throw InvalidMesh("the file is empty");
  if (vtu) return parse_vtu(path, content, options);
  if (vtk && starts(body(content), "<")) throw InvalidMesh("this .vtk is one of VTK's XML files; rename it to .vtu");
  if (vtk) return parse_legacy_vtk(path, content, options);
  return msh ? parse_msh(content) : parse_mesh(content);
}

}  // namespace

MeshFile read_mesh(const std::filesystem::path& path, const ReadOptions& options) {
  return checked_file(path, "mesh", [&](MeshFile& out) {
    ParsedMesh parsed = parse(path, options);
    check_memory(memory_of_mesh(parsed.mesh), options.max_memory);
    out.mesh = std::move(parsed.mesh);
    if (!out.mesh.types.empty()) out.report = check_and_repair(out.mesh);
    out.report.format = parsed.format;
    add_finding(out.report.defects, parsed.second_order);
    add_finding(out.report.defects, parsed.unsupported);
  });
}

MeshFile read_valid_mesh(const std::filesystem::path& path, const ReadOptions& options) {
  return valid_file(read_mesh(path, options));
}

}  // namespace dartcast
