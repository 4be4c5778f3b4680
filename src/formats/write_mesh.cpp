// Writes a mesh in the format of the path's ending: to a file beside it, which then takes its place.
#include <fmt/format.h>
#include <unistd.h>

#include <string>
#include <system_error>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "formats/format_table.hpp"

namespace dartcast {

namespace {

namespace fs = std::filesystem;

/// The file that a path names, after all links.
fs::path target_of(const fs::path& path) {
  std::error_code error;
  const fs::path target = fs::is_symlink(path, error) ? fs::weakly_canonical(path, error) : path;
  return error ? path : target;
}

void move_over(const fs::path& part, const fs::path& target) {
  std::error_code error;
  const fs::file_status before = fs::status(target, error);
  if (fs::exists(before)) fs::permissions(part, before.permissions(), error);
  fs::rename(part, target, error);
  if (error) throw Error(fmt::format("{}: the file cannot be replaced: {}", target.string(), error.message()));
}

/// Calls write(file) for a new file beside the target, which takes the target's place when it is whole.
template <class Write>
void write_beside(const fs::path& path, Write&& write) {
  const fs::path target = target_of(path);
  std::error_code error;
  if (fs::exists(target, error) && !fs::is_regular_file(target, error))
    return write(path);  // a device has no folder to write in
  const fs::path part = target.string() + fmt::format(".{}.part", ::getpid());
  try {
    write(part);
    move_over(part, target);
  } catch (const Error& e) {
    fs::remove(part, error);
    std::string text = e.what();
    if (const std::size_t at = text.find(part.string()); at != std::string::npos)
      text.replace(at, part.string().size(), path.string());
    throw Error(text);
  } catch (...) {
    fs::remove(part, error);
    throw;
  }
}

/// Throws InvalidArgument if the format has no place for a cell, a face or a baffle.
void check_cells(const MeshData& mesh, const MeshFormat& format) {
  if (format.polyhedra) return;
  if (!mesh.baffle_tags.empty())
    throw InvalidArgument(
        fmt::format("{}'s format cannot hold baffles, walls between two cells; write .vtu", format.name));
  const auto check_face = [&](std::size_t corners) {
    if (corners > 4)
      throw InvalidArgument(
          fmt::format("{}'s format cannot hold polygons or faces of more than four corners; write .vtu", format.name));
  };
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f)
    check_face(mesh.patch_offsets[f + 1] - mesh.patch_offsets[f]);
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    if (mesh.types[c] == CellType::polyhedron)
      throw InvalidArgument(fmt::format("{}'s format cannot hold polyhedra; write .vtu", format.name));
    if (dimension(mesh.types[c]) == 2) check_face(mesh.cell(c).size());
  }
}

}  // namespace

void write_mesh(const MeshData& mesh, const std::filesystem::path& path) {
  if (const SurfaceFormat* surface = surface_format_of(path); surface != nullptr) {
    if (mesh.dimension() != 2)
      throw InvalidArgument(fmt::format("{}: this is a format of surfaces, and the mesh has cells of space; use {}",
                                        path.string(), in_words(writable_mesh_endings(), "or")));
    return write_beside(path, [&](const fs::path& file) { surface->write(mesh, file); });
  }
  const FormatEnding* ending = mesh_ending_of(path);
  if (ending == nullptr || ending->write == nullptr) {
    throw InvalidArgument(fmt::format("{}: cannot write files that end in '{}'; use {}", path.string(), ending_of(path),
                                      in_words(writable_mesh_endings(), "or")));
  }
  check_cells(mesh, *mesh_format_of(path));
  write_beside(path, [&](const fs::path& file) { ending->write(mesh, file); });
}

}  // namespace dartcast
