// Makes data sets of the environment, with the arrays of its input file, after moves and edits.
#include "output/environment_record.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "dartcast/cell_complex.hpp"
#include "dartcast/complex_edit.hpp"
#include "formats/vtu_write.hpp"

namespace dartcast {

namespace {

constexpr const char* source_name = "source";

XmlArray source_array(const MeshData& mesh) {
  std::vector<std::uint32_t> source = mesh.source;
  if (source.empty()) {
    source.resize(mesh.cell_count());
    std::iota(source.begin(), source.end(), 0U);
  }
  return {source_name, std::move(source)};
}

XmlDataSet with_source(const std::shared_ptr<const MeshData>& mesh) {
  XmlDataSet data = vtu_data_set(mesh);
  data.section("CellData").arrays.push_back(source_array(*mesh));
  return data;
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

EnvironmentRecord::EnvironmentRecord(MeshData mesh) {
  mesh.patch_faces.clear();
  mesh.patch_offsets = {0};
  mesh.patch_tags.clear();
  mesh.patch_names.clear();
  for (std::uint32_t c = 0; c < mesh.source.size(); ++c) {
    const std::uint32_t source = mesh.source[c];
    if (source >= row_of_.size()) row_of_.resize(source + std::size_t{1});
    row_of_[source] = c;
  }
  std::erase_if(mesh.cell_data, [](const DataArray& a) { return a.name == source_name; });
  mesh_ = std::make_shared<const MeshData>(std::move(mesh));
}

void EnvironmentRecord::update_after_edit(const Environment& environment) {
  if (!at_vertices_) at_vertices_ = mesh_->point_data;
  for (DataArray& array : *at_vertices_)
    follow_edit(environment.last_edit(), environment.complex().positions().size(), array);
}

XmlDataSet EnvironmentRecord::at_rest() const { return with_source(mesh_); }

void EnvironmentRecord::keep(const std::shared_ptr<const MeshData>& mesh) {
  kept_ = with_source(mesh);
  kept_->section("Points").arrays.clear();
  for (XmlSection& section : kept_->sections) {
    for (XmlArray& array : section.arrays) array.keep();
  }
}

XmlDataSet EnvironmentRecord::data_set(const Environment& environment) {
  const std::uint64_t edits = environment.edit_count();
  if (!kept_ || edits_ != edits) {
    edits_ = edits;
    keep(edits == 0 ? mesh_ : std::make_shared<const MeshData>(edited_mesh(environment.complex())));
  }
  const std::span<const Vec3> positions = environment.positions();
  std::vector<Vec3> points;
  if (edits == 0) {
    points.assign(positions.begin(), positions.end());
  } else {
    points.reserve(vertices_.size());
    for (const Vertex v : vertices_) points.push_back(positions[v.value]);
  }
  XmlDataSet data = *kept_;
  data.section("Points").arrays.emplace_back("Points", std::move(points));
  for (const DataArray& a : cell_arrays_) {
    std::vector<double> values = a.values;
    if (edits == 0) {
      const std::vector<Cell> cells = environment.map().cells();
      for (std::size_t i = 0; i < a.values.size(); ++i) {
        const std::size_t to = row(environment.map().source(cells[i / a.components]));
        values[to * a.components + i % a.components] = a.values[i];
      }
    }
    data.section("CellData").arrays.emplace_back(a.name, std::move(values), a.components);
  }
  return data;
}

// The rows of mesh_ that the cells came from.
std::vector<std::size_t> EnvironmentRecord::rows(const MeshData& edited) const {
  std::vector<std::size_t> rows;
  for (const std::uint32_t source : edited.source) rows.push_back(row(source));
  return rows;
}

MeshData EnvironmentRecord::edited_mesh(const CellComplex& complex) {
  MeshData mesh = to_mesh(complex, &vertices_);
  const std::vector<std::size_t> from = rows(mesh);
  mesh.region_names = mesh_->region_names;
  if (!mesh_->regions.empty()) {
    for (const std::size_t row : from) mesh.regions.push_back(mesh_->regions[row]);
  }
  for (const DataArray& a : mesh_->cell_data)
    mesh.cell_data.push_back(gathered(a, from.size(), [&](std::size_t c) { return from[c]; }));
  for (const DataArray& a : at_vertices_ ? *at_vertices_ : mesh_->point_data)
    mesh.point_data.push_back(gathered(a, vertices_.size(), [&](std::size_t i) { return vertices_[i].value; }));
  return mesh;
}

}  // namespace dartcast
