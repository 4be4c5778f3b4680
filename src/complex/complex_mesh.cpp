// A complex as a mesh again.
#include <utility>
#include <vector>

#include "dartcast/cell_complex.hpp"

namespace dartcast {

namespace {

class ComplexMeshBuilder {
 public:
  explicit ComplexMeshBuilder(const CellComplex& complex)
      : complex_(complex), number_(complex.map().vertex_count(), none) {}

  // `vertices`: receives the vertex of each point.
  MeshData write(std::vector<Vertex>& vertices) {
    const CombinatorialMap& map = complex_.map();
    for (const Cell c : map.cells()) {
      const CellView v = map.view(c);
      corners_.clear();
      if (map.type(c) == CellType::polyhedron) {
        add_faces(v);
      } else {
        for (std::uint16_t k = 0; k < v.shape().corner_count(); ++k) corners_.push_back(number(v.vertex(k)));
      }
      mesh_.add_cell(map.type(c), corners_);
      mesh_.source.push_back(map.source(c));
      mesh_.free.push_back(v.is_free() ? 1 : 0);
    }
    vertices = std::move(vertices_);
    return std::move(mesh_);
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffU;

  void add_faces(const CellView& v) {
    corners_.push_back(v.shape().face_count());
    for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
      corners_.push_back(v.shape().degree(f));
      for (const std::uint16_t k : v.shape().corners(f)) corners_.push_back(number(v.vertex(k)));
    }
  }

  std::uint32_t number(Vertex v) {
    std::uint32_t& n = number_[v.value];
    if (n == none) {
      n = static_cast<std::uint32_t>(mesh_.points.size());
      mesh_.points.push_back(complex_.positions()[v.value]);
      vertices_.push_back(v);
    }
    return n;
  }

  const CellComplex& complex_;
  MeshData mesh_;
  std::vector<Vertex> vertices_;
  std::vector<std::uint32_t> number_;  // of a vertex among the points
  std::vector<std::uint32_t> corners_;
};

}  // namespace

MeshData to_mesh(const CellComplex& complex, std::vector<Vertex>* vertices) {
  std::vector<Vertex> unasked;
  return ComplexMeshBuilder(complex).write(vertices != nullptr ? *vertices : unasked);
}

}  // namespace dartcast
