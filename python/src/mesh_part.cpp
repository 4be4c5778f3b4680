// Binds dartcast/mesh_part.hpp. Arrays of a part are read-only copies.
#include "dartcast/mesh_part.hpp"

#include "bind.hpp"
#include "dartcast/mesh_files.hpp"
#include "support/integers.hpp"
#include "support/mesh_arrays.hpp"
#include "support/meshes.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::mesh_part {
namespace {

namespace fs = std::filesystem;
using Class = py::class_<MeshPart, std::shared_ptr<MeshPart>>;

void bind_part(py::module_& m) {
  Class c(m, "MeshPart", doc("MeshPart"));
  const auto numbers = [&](const char* name, std::vector<std::uint32_t> MeshPart::*member) {
    c.def_property_readonly(
        name, [member](const MeshPart& p) { return read_only(array_of(std::span<const std::uint32_t>(p.*member))); },
        doc(std::string("MeshPart::") + name));
  };
  c.def_property_readonly(
       "mesh", [](const MeshPart& p) { return std::make_shared<MeshData>(p.mesh); }, "The part's mesh: a copy.")
      .def_property_readonly(
          "part", [](const MeshPart& p) { return p.part; }, doc("MeshPart::part"))
      .def_property_readonly(
          "parts", [](const MeshPart& p) { return p.parts; }, doc("MeshPart::parts"));
  numbers("points", &MeshPart::points);
  numbers("cells", &MeshPart::cells);
  numbers("owners", &MeshPart::owners);
  c.def_property_readonly(
       "handles",
       [](const MeshPart& p) {
         std::vector<std::uint32_t> values;
         for (const Cell h : p.handles) values.push_back(h.value);
         return read_only(array_of(std::move(values)));
       },
       doc("MeshPart::handles"))
      .def("__repr__", [](const MeshPart& p) {
        return "<dartcast.MeshPart: part " + std::to_string(p.part) + " of " + std::to_string(p.parts) + ", " +
               std::to_string(p.cells.size()) + " cells>";
      });
}

}  // namespace

void bind(py::module_& m) {
  bind_part(m);
  m.attr("UNKNOWN_PATCH") = unknown_patch;
  m.def(
      "partition",
      [](const MeshData& mesh, std::uint32_t parts) {
        check_arrays(mesh);
        const MeshUse use(mesh);
        std::vector<std::uint32_t> owners;
        {
          const py::gil_scoped_release release;
          owners = partition(mesh, parts);
        }
        return array_of(std::move(owners));
      },
      py::arg("mesh"), py::arg("parts"), doc("partition"));
  m.def(
      "mesh_part",
      [](const MeshData& whole, const py::object& owners, std::uint32_t parts, std::uint32_t part) {
        const auto values = integers<std::uint32_t>(owners, "mesh_part: owners");
        check_arrays(whole);
        const MeshUse use(whole);
        const py::gil_scoped_release release;
        return dartcast::mesh_part(whole, values, parts, part);
      },
      py::arg("whole"), py::arg("owners"), py::arg("parts"), py::arg("part"), doc("mesh_part"));
  m.def("has_parts", &has_parts, py::arg("options"), doc("has_parts"));
  m.def(
      "box_part",
      [](const BoxOptions& options, std::uint32_t parts, std::uint32_t part) {
        const BoxOptions own = options;
        const py::gil_scoped_release release;
        return box_part(own, parts, part);
      },
      py::arg("options"), py::arg("parts"), py::arg("part"), doc("box_part"));
  m.def(
      "write_mesh_parts",
      [](const MeshData& mesh, std::uint32_t parts, const fs::path& path) {
        check_arrays(mesh);
        const MeshUse use(mesh);
        const py::gil_scoped_release release;
        write_mesh_parts(mesh, parts, path);
      },
      py::arg("mesh"), py::arg("parts"), py::arg("path"), doc("write_mesh_parts"));
  m.def(
      "read_mesh_part",
      [](const fs::path& path, std::uint32_t parts, std::uint32_t part, const ReadOptions& options) {
        const ReadOptions own = options;
        const py::gil_scoped_release release;
        return read_mesh_part(path, parts, part, own);
      },
      py::arg("path"), py::arg("parts"), py::arg("part"), py::arg("options") = ReadOptions{}, doc("read_mesh_part"));
}

}  // namespace dartcast::python::mesh_part
