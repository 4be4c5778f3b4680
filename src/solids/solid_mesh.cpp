// Meshes of solids from surfaces, cells and points, and their check.
#include <fmt/format.h>

#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/predicates.hpp"
#include "dartcast/solids.hpp"
#include "mesh/faces.hpp"
#include "surface/ears.hpp"
#include "surface/triangles.hpp"

namespace dartcast {

namespace {

// Leaves out the points that no triangle uses.
SolidMesh used_part(const std::vector<Vec3>& points, std::vector<std::array<std::uint32_t, 3>> triangles) {
  std::vector<std::uint32_t> number(points.size(), 0);
  for (const auto& t : triangles) {
    for (const std::uint32_t p : t) number[p] = 1;
  }
  SolidMesh solid;
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (number[p] == 0) continue;
    number[p] = static_cast<std::uint32_t>(solid.points.size());
    solid.points.push_back(points[p]);
  }
  for (auto& t : triangles) {
    for (std::uint32_t& p : t) p = number[p];
  }
  solid.triangles = std::move(triangles);
  return solid;
}

template <std::size_t N>
void check_parts(const std::vector<std::array<std::uint32_t, N>>& parts, std::size_t points, const char* name) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (std::size_t k = 0; k < N; ++k) {
      if (parts[i][k] >= points)
        throw InvalidMesh(fmt::format("solid: {} {} has the point {}, but there are {}; give points that exist", name,
                                      i, parts[i][k], points));
      if (parts[i][k] == parts[i][(k + 1) % N])
        throw InvalidMesh(fmt::format("solid: {} {} has the point {} twice; leave it out", name, i, parts[i][k]));
    }
  }
}

}  // namespace

SolidMesh solid_of_surface(const MeshData& surface) { return used_part(surface.points, surface_triangles(surface)); }

SolidMesh solid_of_cells(const MeshData& mesh) {
  MeshData repaired = mesh;
  const MeshReport report = check_and_repair(repaired);
  if (!report.valid()) {
    const Finding& defect = report.defects.front();
    const std::string at = defect.first.empty() ? "" : fmt::format(" (first: {})", defect.first.front());
    throw InvalidMesh(fmt::format("solid: {}: {}{}", defect.kind, defect.message, at));
  }
  if (repaired.dimension() != 3) throw InvalidMesh("solid: the mesh is of the plane; give cells of space");
  const BoundaryFaces boundary = match_faces(repaired).boundary;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::size_t f = 0; f < boundary.size(); ++f) {
    const auto face = boundary.face(f);
    std::vector<TriangleCorners> parts = fan_from(face, 0);
    if (!do_not_overlap(repaired.points, face, parts)) parts = ears(repaired.points, face);
    triangles.insert(triangles.end(), parts.begin(), parts.end());
  }
  return used_part(repaired.points, std::move(triangles));
}

SolidMesh solid_of_polyline(std::span<const Vec3> points) {
  SolidMesh solid;
  solid.points.assign(points.begin(), points.end());
  for (std::uint32_t i = 0; i + 1 < points.size(); ++i) solid.edges.push_back({i, i + 1});
  return solid;
}

void check(const SolidMesh& mesh) {
  if (mesh.points.empty()) throw InvalidMesh("solid: it has no points; give one or more");
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    if (!in_exact_range(mesh.points[p]))
      throw InvalidMesh(fmt::format(
          "solid: point {} is not finite or outside the exact range; give coordinates of at most 2^300", p));
  }
  check_parts(mesh.edges, mesh.points.size(), "edge");
  check_parts(mesh.triangles, mesh.points.size(), "triangle");
}

}  // namespace dartcast
