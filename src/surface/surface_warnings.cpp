// Findings on a surface that are allowed: repeated points, open borders, pinched points.
#include "surface/surface_warnings.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "mesh/repeated_points.hpp"

namespace dartcast {
namespace {

/// An edge of a face, with the places of its ends in the mesh's connectivity.
struct FaceEdge {
  std::uint32_t low, high;
  std::size_t low_place, high_place;
};

std::vector<FaceEdge> sorted_edges(const MeshData& mesh) {
  std::vector<FaceEdge> edges;
  edges.reserve(mesh.connectivity.size());
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const std::size_t n = mesh.cell(c).size();
    for (std::size_t k = 0; k < n; ++k) {
      std::size_t i = mesh.offsets[c] + k;
      std::size_t j = mesh.offsets[c] + (k + 1) % n;
      if (mesh.connectivity[i] > mesh.connectivity[j]) std::swap(i, j);
      edges.push_back({mesh.connectivity[i], mesh.connectivity[j], i, j});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const FaceEdge& a, const FaceEdge& b) {
    return std::tie(a.low, a.high, a.low_place) < std::tie(b.low, b.high, b.low_place);
  });
  return edges;
}

void warn_of_repeated_points(const MeshData& mesh, MeshReport& report) {
  std::vector<std::uint32_t> used = mesh.connectivity;
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  std::vector<Vec3> points;
  points.reserve(used.size());
  for (const std::uint32_t v : used) points.push_back(mesh.points[v]);
  Finding finding{
      "repeated_points",
      0,
      {},
      "points at the place of another one: the faces on both sides are not connected there; merge the points "
      "unless that is meant"};
  for (const std::uint32_t i : find_repeated_points(points)) finding.add(used[i]);
  add_finding(report.warnings, finding);
}

}  // namespace

void add_surface_warnings(const MeshData& mesh, MeshReport& report) {
  warn_of_repeated_points(mesh, report);
  std::vector<std::size_t> parent(mesh.connectivity.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  Finding open{"open_border",
               0,
               {},
               "edges of one face alone: the surface is not closed there, and has no inside; one end of each is named"};
  const std::vector<FaceEdge> edges = sorted_edges(mesh);
  for (std::size_t i = 0, j = 0; i < edges.size(); i = j) {
    for (j = i + 1; j < edges.size() && edges[j].low == edges[i].low && edges[j].high == edges[i].high;) ++j;
    if (j - i == 1) open.add(edges[i].low);
    for (std::size_t k = i + 1; k < j; ++k) {
      parent[root(edges[k].low_place)] = root(edges[i].low_place);
      parent[root(edges[k].high_place)] = root(edges[i].high_place);
    }
  }
  add_finding(report.warnings, open);
  std::vector<std::uint32_t> fans;  // the point of each fan of faces
  for (std::size_t i = 0; i < parent.size(); ++i) {
    if (parent[i] == i) fans.push_back(mesh.connectivity[i]);
  }
  std::sort(fans.begin(), fans.end());
  Finding pinched{"pinched_points", 0, {}, "points where the surface touches itself: several fans of faces meet there"};
  for (std::size_t i = 1; i < fans.size(); ++i) {
    if (fans[i] == fans[i - 1] && (i < 2 || fans[i] != fans[i - 2])) pinched.add(fans[i]);
  }
  add_finding(report.warnings, pinched);
}

}  // namespace dartcast
