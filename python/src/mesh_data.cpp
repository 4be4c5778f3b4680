// Binds dartcast/mesh_data.hpp, but for the constructor and `cells`, which are in Python. Each array of a mesh is an attribute: read, it is a read-only copy; set, it is copied.
#include "dartcast/mesh_data.hpp"

#include "bind.hpp"
#include "support/integers.hpp"
#include "support/map_checks.hpp"
#include "support/meshes.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::mesh_data {
namespace {

// {name: values}: (n,) for one component, else (n, components). Where two arrays have one name the first is taken.
py::dict arrays_by_name(const std::vector<DataArray>& arrays) {
  py::dict named;
  for (const DataArray& a : arrays) {
    if (named.contains(a.name.c_str())) continue;
    named[a.name.c_str()] =
        a.components == 1 ? array_of(std::span<const double>(a.values)) : rows_of(a.values, a.components);
  }
  return named;
}

DataArray data_array(const std::string& name, const py::object& values, std::size_t count, const std::string& of) {
  const std::string text = of + "_data['" + name + "']";
  const auto a = py::array::ensure(values);
  const bool right =
      a && std::string("fiub").find(a.dtype().kind()) != std::string::npos && (a.ndim() == 1 || a.ndim() == 2);
  if (!right) {
    PyErr_Clear();
    refuse_array(values, text.c_str(), "numbers (n,) or (n, components)", "numpy.asarray(x, dtype=float)");
  }
  const auto doubles = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(a);
  if (doubles.shape(0) != static_cast<py::ssize_t>(count)) {
    throw InvalidArgument(text + ": expected " + std::to_string(count) + " values, one for each " + of + "; got " +
                          std::to_string(doubles.shape(0)));
  }
  const std::size_t components = doubles.ndim() == 1 ? 1 : static_cast<std::size_t>(doubles.shape(1));
  if (components == 0) throw InvalidArgument(text + ": it has no components");
  return {name, components, {doubles.data(), doubles.data() + doubles.size()}};
}

std::vector<DataArray> arrays_from(const py::dict& named, std::size_t count, const std::string& of) {
  std::vector<DataArray> arrays;
  for (const auto& [name, values] : named)
    arrays.push_back(
        data_array(py::str(name).cast<std::string>(), py::reinterpret_borrow<py::object>(values), count, of));
  return arrays;
}

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
  const auto add_copied = [&c]<class T>(const char* name, T MeshData::*member, const char* text) {
    c.def_property(
        name, [member](const MeshData& m) { return m.*member; },
        [member](MeshData& m, T value) {
          const MeshUse use(m, true);
          m.*member = std::move(value);
        },
        text);
  };
  add_copied("periodic", &MeshData::periodic, "Pairs of patches, as a list of PeriodicPair. Reading gives a copy.");
  add_copied("region_names", &MeshData::region_names, "{tag: name}. Reading gives a copy.");
  add_copied("patch_names", &MeshData::patch_names, "{tag: name}. Reading gives a copy.");
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

}  // namespace

void bind(py::module_& m) {
  py::tuple names(cell_type_names.size());
  for (std::size_t i = 0; i < cell_type_names.size(); ++i) names[i] = std::string(cell_type_names[i]);
  m.attr("CELL_TYPE_NAMES") = names;
  m.def(
      "dimension", [](CellType type) { return dimension(type); }, about("dimension"));

  py::class_<MeshData, std::shared_ptr<MeshData>> c(m, "MeshData", doc("MeshData"));
  c.def(py::init<>());
  add_arrays(c);
  add_names_and_data(c);
  add_methods(c);
  // For the constructor, which is in Python (python/dartcast/_mesh.py).
  m.def("_check_arrays", &check_arrays);
  m.def("_corners", [](const py::object& x, const std::string& name, std::size_t columns, std::size_t points) {
    std::vector<std::uint32_t> corners;
    append_integers(x, name, columns, corners, static_cast<std::int64_t>(points));
    return array_of(std::move(corners));
  });
}

}  // namespace dartcast::python::mesh_data
