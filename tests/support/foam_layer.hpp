// A mesh of the plane as OpenFOAM has it: one layer of cells.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "dartcast/mesh_data.hpp"

namespace dartcast::test {

/// One layer of cells above a mesh of the plane: points of the lower side first. Edges in patches become faces; those
/// below and above are the patch "sides".
inline MeshData layer(const MeshData& plane, double below, double above) {
  MeshData mesh;
  const auto n = static_cast<std::uint32_t>(plane.points.size());
  for (const double z : {below, above}) {
    for (const Vec3& p : plane.points) mesh.points.push_back({p.x, p.y, z});
  }
  for (std::size_t c = 0; c < plane.cell_count(); ++c) {
    const auto corners = plane.cell(c);
    const auto size = static_cast<std::uint32_t>(corners.size());
    std::vector<std::uint32_t> stream = {size + 2, size}, top = {size};
    stream.insert(stream.end(), corners.rbegin(), corners.rend());
    mesh.add_patch_face({stream.data() + 2, size}, 100);
    for (const std::uint32_t p : corners) top.push_back(p + n);
    mesh.add_patch_face({top.data() + 1, size}, 100);
    stream.insert(stream.end(), top.begin(), top.end());
    for (std::uint32_t i = 0; i < size; ++i) {
      const std::uint32_t a = corners[i], b = corners[(i + 1) % size];
      for (const std::uint32_t x : {4U, a, b, b + n, a + n}) stream.push_back(x);
    }
    mesh.add_cell(CellType::polyhedron, stream);
  }
  for (std::size_t f = 0; f < plane.patch_tags.size(); ++f) {
    const auto edge = plane.patch_face(f);
    const std::array<std::uint32_t, 4> face = {edge[0], edge[1], edge[1] + n, edge[0] + n};
    mesh.add_patch_face(face, plane.patch_tags[f]);
  }
  mesh.regions = plane.regions;
  mesh.region_names = plane.region_names;
  mesh.patch_names = plane.patch_names;
  mesh.patch_names[100] = "sides";
  return mesh;
}

}  // namespace dartcast::test
