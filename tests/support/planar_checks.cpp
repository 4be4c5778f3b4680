#include "support/planar_checks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <queue>
#include <set>

#include "support/dyadic.hpp"

namespace dartcast::test {

int plane_sign(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Exact3<Dyadic> u = minus(exact(b), exact(a));
  const Exact3<Dyadic> v = minus(exact(c), exact(a));
  return (u[0] * v[1] - u[1] * v[0]).sign();
}

std::size_t count_not_convex(const MeshData& mesh) {
  std::size_t bad = 0;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const auto cell = mesh.cell(c);
    bool convex = cell.size() >= 3;
    for (std::size_t i = 0; i < cell.size(); ++i) {
      const std::size_t j = (i + 1) % cell.size();
      for (std::size_t k = 0; k < cell.size(); ++k) {
        if (k == i || k == j) continue;
        convex = convex && plane_sign(mesh.points[cell[i]], mesh.points[cell[j]], mesh.points[cell[k]]) > 0;
      }
    }
    bad += convex ? 0 : 1;
  }
  return bad;
}

double area(const MeshData& mesh) {
  double sum = 0;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const auto cell = mesh.cell(c);
    for (std::size_t i = 0; i < cell.size(); ++i) {
      const Vec3 &p = mesh.points[cell[i]], &q = mesh.points[cell[(i + 1) % cell.size()]];
      sum += p.x * q.y - p.y * q.x;
    }
  }
  return sum / 2;  // on an integer lattice, exact
}

std::map<DirectedEdge, std::vector<std::size_t>> directed_edges(const MeshData& mesh) {
  std::map<DirectedEdge, std::vector<std::size_t>> edges;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const auto cell = mesh.cell(c);
    for (std::size_t i = 0; i < cell.size(); ++i) edges[{cell[i], cell[(i + 1) % cell.size()]}].push_back(c);
  }
  return edges;
}

std::size_t expect_conforming_in_plane(const MeshData& mesh) {
  EXPECT_EQ(mesh.dimension(), 2U);
  EXPECT_EQ(mesh.offsets.size(), mesh.cell_count() + 1);
  EXPECT_EQ(mesh.offsets.back(), mesh.connectivity.size());
  EXPECT_TRUE(mesh.free.empty() || mesh.free.size() == mesh.cell_count());
  const auto edges = directed_edges(mesh);
  std::map<std::uint32_t, int> balance;
  std::set<std::uint32_t> used;
  std::size_t shared = 0, boundary = 0;
  for (const auto& [edge, cells] : edges) {
    shared += cells.size() == 1 ? 0 : 1;
    used.insert({edge.first, edge.second});
    if (edges.contains({edge.second, edge.first})) continue;
    ++boundary;
    ++balance[edge.first];
    --balance[edge.second];
  }
  EXPECT_EQ(shared, 0U);
  EXPECT_TRUE(std::all_of(balance.begin(), balance.end(), [](const auto& b) { return b.second == 0; }));
  EXPECT_EQ(used.size(), mesh.points.size());
  EXPECT_TRUE(std::all_of(mesh.points.begin(), mesh.points.end(), [](const Vec3& p) { return p.z == 0.0; }));
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    EXPECT_EQ(mesh.patch_offsets[f + 1], 2 * f + 2);
    const std::uint32_t a = mesh.patch_faces[2 * f], b = mesh.patch_faces[2 * f + 1];
    EXPECT_TRUE(edges.contains({a, b}) && !edges.contains({b, a})) << "patch face " << f;
    EXPECT_TRUE(mesh.patch_names.contains(mesh.patch_tags[f]));
  }
  return boundary;
}

std::vector<bool> reached_from(const MeshData& mesh, std::size_t start) {
  const auto edges = directed_edges(mesh);
  std::vector<bool> reached(mesh.cell_count(), false);
  std::queue<std::size_t> front({start});
  reached[start] = true;
  while (!front.empty()) {
    const auto cell = mesh.cell(front.front());
    front.pop();
    for (std::size_t i = 0; i < cell.size(); ++i) {
      const auto beyond = edges.find({cell[(i + 1) % cell.size()], cell[i]});
      if (beyond == edges.end()) continue;
      const std::size_t c = beyond->second[0];
      if (reached[c] || (!mesh.free.empty() && mesh.free[c] == 0)) continue;
      reached[c] = true;
      front.push(c);
    }
  }
  return reached;
}

}  // namespace dartcast::test
