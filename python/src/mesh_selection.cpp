// Binds dartcast/mesh_selection.hpp, but for what tools/make_bindings.py writes.
#include "dartcast/mesh_selection.hpp"

#include "bind.hpp"
#include "support/members.hpp"

namespace dartcast::python::mesh_selection {

void bind(pybind11::module_& m) {
  function(
      m, "divide_walls",
      +[](MeshData& mesh, double degrees) {
        require_checked(mesh);
        divide_walls(mesh, degrees);
      },
      "Raises InvalidMesh where check_and_repair() would refuse the mesh, and InvalidArgument where it would change "
      "it.");
}

}  // namespace dartcast::python::mesh_selection
