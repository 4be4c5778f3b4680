// Makes .vtu files: cells first, then patch faces as cells of their own.
#include "formats/vtu_write.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <numeric>
#include <set>
#include <string>

#include "formats/file_write.hpp"

namespace dartcast {

namespace {

using Mesh = std::shared_ptr<const MeshData>;

constexpr std::array<std::uint8_t, 8> cell_types = {10, 12, 13, 14, 42, 5, 9, 7};  // VTK's, by CellType
constexpr std::array<std::uint8_t, 5> face_types = {0, 0, 3, 5, 9};                // by the number of corners
constexpr std::uint8_t polygon = 7;

// Corners of cells and patch faces, one after the other, and where each ends.
struct VtuCells {
  std::vector<std::uint32_t> ids;
  std::vector<std::int64_t> ends;
  std::vector<std::int64_t> faces;      // of polyhedra
  std::vector<std::int64_t> face_ends;  // by cell; -1: no polyhedron

  void end_cell(bool polyhedron) {
    ends.push_back(static_cast<std::int64_t>(ids.size()));
    face_ends.push_back(polyhedron ? static_cast<std::int64_t>(faces.size()) : -1);
  }
};

// A polyhedron's points, each once, and its faces.
void add_polyhedron(std::span<const std::uint32_t> stream, VtuCells& to) {
  std::set<std::uint32_t> points;
  std::size_t at = 1;
  for (std::uint32_t f = 0; f < stream[0]; ++f) {
    points.insert(stream.begin() + static_cast<std::ptrdiff_t>(at) + 1,
                  stream.begin() + static_cast<std::ptrdiff_t>(at + stream[at]) + 1);
    at += stream[at] + 1;
  }
  to.ids.insert(to.ids.end(), points.begin(), points.end());
  to.faces.insert(to.faces.end(), stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(at));
}

VtuCells corners_of(const MeshData& mesh) {
  VtuCells to;
  to.ids.reserve(mesh.connectivity.size() + mesh.patch_faces.size());
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const auto corners = mesh.cell(c);
    const bool polyhedron = mesh.types[c] == CellType::polyhedron;
    if (polyhedron) {
      add_polyhedron(corners, to);
    } else {
      to.ids.insert(to.ids.end(), corners.begin(), corners.end());
    }
    if (mesh.types[c] == CellType::prism) {
      std::uint32_t* prism = &to.ids[to.ids.size() - 6];
      std::swap(prism[1], prism[2]);
      std::swap(prism[4], prism[5]);
    }
    to.end_cell(polyhedron);
  }
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const auto face = mesh.patch_face(f);
    to.ids.insert(to.ids.end(), face.begin(), face.end());
    to.end_cell(false);
  }
  return to;
}

std::vector<std::uint8_t> types_of(const MeshData& mesh) {
  std::vector<std::uint8_t> types;
  types.reserve(mesh.cell_count() + mesh.patch_tags.size());
  for (const CellType type : mesh.types) types.push_back(cell_types[static_cast<std::size_t>(type)]);
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const std::size_t corners = mesh.patch_face(f).size();
    types.push_back(corners < face_types.size() ? face_types[corners] : polygon);
  }
  return types;
}

bool has(const MeshData& mesh, CellType type) {
  return std::find(mesh.types.begin(), mesh.types.end(), type) != mesh.types.end();
}

std::vector<XmlArray> cells_of(const Mesh& mesh) {
  const bool polyhedra = has(*mesh, CellType::polyhedron);
  std::vector<XmlArray> arrays;
  if (!polyhedra && !has(*mesh, CellType::prism) && mesh->patch_tags.empty()) {
    arrays.emplace_back("connectivity", std::span(mesh->connectivity), mesh);
    arrays.emplace_back("offsets", std::span(mesh->offsets).subspan(1), mesh);
    arrays.emplace_back("types", types_of(*mesh));
    return arrays;
  }
  VtuCells corners = corners_of(*mesh);
  arrays.emplace_back("connectivity", std::move(corners.ids));
  arrays.emplace_back("offsets", std::move(corners.ends));
  arrays.emplace_back("types", types_of(*mesh));
  if (!polyhedra) return arrays;
  arrays.emplace_back("faces", std::move(corners.faces));
  arrays.emplace_back("faceoffsets", std::move(corners.face_ends));
  return arrays;
}

// With zeros for the items that it has no values for.
template <class T>
XmlArray padded(const std::string& name, const std::vector<T>& values, std::size_t components, std::size_t items,
                const Mesh& mesh) {
  const std::size_t size = items * components;
  if (values.size() >= size) return {name, std::span(values).first(size), mesh, components};
  std::vector<T> copy = values;
  copy.resize(size);
  return {name, std::move(copy), components};
}

std::vector<XmlArray> cell_data_of(const Mesh& mesh, std::size_t items) {
  std::vector<XmlArray> arrays;
  for (const DataArray& a : mesh->cell_data) {
    if (!is_replaced(*mesh, a.name)) arrays.push_back(padded(a.name, a.values, a.components, items, mesh));
  }
  if (!mesh->free.empty()) arrays.push_back(padded("free", mesh->free, 1, items, mesh));
  if (!mesh->regions.empty()) arrays.push_back(padded("region", mesh->regions, 1, items, mesh));
  if (mesh->patch_tags.empty()) return arrays;
  std::vector<std::int32_t> tags(mesh->cell_count());
  tags.insert(tags.end(), mesh->patch_tags.begin(), mesh->patch_tags.end());
  arrays.emplace_back("patch", std::move(tags));
  return arrays;
}

// As bytes, each text ended by a 0: meshio cannot read a file with VTK's arrays of texts.
void add_texts(const char* array_name, const std::vector<std::string>& texts, std::vector<XmlArray>& to) {
  if (texts.empty()) return;
  std::vector<std::uint8_t> characters;
  for (const std::string& text : texts)
    characters.insert(characters.end(), text.c_str(), text.c_str() + std::strlen(text.c_str()) + 1);
  const std::size_t bytes = characters.size();
  to.emplace_back(array_name, std::move(characters));
  to.back().set_tuples(bytes);
}

void add_names(const char* array_name, const std::map<std::int32_t, std::string>& names, std::vector<XmlArray>& to) {
  std::vector<std::string> texts;
  for (const auto& [tag, name] : names) texts.push_back(fmt::format("{} {}", tag, name));
  add_texts(array_name, texts, to);
}

}  // namespace

XmlArray vtu_points(std::span<const Vec3> points, std::shared_ptr<const void> owner) {
  return {"Points", points, std::move(owner)};
}

XmlDataSet vtu_data_set(const Mesh& mesh) {
  const std::size_t points = mesh->points.size();
  const std::size_t cells = mesh->cell_count() + mesh->patch_tags.size();
  XmlDataSet data = {"UnstructuredGrid", {{"NumberOfPoints", points}, {"NumberOfCells", cells}}, {}, {}};
  data.sections = {{"PointData", {}},
                   {"CellData", cell_data_of(mesh, cells)},
                   {"Points", {vtu_points(mesh->points, mesh)}},
                   {"Cells", cells_of(mesh)}};
  for (const DataArray& a : mesh->point_data)
    data.section("PointData").arrays.push_back(padded(a.name, a.values, a.components, points, mesh));
  add_names("region_names", mesh->region_names, data.field);
  add_names("patch_names", mesh->patch_names, data.field);
  std::vector<std::string> baffles;
  for (const std::int32_t tag : mesh->baffle_tags) baffles.push_back(std::to_string(tag));
  add_texts(baffle_patches, baffles, data.field);
  if (!mesh->free.empty()) add_texts(free_writer, {"dartcast"}, data.field);
  return data;
}

bool is_replaced(const MeshData& mesh, const std::string& cell_array) {
  return (cell_array == "region" && !mesh.regions.empty()) || (cell_array == "free" && !mesh.free.empty()) ||
         (cell_array == "patch" && !mesh.patch_tags.empty());
}

void write_vtu(const MeshData& mesh, const std::filesystem::path& path) {
  const Mesh unowned(std::shared_ptr<const void>(), &mesh);  // lives longer than this call
  write_xml(path, vtu_data_set(unowned), Compression::none, write_pieces);
}

}  // namespace dartcast
