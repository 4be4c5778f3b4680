// Whether this build has VTK, and the words where it has not.
#include <fmt/format.h>

#include "dartcast/mesh_files.hpp"
#include "formats/vtk_functions.hpp"

namespace dartcast {

bool has_vtk() { return vtk_functions.read_vtu != nullptr; }

std::string needs_vtk(std::string_view task, std::string_view remedy) {
  return fmt::format("this build of dartcast has no VTK, which it needs to {}: build with -DDARTCAST_VTK=ON, or {}",
                     task, remedy);
}

}  // namespace dartcast
