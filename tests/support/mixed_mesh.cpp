#include "support/mixed_mesh.hpp"

namespace dartcast::test {

void add_tetrahedron(MeshData& mesh, std::array<std::uint32_t, 4> v) {
  const Vec3& a = mesh.points[v[0]];
  if (dot(cross(mesh.points[v[1]] - a, mesh.points[v[2]] - a), mesh.points[v[3]] - a) < 0.0) std::swap(v[2], v[3]);
  mesh.add_cell(CellType::tetrahedron, v);
}

MeshData mixed_mesh() {
  MeshData mesh;
  mesh.points = {{0, 0, 0},     {1, 0, 0},      {1, 1, 0},     {0, 1, 0},
                 {0, 0, 1},     {1, 0, 1},      {1, 1, 1},     {0, 1, 1},   // the cube
                 {2, 0.5, 0.5}, {1.5, 0.5, -1}, {1.5, 0.5, 2},              // beyond x = 1
                 {0, 2, 0.5},   {1, 2, 0.5},    {2, 1.5, 0.5},              // beyond y = 1
                 {0, 0, -1},    {1, 0, -1},     {1, 1, -1},    {0, 1, -1},  // below
                 {-1, 0, 2},    {0, -1, 2},     {0, 0, 2}};                 // far
  add(mesh, CellType::hexahedron, {0, 1, 2, 3, 4, 5, 6, 7});
  add(mesh, CellType::pyramid, {1, 2, 6, 5, 8});
  add(mesh, CellType::prism, {3, 11, 7, 2, 12, 6});
  add_tetrahedron(mesh, {1, 2, 8, 9});
  add_tetrahedron(mesh, {5, 6, 8, 10});
  add_tetrahedron(mesh, {2, 12, 6, 13});
  add(mesh, CellType::polyhedron, {6,                                   //
                                   4, 14, 17, 16, 15, 4, 0,  1,  2, 3,  // below, above
                                   4, 14, 15, 1,  0,  4, 15, 16, 2, 1,  //
                                   4, 16, 17, 3,  2,  4, 17, 14, 0, 3});
  add_tetrahedron(mesh, {4, 18, 19, 20});
  return mesh;
}

MeshData renumbered(const MeshData& mesh, std::span<const std::uint32_t> order) {
  MeshData result = mesh;
  for (std::size_t i = 0; i < mesh.points.size(); ++i) result.points[order[i]] = mesh.points[i];
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    std::uint32_t* at = result.connectivity.data() + result.offsets[c];
    if (mesh.types[c] != CellType::polyhedron) {
      for (std::size_t i = 0; i < mesh.cell(c).size(); ++i) at[i] = order[at[i]];
      continue;
    }
    std::uint32_t* face = at + 1;
    for (std::uint32_t f = 0; f < at[0]; ++f) {
      for (std::uint32_t i = 1; i <= face[0]; ++i) face[i] = order[face[i]];
      face += face[0] + 1;
    }
  }
  for (std::uint32_t& v : result.patch_faces) v = order[v];
  return result;
}

}  // namespace dartcast::test
