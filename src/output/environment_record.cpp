// Writes the environment, with the arrays of its input file, after moves and edits.
#include "output/environment_record.hpp"

#include <algorithm>
#include <utility>

#include "dartcast/cell_complex.hpp"
#include "dartcast/complex_edit.hpp"
#include "formats/vtk_mesh.hpp"

namespace dartcast {

namespace {

constexpr const char* source_name = "source";

DataArray source_array(const MeshData& mesh) {
  DataArray array{source_name, 1, std::vector<double>(mesh.cell_count())};
  for (std::size_t c = 0; c < mesh.cell_count(); ++c)
    array.values[c] = static_cast<double>(mesh.source.empty() ? c : mesh.source[c]);
  return array;
}

// Item i has the values of `from`'s item row(i).
template <class Row>
DataArray gathered(const DataArray& from, std::size_t count, Row&& row) {
  DataArray to{from.name, from.components, {}};
  to.values.reserve(count * from.components);
  for (std::size_t i = 0; i < count; ++i) {
    const auto begin = from.values.begin() + static_cast<std::ptrdiff_t>(row(i) * from.components);
    to.values.insert(to.values.end(), begin, begin + static_cast<std::ptrdiff_t>(from.components));
  }
  return to;
}

// As dartcast::update_after_edit(), for an array of any number of components.
void follow_edit(const ComplexEditReport& edit, std::size_t size, DataArray& array) {
  const std::size_t n = array.components;
  array.values.resize(size * n);
  for (const PlacedVertex& p : edit.placed) {
    if (p.vertex.value >= size) continue;
    for (std::size_t k = 0; k < n; ++k) {
      double sum = 0.0;
      for (std::size_t i = 0; i < p.of.size(); ++i) sum += array.values[p.of[i].value * n + k] * p.weights[i];
      array.values[p.vertex.value * n + k] = sum;
    }
  }
}

}  // namespace

EnvironmentRecord::EnvironmentRecord(MeshData mesh) : mesh_(std::move(mesh)) {
  mesh_.patch_faces.clear();
  mesh_.patch_offsets = {0};
  mesh_.patch_tags.clear();
  mesh_.patch_names.clear();
  for (std::uint32_t c = 0; c < mesh_.source.size(); ++c) {
    const std::uint32_t source = mesh_.source[c];
    if (source >= row_of_.size()) row_of_.resize(source + std::size_t{1});
    row_of_[source] = c;
  }
  std::erase_if(mesh_.cell_data, [](const DataArray& a) { return a.name == source_name; });
  mesh_.cell_data.push_back(source_array(mesh_));
}

void EnvironmentRecord::update_after_edit(const Environment& environment) {
  for (DataArray& array : mesh_.point_data)
    follow_edit(environment.last_edit(), environment.complex().positions().size(), array);
}

void EnvironmentRecord::write_at_rest(const std::filesystem::path& file) const { write_vtu(mesh_, file); }

void EnvironmentRecord::write(const Environment& environment, const std::filesystem::path& file) {
  if (environment.edit_count() > 0) return write_edited(environment.complex(), file);
  const std::span<const Vec3> positions = environment.positions();
  mesh_.points.assign(positions.begin(), positions.end());
  write_vtu(mesh_, file);
}

// The rows of mesh_ that the cells came from.
std::vector<std::size_t> EnvironmentRecord::rows(const MeshData& edited) const {
  std::vector<std::size_t> rows(edited.source.begin(), edited.source.end());
  if (!row_of_.empty()) {
    for (std::size_t& row : rows) row = row_of_[row];
  }
  return rows;
}

void EnvironmentRecord::write_edited(const CellComplex& complex, const std::filesystem::path& file) const {
  std::vector<Vertex> vertices;
  MeshData mesh = to_mesh(complex, &vertices);
  const std::vector<std::size_t> from = rows(mesh);
  mesh.region_names = mesh_.region_names;
  if (!mesh_.regions.empty()) {
    for (const std::size_t row : from) mesh.regions.push_back(mesh_.regions[row]);
  }
  for (const DataArray& a : mesh_.cell_data)
    mesh.cell_data.push_back(gathered(a, from.size(), [&](std::size_t c) { return from[c]; }));
  for (const DataArray& a : mesh_.point_data)
    mesh.point_data.push_back(gathered(a, vertices.size(), [&](std::size_t i) { return vertices[i].value; }));
  write_vtu(mesh, file);
}

}  // namespace dartcast
