// Binds dartcast/mesh_selection.hpp.
#include "dartcast/mesh_selection.hpp"

#include "bind.hpp"
#include "support/meshes.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::mesh_selection {
namespace {

// Calls a function that changes the mesh.
template <class Function>
void change(MeshData& mesh, const Function& function) {
  check_arrays(mesh);
  const MeshUse use(mesh, true);
  const py::gil_scoped_release release;
  function();
}

}  // namespace

void bind(py::module_& m) {
  using Texts = std::vector<std::string>;
  m.def(
      "select_free_regions",
      [](MeshData& mesh, const Texts& regions) { change(mesh, [&] { select_free_regions(mesh, regions); }); },
      about("select_free_regions"));
  m.def(
      "cells_of_region",
      [](const MeshData& mesh, const std::string& region) {
        check_arrays(mesh);
        std::vector<std::uint32_t> cells;
        {
          const MeshUse use(mesh, false);
          const py::gil_scoped_release release;
          cells = cells_of_region(mesh, region);
        }
        return py::array_t<std::uint32_t>(static_cast<py::ssize_t>(cells.size()), cells.data());
      },
      about("cells_of_region"));
  m.def(
      "select_free_values",
      [](MeshData& mesh, const std::string& array, const std::vector<double>& values) {
        change(mesh, [&] { select_free_values(mesh, array, values); });
      },
      about("select_free_values"));
  m.def(
      "select_patches", [](MeshData& mesh, const Texts& names) { change(mesh, [&] { select_patches(mesh, names); }); },
      about("select_patches"));
  m.def(
      "select_walls", [](MeshData& mesh, const Texts& names) { change(mesh, [&] { select_walls(mesh, names); }); },
      about("select_walls"));
  m.def(
      "divide_walls",
      [](MeshData& mesh, double degrees) {
        change(mesh, [&] {
          require_checked(mesh);
          divide_walls(mesh, degrees);
        });
      },
      about("divide_walls",
            "Raises InvalidMesh where check_and_repair() would refuse the mesh, and InvalidArgument where it would "
            "change it."));
}

}  // namespace dartcast::python::mesh_selection
