// Replaces crossing triangles by others between points that stay. Each round takes out more around what still crosses.
#include "meshing/mend_crossings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "meshing/fill_hole.hpp"
#include "meshing/holes.hpp"
#include "surface/check_surface.hpp"
#include "surface/ears.hpp"
#include "surface/triangle_pairs.hpp"
#include "tracking/nearest_free.hpp"

namespace dartcast {
namespace {

/// The share of a surface's triangles that may be taken out in all: more are no few flaws.
constexpr double most_taken = 0.2;
/// The share of its triangles below which a part that a round cuts off goes, too.
constexpr double smallest_part = 0.02;

std::uint32_t source_of(const MeshData& surface, std::size_t c) {
  return surface.source.empty() ? static_cast<std::uint32_t>(c) : surface.source[c];
}

/// Marks of the triangles that cross others, and of those with a corner in common with them.
std::vector<std::uint8_t> marked(const std::vector<TriangleCorners>& triangles, std::size_t points,
                                 const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs) {
  std::vector<std::uint8_t> near(points, 0);
  for (const auto& [a, b] : pairs) {
    for (const std::uint32_t t : {a, b}) {
      for (const std::uint32_t p : triangles[t]) near[p] = 1;
    }
  }
  std::vector<std::uint8_t> marks;
  for (const TriangleCorners& t : triangles)
    marks.push_back(std::any_of(t.begin(), t.end(), [&](std::uint32_t p) { return near[p] != 0; }) ? 1 : 0);
  return marks;
}

/// The part of each triangle that is not marked, by edges; those that are get their own.
std::vector<std::uint32_t> parts_of(const std::vector<TriangleCorners>& triangles,
                                    const std::vector<std::uint8_t>& marks) {
  std::vector<std::uint32_t> parent(triangles.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> first;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; marks[t] == 0 && k < 3; ++k) {
      const auto edge = std::minmax(triangles[t][k], triangles[t][(k + 1) % 3]);
      const auto [at, added] = first.try_emplace({edge.first, edge.second}, t);
      if (!added) parent[root(t)] = root(at->second);
    }
  }
  for (std::uint32_t t = 0; t < triangles.size(); ++t) parent[t] = root(t);
  return parent;
}

/// Marks all triangles at points where the border of what is not marked meets itself: holes are then simple loops.
void mark_pinches(const std::vector<TriangleCorners>& triangles, std::size_t points, std::vector<std::uint8_t>& marks) {
  for (bool more = true; more;) {
    more = false;
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (std::size_t k = 0; marks[t] == 0 && k < 3; ++k) edges.insert({triangles[t][k], triangles[t][(k + 1) % 3]});
    }
    std::vector<std::uint8_t> border_edges(points, 0);
    for (const auto& [a, b] : edges) {
      if (!edges.contains({b, a}) && border_edges[a] < 2) ++border_edges[a];
    }
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const bool pinched =
          std::any_of(triangles[t].begin(), triangles[t].end(), [&](std::uint32_t p) { return border_edges[p] == 2; });
      if (marks[t] != 0 || !pinched) continue;
      marks[t] = 1;
      more = true;
    }
  }
}

/// Marks small parts of a surface that the marked triangles cut off from the rest.
void mark_small_parts(const std::vector<TriangleCorners>& triangles, std::vector<std::uint8_t>& marks) {
  const std::vector<std::uint32_t> before = parts_of(triangles, std::vector<std::uint8_t>(triangles.size(), 0));
  const std::vector<std::uint32_t> after = parts_of(triangles, marks);
  std::map<std::uint32_t, std::size_t> whole;
  std::map<std::uint32_t, std::size_t> size;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    ++whole[before[t]];
    ++size[after[t]];
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (static_cast<double>(size[after[t]]) < smallest_part * static_cast<double>(whole[before[t]])) marks[t] = 1;
  }
}

/// The surface without the marked triangles, and with its holes closed. New triangles have the region of the first one
/// that was taken out.
MeshData with_holes_closed(const MeshData& surface, const std::vector<std::uint8_t>& marks) {
  MeshData out;
  out.points = surface.points;
  out.region_names = surface.region_names;
  std::int32_t region = 0;
  for (std::size_t c = surface.cell_count(); c-- > 0;) {
    if (marks[c] != 0 && !surface.regions.empty()) region = surface.regions[c];
  }
  const auto add = [&](std::span<const std::uint32_t> corners, std::uint32_t source, std::int32_t of) {
    out.add_cell(CellType::triangle, corners);
    out.source.push_back(source);
    if (!surface.regions.empty()) out.regions.push_back(of);
  };
  std::uint32_t taken = 0;
  for (std::size_t c = 0; c < surface.cell_count(); ++c) {
    const std::uint32_t source = source_of(surface, c);
    if (marks[c] == 0)
      add(surface.cell(c), source, surface.regions.empty() ? 0 : surface.regions[c]);
    else
      taken = source;
  }
  const std::vector<TriangleCorners> around = triangles_of(out);
  for (const Hole& hole : holes_of(out)) {
    std::vector<TriangleCorners> fill = fill_hole(out.points, hole.corners, around);
    if (fill.empty()) fill = ears(out.points, hole.corners);
    for (const TriangleCorners& t : fill) add(t, taken, region);
  }
  return out;
}

/// The greatest distance of the triangles in `from` that `to` has not, from the triangles in `to`.
double distance(const MeshData& from, const MeshData& to) {
  std::vector<TriangleCorners> others = triangles_of(to);
  std::vector<TriangleCorners> sorted = others;
  std::sort(sorted.begin(), sorted.end());
  double greatest = 0.0;
  for (const TriangleCorners& t : triangles_of(from)) {
    if (std::binary_search(sorted.begin(), sorted.end(), t)) continue;
    const Vec3 a = from.points[t[0]], b = from.points[t[1]], c = from.points[t[2]];
    for (const Vec3& x : {a, b, c, (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5, (a + b + c) * (1.0 / 3.0)}) {
      double least = std::numeric_limits<double>::infinity();
      for (const TriangleCorners& o : others)
        least = std::min(least, norm(x - closest_on_triangle(to.points[o[0]], to.points[o[1]], to.points[o[2]], x)));
      greatest = std::max(greatest, least);
    }
  }
  return greatest;
}

}  // namespace

void mend_crossings(MeshData& surface, MeshReport& report) {
  constexpr std::size_t most_crossings = 10000;
  MeshData mended = surface;
  Finding taken{"crossings", 0, {}, ""};
  for (unsigned round = 0; round <= most_mendings; ++round) {
    const std::vector<TriangleCorners> triangles = triangles_of(mended);
    const auto pairs = crossing_pairs(mended.points, triangles, most_crossings);
    if (pairs.empty()) {
      if (taken.count == 0) return;
      taken.message = fmt::format(
          "triangles, those that cross others and those around them, were taken out and the holes closed; the greatest "
          "distance between the old surface and the new one is {:.3g} in the unit of the file",
          std::max(distance(surface, mended), distance(mended, surface)));
      report.repairs.push_back(std::move(taken));
      surface = std::move(mended);
      return;
    }
    std::vector<std::uint8_t> marks = marked(triangles, mended.points.size(), pairs);
    mark_small_parts(triangles, marks);
    mark_pinches(triangles, mended.points.size(), marks);
    for (std::size_t t = 0; t < marks.size(); ++t) {
      if (marks[t] != 0) taken.add(source_of(mended, t));
    }
    if (pairs.size() == most_crossings ||
        static_cast<double>(taken.count) > most_taken * static_cast<double>(surface.cell_count()))
      return;
    mended = with_holes_closed(mended, marks);
    MeshData checked = mended;
    if (!check_and_repair_surface(checked).valid() || !holes_of(checked).empty()) return;
  }
}

}  // namespace dartcast
