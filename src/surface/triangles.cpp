// The triangles of a surface, cut from its faces, and the check that it is closed.
#include "surface/triangles.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "dartcast/error.hpp"
#include "surface/check_surface.hpp"

namespace dartcast {

namespace {

[[noreturn]] void refuse(const Finding& defect) {
  const std::string at = defect.first.empty() ? "" : fmt::format(" (first at face {})", defect.first.front());
  throw InvalidMesh(fmt::format("surface: {}: {}{}", defect.kind, defect.message, at));
}

}  // namespace

std::vector<SurfaceTriangle> surface_triangles(const MeshData& surface) {
  MeshData oriented = surface;
  const MeshReport report = check_and_repair_surface(oriented);
  if (!report.valid()) refuse(report.defects.front());
  std::vector<SurfaceTriangle> triangles;
  for (std::size_t c = 0; c < oriented.cell_count(); ++c) {
    const std::span<const std::uint32_t> face = oriented.cell(c);
    const auto lowest = static_cast<std::size_t>(std::min_element(face.begin(), face.end()) - face.begin());
    const auto corner = [&](std::size_t i) { return face[(lowest + i) % face.size()]; };
    for (std::size_t i = 1; i + 1 < face.size(); ++i) triangles.push_back({corner(0), corner(i), corner(i + 1)});
  }
  return triangles;
}

void check_closed(const std::vector<SurfaceTriangle>& triangles) {
  using Edge = std::array<std::uint32_t, 2>;
  std::vector<Edge> edges;
  for (const SurfaceTriangle& t : triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i];
      const std::uint32_t b = t[(i + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b)});
    }
  }
  std::sort(edges.begin(), edges.end());
  std::size_t open = 0;
  Edge first{};
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    while (end < edges.size() && edges[end] == edges[i]) ++end;
    if (end - i != 1) continue;
    if (open++ == 0) first = edges[i];
  }
  if (open == 0) return;
  throw InvalidMesh(fmt::format(
      "surface: it has a hole: {} edges have a face on one side only (first between points {} and {}); close "
      "it, or sample the surface alone",
      open, first[0], first[1]));
}

Box box_of(const std::vector<Vec3>& points, const SurfaceTriangle& t) {
  const Box box = {points[t[0]], points[t[0]]};
  return join(join(box, {points[t[1]], points[t[1]]}), {points[t[2]], points[t[2]]});
}

}  // namespace dartcast
