// A complex, or some of its cells, as a mesh again.
#include <utility>

#include "complex/cells_as_mesh.hpp"
#include "dartcast/cell_complex.hpp"

namespace dartcast {

namespace detail {

CellsAsMesh::CellsAsMesh(const CombinatorialMap& map, std::span<const Vec3> positions)
    : map_(map), positions_(positions), number_(map.vertex_count(), none) {}

void CellsAsMesh::add(Cell cell) {
  const CellView v = map_.view(cell);
  corners_.clear();
  if (map_.type(cell) == CellType::polyhedron) {
    corners_.push_back(v.shape().face_count());
    for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
      corners_.push_back(v.shape().degree(f));
      for (const std::uint16_t k : v.shape().corners(f)) corners_.push_back(number(v.vertex(k)));
    }
  } else {
    for (std::uint16_t k = 0; k < v.shape().corner_count(); ++k) corners_.push_back(number(v.vertex(k)));
  }
  mesh_.add_cell(map_.type(cell), corners_);
  mesh_.source.push_back(map_.source(cell));
  mesh_.free.push_back(v.is_free() ? 1 : 0);
}

std::uint32_t CellsAsMesh::number(Vertex v) {
  std::uint32_t& n = number_[v.value];
  if (n == none) {
    n = static_cast<std::uint32_t>(mesh_.points.size());
    mesh_.points.push_back(positions_[v.value]);
    vertices_.push_back(v);
  }
  return n;
}

}  // namespace detail

MeshData to_mesh(const CellComplex& complex, std::vector<Vertex>* vertices) {
  detail::CellsAsMesh cells(complex.map(), complex.positions());
  for (const Cell c : complex.map().cells()) cells.add(c);
  if (vertices != nullptr) *vertices = cells.vertices();
  return std::move(cells.mesh());
}

}  // namespace dartcast
