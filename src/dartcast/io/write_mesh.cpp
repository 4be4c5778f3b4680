#include "dartcast/io/write_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <string>

#include "dartcast/base/error.hpp"
#include "dartcast/io/gmsh.hpp"
#include "dartcast/io/medit.hpp"
#include "dartcast/io/vtk_mesh.hpp"

namespace dartcast {

void write_bytes(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out)
    throw Error(fmt::format("{}: the file cannot be written; check the folder, its permissions and the disk's space",
                            path.string()));
}

void write_mesh(const MeshData& mesh, const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".vtu") return write_vtu(mesh, path);
  if (ending == ".vtk") return write_legacy_vtk(mesh, path);
  if (ending == ".msh" || ending == ".msh2") return write_bytes(path, format_gmsh_2(mesh));
  if (ending == ".msh4") return write_bytes(path, format_gmsh_4(mesh));
  if (ending == ".mesh") return write_bytes(path, format_medit(mesh));
  throw InvalidArgument(fmt::format(
      "{}: cannot write files that end in '{}'; use .vtu, .vtk, .msh, .msh2, .msh4 or .mesh", path.string(), ending));
}

}  // namespace dartcast
