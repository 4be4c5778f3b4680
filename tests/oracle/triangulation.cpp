#include "oracle/triangulation.hpp"

#include <algorithm>
#include <stdexcept>

namespace dartcast::oracle {
namespace {

using Face = std::vector<std::uint32_t>;

// Faces as corner numbers, from the description of the corners' order in MeshData.
const std::vector<Face>& standard(CellType type) {
  static const std::vector<Face> tetrahedron = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  static const std::vector<Face> hexahedron = {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                               {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  static const std::vector<Face> prism = {{2, 1, 0}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
  static const std::vector<Face> pyramid = {{3, 2, 1, 0}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  switch (type) {
    case CellType::tetrahedron: return tetrahedron;
    case CellType::hexahedron: return hexahedron;
    case CellType::prism: return prism;
    case CellType::pyramid: return pyramid;
    case CellType::polyhedron:
    case CellType::triangle:
    case CellType::quadrilateral:
    case CellType::polygon: break;
  }
  throw std::logic_error("oracle: a polyhedron has no standard faces");
}

template <std::size_t N>
std::array<std::uint32_t, N> sorted(std::array<std::uint32_t, N> a) {
  std::sort(a.begin(), a.end());
  return a;
}

std::pair<std::uint32_t, std::uint32_t> ordered(std::uint32_t a, std::uint32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

bool contains(const auto& list, std::uint32_t x) { return std::find(list.begin(), list.end(), x) != list.end(); }

// Counterclockwise seen from outside of a positive tetrahedron.
Triangle facet(const Tetrahedron& t, std::size_t opposite) {
  static constexpr std::array<Triangle, 4> outward = {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
  const Triangle& f = outward[opposite];
  return {t[f[0]], t[f[1]], t[f[2]]};
}

// Turned so that the lowest number comes first.
Triangle turned(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

}  // namespace

std::vector<Face> faces_of(const MeshData& mesh, std::size_t cell) {
  const auto corners = mesh.cell(cell);
  std::vector<Face> faces;
  if (mesh.types[cell] == CellType::polyhedron) {
    auto at = corners.begin();
    for (std::uint32_t left = *at++; left > 0; --left) {
      const std::uint32_t n = *at++;
      faces.emplace_back(at, at + n);
      at += n;
    }
  } else {
    for (Face face : standard(mesh.types[cell])) {
      for (std::uint32_t& c : face) c = corners[c];
      faces.push_back(std::move(face));
    }
  }
  return faces;
}

std::vector<Triangle> fan(const Face& face, std::uint32_t point) {
  std::vector<Triangle> triangles;
  const std::uint32_t from = point != none ? point : *std::min_element(face.begin(), face.end());
  for (std::size_t i = 0; i < face.size(); ++i) {
    const std::uint32_t a = face[i];
    const std::uint32_t b = face[(i + 1) % face.size()];
    if (a != from && b != from) triangles.push_back({from, a, b});
  }
  return triangles;
}

Triangulation::Triangulation(const MeshData& mesh, const InteriorVertices& interior)
    : mesh_point_count_(mesh.points.size()),
      free_(mesh.cell_count(), true),
      faces_(mesh.cell_count()),
      fans_(mesh.cell_count()) {
  for (std::uint32_t c = 0; c < mesh.cell_count(); ++c) {
    if (!mesh.free.empty()) free_[c] = mesh.free[c] != 0;
    add_cell(mesh, c, interior);
  }
  connect();
}

void Triangulation::add_cell(const MeshData& mesh, std::uint32_t cell, const InteriorVertices& interior) {
  const auto own = interior.of_cell.find(cell);
  const std::vector<Face> faces = faces_of(mesh, cell);
  std::uint32_t apex = none;
  for (const Face& face : faces) apex = std::min(apex, *std::min_element(face.begin(), face.end()));
  if (own != interior.of_cell.end()) apex = own->second;
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    Face face = faces[f];
    for (std::size_t i = 0; i < face.size(); ++i) edges_.insert(ordered(face[i], face[(i + 1) % face.size()]));
    const auto centre = interior.of_face.find({cell, f});
    const std::uint32_t point = centre == interior.of_face.end() ? none : centre->second;
    for (const Triangle& t : fan(face, point)) {
      fans_[cell][turned(t)] = f;
      if (!contains(t, apex)) add_simplex(cell, t, apex);
    }
    if (point != none) face.push_back(point);
    std::sort(face.begin(), face.end());
    faces_[cell].push_back(std::move(face));
  }
}

// The triangle is counterclockwise seen from the outside, so the apex lies on its negative side: two corners change
// places.
void Triangulation::add_simplex(std::uint32_t cell, const Triangle& t, std::uint32_t apex) {
  Simplex s;
  s.vertex = {t[0], t[2], t[1], apex};
  s.cell = cell;
  by_vertices_[{cell, sorted(s.vertex)}] = static_cast<std::uint32_t>(simplices_.size());
  simplices_.push_back(s);
}

// The face whose fan has this facet: by the turn of its corners seen from outside, too, since two faces that bend
// around the same three corners may share a triangle, one from each side.
std::uint32_t Triangulation::face_with(std::uint32_t cell, const Triangle& outward) const {
  const auto& triangles = fans_[cell];
  const auto found = triangles.find(turned(outward));
  return found == triangles.end() ? none : found->second;
}

void Triangulation::connect() {
  using Side = std::pair<std::uint32_t, std::uint32_t>;
  std::map<std::pair<std::vector<std::uint32_t>, Triangle>, std::vector<Side>> sides;  // by face or cell, and corners
  for (std::uint32_t s = 0; s < simplices_.size(); ++s) {
    for (std::uint32_t i = 0; i < 4; ++i) {
      const Triangle outward = facet(simplices_[s].vertex, i);
      const std::uint32_t cell = simplices_[s].cell;
      const std::uint32_t face = face_with(cell, outward);
      const auto place = face == none ? std::vector{none, cell} : faces_[cell][face];
      sides[{place, sorted(outward)}].emplace_back(s, i);
    }
  }
  for (const auto& [triangle, both] : sides) {
    if (both.size() > 2) throw std::logic_error("oracle: a triangle of three simplices");
    if (both.size() == 2) {
      simplices_[both[0].first].beyond[both[0].second] = both[1].first;
      simplices_[both[1].first].beyond[both[1].second] = both[0].first;
    }
    for (const auto& [s, i] : both) {
      const std::uint32_t other = simplices_[s].beyond[i];
      if (free_[simplices_[s].cell] && (other == none || !free_[simplices_[other].cell])) add_wall(s, i);
    }
  }
}

void Triangulation::add_wall(std::uint32_t simplex, std::uint32_t opposite) {
  Simplex& s = simplices_[simplex];
  WallTriangle wall;
  wall.vertex = facet(s.vertex, opposite);
  wall.cell = s.cell;
  wall.face = face_with(s.cell, wall.vertex);
  if (wall.face == none)
    throw std::logic_error("oracle: a wall inside of a cell; does a shared face differ from its other side?");
  for (std::size_t i = 0; i < 3; ++i) {
    wall.mesh_edge[i] = edges_.contains(ordered(wall.vertex[i], wall.vertex[(i + 1) % 3]));
  }
  s.wall[opposite] = static_cast<std::uint32_t>(walls_.size());
  walls_.push_back(wall);
}

std::uint32_t Triangulation::find(std::uint32_t cell, Tetrahedron vertices) const {
  const auto found = by_vertices_.find({cell, sorted(vertices)});
  return found == by_vertices_.end() ? none : found->second;
}

int Triangulation::dimension(std::uint32_t cell, const std::vector<std::uint32_t>& vertices) const {
  if (vertices.size() == 4) return 3;
  if (vertices.size() == 1 && vertices[0] < mesh_point_count_) return 0;
  if (vertices.size() == 2 && edges_.contains(ordered(vertices[0], vertices[1]))) return 1;
  for (const auto& face : faces_[cell]) {
    if (std::all_of(vertices.begin(), vertices.end(), [&](std::uint32_t v) { return contains(face, v); })) return 2;
  }
  return 3;
}

}  // namespace dartcast::oracle
