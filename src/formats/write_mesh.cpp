#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <string>
#include <system_error>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "formats/gmsh.hpp"
#include "formats/medit.hpp"
#include "formats/vtk_mesh.hpp"

namespace dartcast {

void write_bytes(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out)
    throw Error(fmt::format("{}: the file cannot be written; check the folder, its permissions and the disk's space",
                            path.string()));
}

namespace {

namespace fs = std::filesystem;

/// Where the bytes of a file go in the end: behind links.
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

/// Calls write(file) for a new file beside the target, and puts that in the target's place when it is whole.
template <class Write>
void write_beside(const fs::path& path, Write&& write) {
  const fs::path target = target_of(path);
  std::error_code error;
  if (fs::exists(target, error) && !fs::is_regular_file(target, error)) return write(path);  // a device has no beside
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

}  // namespace

void write_mesh(const MeshData& mesh, const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto write = [&](const std::string& bytes) {
    write_beside(path, [&](const fs::path& file) { write_bytes(file, bytes); });
  };
  if (ending == ".vtu") return write_beside(path, [&](const fs::path& file) { write_vtu(mesh, file); });
  if (ending == ".vtk") return write_beside(path, [&](const fs::path& file) { write_legacy_vtk(mesh, file); });
  if (ending == ".msh" || ending == ".msh2") return write(format_gmsh_2(mesh));
  if (ending == ".msh4") return write(format_gmsh_4(mesh));
  if (ending == ".mesh") return write(format_medit(mesh));
  throw InvalidArgument(fmt::format(
      "{}: cannot write files that end in '{}'; use .vtu, .vtk, .msh, .msh2, .msh4 or .mesh", path.string(), ending));
}

}  // namespace dartcast
