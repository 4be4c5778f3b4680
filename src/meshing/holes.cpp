// Finds holes by following the edges that have a face on one side alone.
#include "meshing/holes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "meshing/fill_hole.hpp"
#include "surface/check_surface.hpp"
#include "surface/ears.hpp"

namespace dartcast {
namespace {

/// Edges without a face on their other side, by where they start as seen from there.
std::multimap<std::uint32_t, std::uint32_t> border_of(const MeshData& surface) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::size_t c = 0; c < surface.cell_count(); ++c) {
    const auto t = surface.cell(c);
    for (std::size_t k = 0; k < t.size(); ++k) edges.insert({t[k], t[(k + 1) % t.size()]});
  }
  std::multimap<std::uint32_t, std::uint32_t> border;
  for (const auto& [a, b] : edges) {
    if (edges.count({b, a}) == 0) border.insert({b, a});
  }
  return border;
}

void measure(const MeshData& surface, Hole& hole) {
  for (const std::uint32_t p : hole.corners) hole.centre += surface.points[p] * (1.0 / double(hole.corners.size()));
  const Vec3 twice = vector_area(surface.points, hole.corners);
  const double length = norm(twice);
  hole.area = 0.5 * length;
  for (const std::uint32_t p : hole.corners) {
    const double off = length > 0.0 ? std::abs(dot(surface.points[p] - hole.centre, twice)) / length : 0.0;
    hole.off_plane = std::max(hole.off_plane, off);
  }
}

double diameter(const Hole& hole) { return 2.0 * std::sqrt(hole.area / 3.141592653589793); }

std::string place(const Hole& hole) {
  return fmt::format("around ({:.4g}, {:.4g}, {:.4g})", hole.centre.x, hole.centre.y, hole.centre.z);
}

/// Flatter holes are closed as seen along their normal. In others the triangles would fold.
constexpr double flat_tolerance = 0.05;

bool is_flat(const Hole& hole, double tolerance) {
  return hole.area > 0.0 && hole.off_plane <= tolerance * diameter(hole);
}

}  // namespace

std::vector<TriangleCorners> triangles_of(const MeshData& surface) {
  std::vector<TriangleCorners> all;
  for (std::size_t c = 0; c < surface.cell_count(); ++c) {
    const auto t = surface.cell(c);
    all.push_back({t[0], t[1], t[2]});
  }
  return all;
}

std::vector<Hole> holes_of(const MeshData& surface) {
  auto border = border_of(surface);
  std::vector<Hole> holes;
  while (!border.empty()) {
    Hole hole;
    const std::uint32_t first = border.begin()->first;
    std::uint32_t at = first;
    // Each corner has as many edges of the border that start there as that end there, so the way ends where it began.
    do {
      hole.corners.push_back(at);
      const auto edge = border.find(at);
      at = edge->second;
      border.erase(edge);
    } while (at != first);
    measure(surface, hole);
    holes.push_back(std::move(hole));
  }
  return holes;
}

void join_borders(MeshData& surface, MeshReport& report) {
  std::set<std::uint32_t> on_border;
  for (const auto& [a, b] : border_of(surface)) on_border.insert(a);
  Finding joined{"repeated_points", 0, {}, "points of borders at the place of another one have been joined"};
  std::map<std::array<double, 3>, std::uint32_t> first;
  std::map<std::uint32_t, std::uint32_t> number;
  for (const std::uint32_t p : on_border) {
    const Vec3& x = surface.points[p];
    const auto [at, added] = first.try_emplace({x.x + 0.0, x.y + 0.0, x.z + 0.0}, p);  // -0 becomes 0
    number[p] = at->second;
    if (!added) joined.add(p);
  }
  if (joined.count == 0) return;
  MeshData without = surface;
  for (std::uint32_t& p : without.connectivity) {
    if (const auto found = number.find(p); found != number.end()) p = found->second;
  }
  if (!check_and_repair_surface(without).valid()) return;
  surface = std::move(without);
  report.repairs.push_back(std::move(joined));
  std::erase_if(report.warnings, [](const Finding& w) { return w.kind == "repeated_points"; });
}

void close_holes(MeshData& surface, MeshReport& report, double tolerance) {
  std::vector<Hole> holes = holes_of(surface);
  for (const Hole& hole : holes) {
    if (is_flat(hole, tolerance)) continue;
    const double share = hole.area > 0.0 ? hole.off_plane / diameter(hole) : 1.0;
    report.defects.push_back(
        {"cap",
         1,
         {hole.corners.begin(), hole.corners.end()},
         fmt::format(
             "hole that is not near a plane, {}: its border is {:.3g} off, and {:.3g} wide; give cap a tolerance above "
             "{:.2g} (cap = {{ tolerance = {:.2g} }}), cut the ends flat, or close it in a program such as MeshLab",
             place(hole), hole.off_plane, diameter(hole), share, 1.1 * share)});
    return;
  }
  std::stable_sort(holes.begin(), holes.end(), [](const Hole& a, const Hole& b) { return a.area > b.area; });
  if (surface.regions.empty()) surface.regions.assign(surface.cell_count(), 0);
  std::int32_t tag = surface.region_names.empty() ? 0 : surface.region_names.rbegin()->first;
  for (const std::int32_t used : surface.regions) tag = std::max(tag, used);
  for (std::size_t k = 0; k < holes.size(); ++k) {
    ++tag;
    surface.region_names[tag] = k == 0 ? "inlet" : (holes.size() == 2 ? "outlet" : fmt::format("outlet_{}", k));
    std::vector<TriangleCorners> cap;
    if (!is_flat(holes[k], flat_tolerance)) cap = fill_hole(surface.points, holes[k].corners, triangles_of(surface));
    if (cap.empty()) cap = ears(surface.points, holes[k].corners);
    for (const TriangleCorners& t : cap) {
      surface.add_cell(CellType::triangle, t);
      surface.regions.push_back(tag);
      if (!surface.source.empty()) surface.source.push_back(static_cast<std::uint32_t>(surface.cell_count() - 1));
    }
  }
}

Finding open_holes(const MeshData& surface) {
  const std::vector<Hole> holes = holes_of(surface);
  Finding finding{"open", 0, {}, ""};
  for (const Hole& hole : holes) finding.add(hole.corners.front());
  if (holes.empty()) return finding;
  finding.message = fmt::format(
      "holes: the surface is not closed, and has no inside; the first one is {}, with {} edges, and a point of each is "
      "named. Flat ends of a vessel are closed with --cap (cap = true), other holes in a program such as MeshLab or "
      "admesh",
      place(holes.front()), holes.front().corners.size());
  return finding;
}

}  // namespace dartcast
