// Binds dartcast/mesh_data.hpp. Each array of a mesh is an attribute: read, it is a read-only copy; set, it is copied.
#include "dartcast/mesh_data.hpp"

#include "bind.hpp"
#include "support/integers.hpp"
#include "support/map_checks.hpp"
#include "support/mesh_arrays.hpp"
#include "support/meshes.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::mesh_data {
namespace {

constexpr const char* constructor_doc = R"(A mesh from arrays.

points: float64 (n, 3). cells: by the names of meshio's types, as a dict or a list of pairs: "tetra", "hexahedron",
"wedge", "pyramid", "triangle" and "quad" are arrays (n, corners) of any integer dtype; "polyhedron" is a list of cells,
each a list of faces; "polygon" is a list of cells, each a list of corners. A wedge may have the order of Gmsh or that
of VTK: the one with a positive volume is taken.

regions, free, and each array of cell_data: one value per cell, in the order of the cells, or a dict by type.
region_names, patch_names: {tag: name}. patches: {name or tag: faces}, where faces are an array (n, corners), a dict of
these by type, or a list of faces. A patch that is given by a name gets the next tag. point_data: {name: (n,) or
(n, components)}.

Raises TypeError for another dtype or shape, and InvalidArgument where a size does not match or a number is no point.
check_and_repair() checks the rest.)";

// An attribute that holds one array of numbers.
template <class T>
void add_array(py::class_<MeshData, std::shared_ptr<MeshData>>& c, const char* name, std::vector<T> MeshData::*member) {
  const std::string full = std::string("MeshData.") + name;
  c.def_property(
      name, [member](const MeshData& m) { return read_only(array_of(std::span<const T>(m.*member))); },
      [member, full](MeshData& m, const Typed<"Integers">& x) {
        std::vector<T> values = integers<T>(x, full);
        const MeshUse use(m, true);
        m.*member = std::move(values);
      },
      doc(std::string("MeshData::") + name));
}

void add_arrays(py::class_<MeshData, std::shared_ptr<MeshData>>& c) {
  c.def_property(
      "points", [](const MeshData& m) { return read_only(array_of(std::span<const Vec3>(m.points))); },
      [](MeshData& m, const Typed<"Points">& x) {
        const auto points = vectors(x, "MeshData.points");
        const MeshUse use(m, true);
        m.points.assign(points.begin(), points.end());
      },
      "float64 (n, 3).");
  c.def_property(
      "types",
      [](const MeshData& m) {
        std::vector<std::uint8_t> types(m.types.size());
        for (std::size_t i = 0; i < types.size(); ++i) types[i] = static_cast<std::uint8_t>(m.types[i]);
        return read_only(array_of(std::move(types)));
      },
      [](MeshData& m, const Typed<"Integers">& x) {
        std::vector<std::uint8_t> numbers;
        append_integers(x, "MeshData.types", 0, numbers, cell_type_names.size());
        const MeshUse use(m, true);
        m.types.clear();
        for (const std::uint8_t t : numbers) m.types.push_back(static_cast<CellType>(t));
      },
      doc("MeshData::types"));
  add_array(c, "offsets", &MeshData::offsets);
  add_array(c, "connectivity", &MeshData::connectivity);
  add_array(c, "source", &MeshData::source);
  add_array(c, "regions", &MeshData::regions);
  add_array(c, "patch_faces", &MeshData::patch_faces);
  add_array(c, "patch_offsets", &MeshData::patch_offsets);
  add_array(c, "patch_tags", &MeshData::patch_tags);
  add_array(c, "patch_source", &MeshData::patch_source);
  add_array(c, "patch_order", &MeshData::patch_order);
  add_array(c, "baffle_tags", &MeshData::baffle_tags);
  c.def_property(
      "free", [](const MeshData& m) { return read_only(array_of(std::span<const std::uint8_t>(m.free))); },
      [](MeshData& m, const Typed<"Marks">& x) {
        std::vector<std::uint8_t> free;
        for (const std::uint8_t mark : marks(x, "MeshData.free")) free.push_back(mark != 0 ? 1 : 0);
        const MeshUse use(m, true);
        m.free = std::move(free);
      },
      doc("MeshData::free"));
}

void add_names_and_data(py::class_<MeshData, std::shared_ptr<MeshData>>& c) {
  using Names = std::map<std::int32_t, std::string>;
  const auto add_names = [&c](const char* name, Names MeshData::*member, const char* text) {
    c.def_property(
        name, [member](const MeshData& m) { return m.*member; },
        [member](MeshData& m, Names names) {
          const MeshUse use(m, true);
          m.*member = std::move(names);
        },
        text);
  };
  add_names("region_names", &MeshData::region_names, "{tag: name}. Reading gives a copy.");
  add_names("patch_names", &MeshData::patch_names, "{tag: name}. Reading gives a copy.");
  c.def_property(
      "point_data", [](const MeshData& m) -> Typed<"dict[str, Floats]"> { return arrays_by_name(m.point_data); },
      [](MeshData& m, const py::dict& named) {
        auto arrays = arrays_from(named, m.points.size(), "point");
        const MeshUse use(m, true);
        m.point_data = std::move(arrays);
      },
      "Values at the points: {name: (n,) or (n, components)}. Reading gives a copy.");
  c.def_property(
      "cell_data", [](const MeshData& m) -> Typed<"dict[str, Floats]"> { return arrays_by_name(m.cell_data); },
      [](MeshData& m, const py::dict& named) {
        auto arrays = arrays_from(named, m.cell_count(), "cell");
        const MeshUse use(m, true);
        m.cell_data = std::move(arrays);
      },
      "Values of the cells: {name: (n,) or (n, components)}. Reading gives a copy.");
}

void add_methods(py::class_<MeshData, std::shared_ptr<MeshData>>& c) {
  c.def_property_readonly("cell_count", &MeshData::cell_count, "The number of cells.");
  c.def_property_readonly("dimension", &MeshData::dimension, doc("MeshData::dimension"));
  c.def_property_readonly(
      "cells",
      [](const MeshData& m) {
        check_arrays(m);
        return cells_by_type(m);
      },
      "The cells by type, as the constructor takes them. Raises InvalidArgument where the mesh's arrays contradict "
      "each other.");
  c.def(
      "cell",
      [](const MeshData& m, std::size_t i) {
        check_arrays(m);
        expect_number(i, m.cell_count(), "cell");
        return array_of(m.cell(i));
      },
      py::arg("c"),
      "The connectivity of one cell: uint32 (n,). Raises IndexError where there is no such cell. Cost: a check of the "
      "whole mesh; for many cells use connectivity and offsets.");
  c.def(
      "patch_face",
      [](const MeshData& m, std::size_t i) {
        check_arrays(m);
        expect_number(i, m.patch_tags.size(), "patch face");
        return array_of(m.patch_face(i));
      },
      py::arg("f"), "The corners of one face of a patch: uint32 (n,). Raises IndexError where there is no such face.");
  c.def(
      "add_cell",
      [](MeshData& m, CellType type, const Typed<"Integers">& corners) {
        const auto numbers = indices(corners, "corners");
        const MeshUse use(m, true);
        m.add_cell(type, numbers);
      },
      py::arg("type"), py::arg("corners"), "Adds a cell. For many cells use the constructor.");
  c.def(
      "add_patch_face",
      [](MeshData& m, const Typed<"Integers">& corners, std::int32_t tag) {
        const auto numbers = indices(corners, "corners");
        const MeshUse use(m, true);
        m.add_patch_face(numbers, tag);
      },
      py::arg("corners"), py::arg("tag"), "Adds a face to a patch. For many faces use the constructor.");
  c.def("__repr__", [](const MeshData& m) {
    return "<dartcast.MeshData: " + std::to_string(m.points.size()) + " points, " + std::to_string(m.cell_count()) +
           " cells, " + std::to_string(m.patch_tags.size()) + " patch faces>";
  });
  const auto copy = [](const MeshData& m) { return m; };
  c.def("__copy__", copy);
  c.def("__deepcopy__", [copy](const MeshData& m, const py::dict& /*memo*/) { return copy(m); });
}

// Attributes in the order of a pickle.
constexpr std::array<const char*, 17> pickled = {
    "points",       "types",       "offsets",       "connectivity", "source",       "regions",
    "region_names", "patch_faces", "patch_offsets", "patch_tags",   "patch_source", "patch_names",
    "patch_order",  "baffle_tags", "free",          "point_data",   "cell_data"};

py::tuple state_of(const py::object& mesh) {
  py::tuple state(pickled.size());
  for (std::size_t i = 0; i < pickled.size(); ++i) state[i] = mesh.attr(pickled[i]);
  return state;
}

MeshData from_state(const py::tuple& state) {
  if (state.size() != pickled.size()) throw InvalidArgument("this is no pickle of a MeshData of this version");
  const py::object mesh = py::cast(MeshData{});
  for (std::size_t i = 0; i < pickled.size(); ++i) mesh.attr(pickled[i]) = state[i];
  return mesh.cast<MeshData>();
}

}  // namespace

void bind(py::module_& m) {
  py::tuple names(cell_type_names.size());
  for (std::size_t i = 0; i < cell_type_names.size(); ++i) names[i] = std::string(cell_type_names[i]);
  m.attr("CELL_TYPE_NAMES") = names;
  m.def(
      "dimension", [](CellType type) { return dimension(type); }, about("dimension"));

  py::class_<MeshData, std::shared_ptr<MeshData>> c(m, "MeshData", doc("MeshData"));
  c.def(
      py::init(
          [](const Typed<"Points | None">& points,
             const Typed<"Mapping[str, Any] | Sequence[tuple[str, Any]] | None">& cells, const Typed<"Any">& regions,
             const Typed<"Mapping[Any, Any] | Sequence[tuple[Any, Any]] | None">& patches,
             const Typed<"Mapping[int, str] | None">& region_names,
             const Typed<"Mapping[int, str] | None">& patch_names, const Typed<"Any">& free,
             const Typed<"Mapping[str, Any] | None">& point_data, const Typed<"Mapping[str, Any] | None">& cell_data) {
            return mesh_from_arrays(
                {points, cells, regions, region_names, patches, patch_names, free, point_data, cell_data});
          }),
      py::arg("points") = py::none(), py::arg("cells") = py::none(), py::kw_only(), py::arg("regions") = py::none(),
      py::arg("patches") = py::none(), py::arg("region_names") = py::none(), py::arg("patch_names") = py::none(),
      py::arg("free") = py::none(), py::arg("point_data") = py::none(), py::arg("cell_data") = py::none(),
      constructor_doc);
  add_arrays(c);
  add_names_and_data(c);
  add_methods(c);
  c.def(py::pickle(&state_of, &from_state));
  c.def("__reduce__", [](const py::object& mesh) {  // without it, protocols 0 and 1 would ask for a base class's state
    return py::make_tuple(py::module_::import("copyreg").attr("__newobj__"), py::make_tuple(py::type::of(mesh)),
                          state_of(mesh));
  });
}

}  // namespace dartcast::python::mesh_data
