#include "support/closed_surfaces.hpp"

#include <cmath>
#include <map>
#include <numbers>

namespace dartcast::test {

void add_face(MeshData& mesh, std::initializer_list<std::uint32_t> corners) {
  const CellType type = corners.size() == 3   ? CellType::triangle
                        : corners.size() == 4 ? CellType::quadrilateral
                                              : CellType::polygon;
  mesh.add_cell(type, {corners.begin(), corners.size()});
}

MeshData cuboid(const Vec3& low, const Vec3& high) {
  MeshData mesh;
  for (std::uint32_t i = 0; i < 8; ++i)
    mesh.points.push_back(
        {(i & 1U) != 0 ? high.x : low.x, (i & 2U) != 0 ? high.y : low.y, (i & 4U) != 0 ? high.z : low.z});
  add_face(mesh, {0, 2, 3, 1});
  add_face(mesh, {4, 5, 7, 6});
  add_face(mesh, {0, 1, 5, 4});
  add_face(mesh, {2, 6, 7, 3});
  add_face(mesh, {0, 4, 6, 2});
  add_face(mesh, {1, 3, 7, 5});
  return mesh;
}

MeshData torus(double radius, double tube, std::uint32_t around, std::uint32_t across) {
  MeshData mesh;
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) {
      const double a = 2 * std::numbers::pi * i / around;
      const double b = 2 * std::numbers::pi * j / across;
      const double r = radius + tube * std::cos(b);
      mesh.points.push_back({r * std::cos(a), r * std::sin(a), tube * std::sin(b)});
    }
  }
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return (i % around) * across + j % across; };
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) add_face(mesh, {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
  }
  return mesh;
}

MeshData lattice_solid(const std::vector<std::array<int, 3>>& cubes) {
  MeshData mesh;
  std::map<std::array<int, 3>, std::uint32_t> number;
  const auto corner = [&](const std::array<int, 3>& p) {
    const auto [found, fresh] = number.try_emplace(p, static_cast<std::uint32_t>(mesh.points.size()));
    if (fresh) mesh.points.push_back({double(p[0]), double(p[1]), double(p[2])});
    return found->second;
  };
  const auto solid = [&](const std::array<int, 3>& c) {
    for (const auto& other : cubes) {
      if (other == c) return true;
    }
    return false;
  };
  for (const auto& c : cubes) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const int side : {0, 1}) {
        std::array<int, 3> beside = c;
        beside[axis] += side == 0 ? -1 : 1;
        if (solid(beside)) continue;
        const std::size_t u = (axis + 1) % 3;
        const std::size_t v = (axis + 2) % 3;
        std::array<std::array<int, 3>, 4> p = {c, c, c, c};
        for (auto& q : p) q[axis] += side;
        p[1][u] += 1;
        p[2][u] += 1;
        p[2][v] += 1;
        p[3][v] += 1;
        if (side == 0) std::swap(p[1], p[3]);
        add_face(mesh, {corner(p[0]), corner(p[1]), corner(p[2]), corner(p[3])});
      }
    }
  }
  return mesh;
}

}  // namespace dartcast::test
