// Binds dartcast/mesh_part.hpp. Arrays of a part are read-only copies.
#include "dartcast/mesh_part.hpp"

#include "bind.hpp"
#include "dartcast/mesh_files.hpp"
#include "support/integers.hpp"
#include "support/members.hpp"
#include "support/mesh_arrays.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::mesh_part {
namespace {

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

void bind(py::module_& m) { bind_part(m); }

}  // namespace dartcast::python::mesh_part
