// Meshes from arrays with the names and shapes of meshio, and back. Phases of mesh_from_arrays(): points, blocks of
// cells, values of cells (flat, or by block), patches.
#include "support/mesh_arrays.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "support/integers.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

struct Named {
  const char* name;
  CellType type;
  std::size_t corners;  // 0: any number
};
constexpr std::array<Named, 8> blocks = {{{"tetra", CellType::tetrahedron, 4},
                                          {"hexahedron", CellType::hexahedron, 8},
                                          {"wedge", CellType::prism, 6},
                                          {"pyramid", CellType::pyramid, 5},
                                          {"polyhedron", CellType::polyhedron, 0},
                                          {"triangle", CellType::triangle, 3},
                                          {"quad", CellType::quadrilateral, 4},
                                          {"polygon", CellType::polygon, 0}}};

// The type of a block. meshio adds the number of points to the names of polyhedra and polygons: "polyhedron10".
const Named& block_of(const std::string& name) {
  const std::string plain = name.substr(0, name.find_last_not_of("0123456789") + 1);
  for (const Named& b : blocks) {
    if (name == b.name || name == cell_type_names[static_cast<std::size_t>(b.type)]) return b;
    if (b.corners == 0 && plain == b.name) return b;
  }
  std::string known;
  for (const Named& b : blocks) known += std::string(known.empty() ? "" : ", ") + b.name;
  throw InvalidArgument("cells: '" + name + "' is no type of cells here: the types are " + known);
}

using Items = std::vector<std::pair<py::object, py::object>>;

// The pairs of a dict, or of a list of pairs, as meshio has them.
Items items_of(const py::object& x, const char* name) {
  Items items;
  const py::object pairs = py::isinstance<py::dict>(x) ? x.attr("items")() : x;
  if (py::isinstance<py::array>(x) || py::isinstance<py::str>(x) || !py::isinstance<py::iterable>(pairs)) {
    throw py::type_error(std::string(name) + ": expected a dict by name, or a list of pairs (name, values); got a " +
                         py::type::of(x).attr("__name__").cast<std::string>());
  }
  for (const py::handle item : pairs) {
    if (!py::isinstance<py::sequence>(item) || py::len(item) != 2) {
      throw py::type_error(std::string(name) + ": expected pairs (name, values); got " +
                           py::repr(item).cast<std::string>());
    }
    const auto pair = py::reinterpret_borrow<py::sequence>(item);
    items.emplace_back(py::object(pair[0]), py::object(pair[1]));
  }
  return items;
}

// The cells of a mesh by blocks.
struct Block {
  std::string name;
  std::size_t count = 0;
};

void add_polyhedron(MeshData& mesh, py::handle faces, const std::string& name) {
  std::vector<std::uint32_t> words = {static_cast<std::uint32_t>(py::len(faces))};
  for (const py::handle face : faces) {
    const std::size_t at = words.size();
    words.push_back(0);
    append_integers(py::reinterpret_borrow<py::object>(face), name, 0, words,
                    static_cast<std::int64_t>(mesh.points.size()));
    words[at] = static_cast<std::uint32_t>(words.size() - at - 1);
  }
  mesh.add_cell(CellType::polyhedron, words);
}

// meshio passes wedges on as files have them: most as in Gmsh, those of VTK as the mirror image. The volume decides.
void turn_wedges(MeshData& mesh, std::size_t first) {
  for (std::size_t at = first; at + 6 <= mesh.connectivity.size(); at += 6) {
    std::uint32_t* v = mesh.connectivity.data() + at;
    const auto& p = mesh.points;
    if (orient3d(p[v[0]], p[v[1]], p[v[2]], p[v[3]]) != Sign::negative) continue;
    std::swap(v[1], v[2]);
    std::swap(v[4], v[5]);
  }
}

std::size_t add_block(MeshData& mesh, const std::string& name, const py::object& cells) {
  const Named& block = block_of(name);
  const std::string text = "cells['" + name + "']";
  const auto points = static_cast<std::int64_t>(mesh.points.size());
  const std::size_t before = mesh.cell_count();
  if (block.corners > 0) {
    const std::size_t first = mesh.connectivity.size();
    append_integers(cells, text, block.corners, mesh.connectivity, points);
    if (block.type == CellType::prism) turn_wedges(mesh, first);
    const std::size_t count = (mesh.connectivity.size() - first) / block.corners;
    mesh.types.insert(mesh.types.end(), count, block.type);
    for (std::size_t c = 1; c <= count; ++c) mesh.offsets.push_back(first + c * block.corners);
    return count;
  }
  if (!py::isinstance<py::iterable>(cells)) throw py::type_error(text + ": expected a list of cells");
  for (const py::handle cell : cells) {
    if (block.type == CellType::polygon) {
      std::vector<std::uint32_t> corners;
      append_integers(py::reinterpret_borrow<py::object>(cell), text, 0, corners, points);
      mesh.add_cell(CellType::polygon, corners);
    } else {
      if (!py::isinstance<py::sequence>(cell)) throw py::type_error(text + ": expected a list of faces for each cell");
      add_polyhedron(mesh, cell, text);
    }
  }
  return mesh.cell_count() - before;
}

// Values of cells as one array: a flat one as it is, one by block in the order of the blocks.
py::object joined(const py::object& x, const std::vector<Block>& cells, const std::string& name) {
  if (!py::isinstance<py::dict>(x)) return x;
  const auto by_block = py::reinterpret_borrow<py::dict>(x);
  py::list parts;
  for (const Block& b : cells) {
    if (!by_block.contains(b.name.c_str()))
      throw InvalidArgument(name + ": there are no values for the cells '" + b.name + "'");
    const py::object part = by_block[b.name.c_str()];
    if (py::len(part) != b.count) {
      throw InvalidArgument(name + "['" + b.name + "']: expected " + std::to_string(b.count) +
                            " values, one for each cell; got " + std::to_string(py::len(part)));
    }
    parts.append(part);
  }
  if (by_block.size() != cells.size()) throw InvalidArgument(name + ": it names cells that the mesh has not");
  if (cells.empty()) return py::list();
  return py::module_::import("numpy").attr("concatenate")(parts);
}

void expect_count(std::size_t size, std::size_t count, const std::string& name, const char* of) {
  if (size == count) return;
  throw InvalidArgument(name + ": expected " + std::to_string(count) + " values, one for each " + of + "; got " +
                        std::to_string(size));
}

// Faces of a patch: one array (n, corners), or blocks, or a list of faces.
void add_faces(MeshData& mesh, const py::object& faces, std::int32_t tag, const std::string& name) {
  const auto points = static_cast<std::int64_t>(mesh.points.size());
  const auto add_rows = [&](const py::object& rows, std::size_t corners) {
    const std::size_t first = mesh.patch_faces.size();
    append_integers(rows, name, corners, mesh.patch_faces, points);
    const std::size_t count = (mesh.patch_faces.size() - first) / corners;
    for (std::size_t f = 1; f <= count; ++f) mesh.patch_offsets.push_back(first + f * corners);
    mesh.patch_tags.insert(mesh.patch_tags.end(), count, tag);
  };
  if (is_array(faces, 2)) {
    return add_rows(
        faces, std::max<std::size_t>(1, static_cast<std::size_t>(py::reinterpret_borrow<py::array>(faces).shape(1))));
  }
  if (py::isinstance<py::dict>(faces)) {
    for (const auto& [type, block] : items_of(faces, name.c_str())) add_faces(mesh, block, tag, name);
    return;
  }
  if (!py::isinstance<py::sequence>(faces))
    throw py::type_error(name + ": expected faces as an array (n, corners), or as a list");
  for (const py::handle face : faces) {
    std::vector<std::uint32_t> corners;
    append_integers(py::reinterpret_borrow<py::object>(face), name, 0, corners, points);
    mesh.add_patch_face(corners, tag);
  }
}

// A patch is named by its tag, or by its name: then it has the tag of that name, or the next one.
std::int32_t tag_of(MeshData& mesh, const py::object& key, const Items& all) {
  if (!py::isinstance<py::str>(key)) {
    std::vector<std::int32_t> tag;
    py::list one;
    one.append(key);
    append_integers(one, "patches: a tag", 0, tag);
    return tag[0];
  }
  const auto name = key.cast<std::string>();
  for (const auto& [tag, known] : mesh.patch_names) {
    if (known == name) return tag;
  }
  std::int32_t tag = 1;
  const auto is_taken = [&](std::int32_t t) {
    return mesh.patch_names.contains(t) ||
           std::any_of(all.begin(), all.end(), [&](const auto& item) { return item.first.equal(py::int_(t)); });
  };
  while (is_taken(tag)) ++tag;
  mesh.patch_names[tag] = name;
  return tag;
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
  expect_count(static_cast<std::size_t>(doubles.shape(0)), count, text, of.c_str());
  const std::size_t components = doubles.ndim() == 1 ? 1 : static_cast<std::size_t>(doubles.shape(1));
  if (components == 0) throw InvalidArgument(text + ": it has no components");
  return {name, components, {doubles.data(), doubles.data() + doubles.size()}};
}

std::map<std::int32_t, std::string> names_from(const py::object& names) {
  return names.is_none() ? std::map<std::int32_t, std::string>{} : names.cast<std::map<std::int32_t, std::string>>();
}

void add_values(MeshData& mesh, const MeshArguments& given, const std::vector<Block>& cells) {
  mesh.region_names = names_from(given.region_names);
  if (!given.regions.is_none()) {
    mesh.regions = integers<std::int32_t>(joined(given.regions, cells, "regions"), "regions");
    expect_count(mesh.regions.size(), mesh.cell_count(), "regions", "cell");
  }
  if (!given.free.is_none()) {
    const py::object all = py::module_::import("numpy").attr("ascontiguousarray")(joined(given.free, cells, "free"));
    const auto free = marks(all, "free");
    for (const std::uint8_t f : free) mesh.free.push_back(f != 0 ? 1 : 0);
    expect_count(mesh.free.size(), mesh.cell_count(), "free", "cell");
  }
  if (!given.point_data.is_none())
    mesh.point_data = arrays_from(given.point_data.cast<py::dict>(), mesh.points.size(), "point");
  if (given.cell_data.is_none()) return;
  py::dict flat;
  for (const auto& [name, values] : given.cell_data.cast<py::dict>()) {
    const auto text = "cell_data['" + py::str(name).cast<std::string>() + "']";
    flat[name] = joined(py::reinterpret_borrow<py::object>(values), cells, text);
  }
  mesh.cell_data = arrays_from(flat, mesh.cell_count(), "cell");
}

}  // namespace

MeshData mesh_from_arrays(const MeshArguments& given) {
  MeshData mesh;
  if (!given.points.is_none()) {
    const py::object converted = converted_vectors(given.points);
    const auto points = vectors(converted, "points");
    mesh.points.assign(points.begin(), points.end());
  }
  std::vector<Block> cells;
  if (!given.cells.is_none()) {
    for (const auto& [name, block] : items_of(given.cells, "cells")) {
      if (!py::isinstance<py::str>(name)) throw py::type_error("cells: expected the name of a type, as \"tetra\"");
      const auto text = name.cast<std::string>();
      cells.push_back({text, add_block(mesh, text, block)});
    }
  }
  add_values(mesh, given, cells);
  mesh.patch_names = names_from(given.patch_names);
  if (given.patches.is_none()) return mesh;
  const Items patches = items_of(given.patches, "patches");
  for (const auto& [key, faces] : patches)
    add_faces(mesh, faces, tag_of(mesh, key, patches), "patches[" + py::repr(key).cast<std::string>() + "]");
  return mesh;
}

py::dict cells_by_type(const MeshData& mesh) {
  py::dict all;
  for (const Named& b : blocks) {
    std::vector<std::uint32_t> corners;
    py::list cells;
    for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
      if (mesh.types[c] != b.type) continue;
      const auto words = mesh.cell(c);
      if (b.corners > 0) {
        corners.insert(corners.end(), words.begin(), words.end());
      } else if (b.type == CellType::polygon) {
        cells.append(array_of(words));
      } else {
        py::list faces;
        for (std::size_t at = 1; at < words.size(); at += std::size_t{1} + words[at])
          faces.append(array_of(words.subspan(at + 1, words[at])));
        cells.append(faces);
      }
    }
    if (!corners.empty()) all[b.name] = rows_of(corners, b.corners);
    if (!cells.empty()) all[b.name] = cells;
  }
  return all;
}

py::dict arrays_by_name(const std::vector<DataArray>& arrays) {
  py::dict named;
  for (const DataArray& a : arrays) {
    if (named.contains(a.name.c_str())) continue;
    named[a.name.c_str()] =
        a.components == 1 ? array_of(std::span<const double>(a.values)) : rows_of(a.values, a.components);
  }
  return named;
}

std::vector<DataArray> arrays_from(const py::dict& named, std::size_t count, const std::string& of) {
  std::vector<DataArray> arrays;
  for (const auto& [name, values] : named)
    arrays.push_back(
        data_array(py::str(name).cast<std::string>(), py::reinterpret_borrow<py::object>(values), count, of));
  return arrays;
}

}  // namespace dartcast::python
