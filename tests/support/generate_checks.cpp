#include "support/generate_checks.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/dyadic.hpp"

namespace dartcast::test {

CornerNumbers from_lowest(std::span<const std::uint32_t> face) {
  CornerNumbers f(face.begin(), face.end());
  std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
  return f;
}

CornerNumbers reversed(CornerNumbers f) {
  std::reverse(f.begin() + 1, f.end());
  return f;
}

std::map<CornerNumbers, std::vector<std::size_t>> all_faces(const MeshData& mesh) {
  std::map<CornerNumbers, std::vector<std::size_t>> faces;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> face) { faces[from_lowest(face)].push_back(c); });
  }
  return faces;
}

std::size_t count_not_positive(const MeshData& mesh, std::span<const Vec3> points) {
  std::size_t bad = 0;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    for_each_simplex(mesh, c, [&](std::uint32_t i, std::uint32_t j, std::uint32_t k, std::uint32_t l) {
      bad += exact_sign(points[i], points[j], points[k], points[l]) > 0 ? 0 : 1;
    });
  }
  return bad;
}

double volume(const MeshData& mesh) {
  double sum = 0;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    for_each_simplex(mesh, c, [&](std::uint32_t i, std::uint32_t j, std::uint32_t k, std::uint32_t l) {
      const Vec3& a = mesh.points[i];
      sum += dot(cross(mesh.points[j] - a, mesh.points[k] - a), mesh.points[l] - a);
    });
  }
  return sum / 6;  // on an integer lattice, exact
}

std::size_t expect_conforming(const MeshData& mesh) {
  EXPECT_EQ(mesh.offsets.size(), mesh.cell_count() + 1);
  EXPECT_EQ(mesh.offsets.back(), mesh.connectivity.size());
  EXPECT_TRUE(mesh.free.empty() || mesh.free.size() == mesh.cell_count());
  EXPECT_TRUE(mesh.regions.empty() || mesh.regions.size() == mesh.cell_count());

  const auto faces = all_faces(mesh);
  std::vector<std::uint8_t> used(mesh.points.size(), 0);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> boundary_edges;
  std::size_t shared_in_one_orientation = 0, boundary = 0;
  for (const auto& [face, cells] : faces) {
    shared_in_one_orientation += cells.size() == 1 ? 0 : 1;
    for (const std::uint32_t p : face) used.at(p) = 1;
    if (faces.contains(reversed(face))) continue;
    ++boundary;
    for (std::size_t i = 0; i < face.size(); ++i) {
      const std::uint32_t a = face[i], b = face[(i + 1) % face.size()];
      boundary_edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  }
  EXPECT_EQ(shared_in_one_orientation, 0U);
  EXPECT_TRUE(std::all_of(boundary_edges.begin(), boundary_edges.end(), [](const auto& e) { return e.second == 0; }));
  EXPECT_EQ(std::count(used.begin(), used.end(), 0), 0);
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const CornerNumbers corners(mesh.patch_faces.begin() + static_cast<std::ptrdiff_t>(mesh.patch_offsets[f]),
                                mesh.patch_faces.begin() + static_cast<std::ptrdiff_t>(mesh.patch_offsets[f + 1]));
    EXPECT_TRUE(faces.contains(from_lowest(corners)) || faces.contains(reversed(from_lowest(corners))))
        << "patch face " << f;
    EXPECT_TRUE(mesh.patch_names.contains(mesh.patch_tags[f]));
  }
  return boundary;
}

std::map<std::string, std::size_t> patch_sizes(const MeshData& mesh) {
  std::map<std::string, std::size_t> sizes;
  for (const std::int32_t tag : mesh.patch_tags) ++sizes[mesh.patch_names.at(tag)];
  return sizes;
}

}  // namespace dartcast::test
