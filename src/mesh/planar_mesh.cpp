// Puts meshes into the plane, and finds boundary edges that lie against each other.
#include "mesh/planar_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <tuple>
#include <utility>

#include "dartcast/predicates.hpp"
#include "mesh/box_tree.hpp"

namespace dartcast {
namespace {

constexpr std::size_t pairs_an_edge = 200;

/// Order along any line.
bool before(const Vec3& p, const Vec3& q) { return std::tie(p.x, p.y) < std::tie(q.x, q.y); }

struct Segment {
  Vec3 low, high;
};

Segment segment_of(const MeshData& mesh, std::span<const std::uint32_t> edge) {
  const Vec3 &a = mesh.points[edge[0]], &b = mesh.points[edge[1]];
  return before(a, b) ? Segment{a, b} : Segment{b, a};
}

/// Whether an end of t lies inside s, or they are on one line with more than a point in common.
bool lies_against(const Segment& s, const Segment& t) {
  const bool low_on = orient2d(s.low, s.high, t.low) == Sign::zero;
  const bool high_on = orient2d(s.low, s.high, t.high) == Sign::zero;
  if (low_on && high_on) return before(s.low, t.high) && before(t.low, s.high);
  const auto inside = [&](const Vec3& p) { return before(s.low, p) && before(p, s.high); };
  return (low_on && inside(t.low)) || (high_on && inside(t.high));
}

}  // namespace

void put_in_plane(MeshData& mesh, const std::vector<std::uint32_t>& point_source, MeshReport& report) {
  const double z = mesh.points[0].z;
  const auto differs = std::find_if(mesh.points.begin(), mesh.points.end(), [&](const Vec3& p) { return p.z != z; });
  if (differs != mesh.points.end()) {
    Finding surface{"no_volume",
                    0,
                    {},
                    "a surface in space without volume cells: z is not the same everywhere; mesh the volume inside it, "
                    "or project it to the plane z = 0 first"};
    for (std::size_t c = 0; c < mesh.cell_count(); ++c) surface.add(mesh.source.empty() ? c : mesh.source[c]);
    add_finding(report.defects, surface);
    return;
  }
  for (Vec3& p : mesh.points) p.z = 0.0;
  if (z == 0.0) return;
  Finding moved{"plane", 0, {}, fmt::format("points of a planar mesh were at z = {}; they have been put to z = 0", z)};
  for (const std::uint32_t p : point_source) moved.add(p);
  add_finding(report.repairs, moved);
}

Conformity find_unmatched_edges(const MeshData& mesh, const BoundaryFaces& boundary) {
  std::vector<Segment> segments;
  std::vector<Box> boxes;
  for (std::size_t e = 0; e < boundary.size(); ++e) {
    segments.push_back(segment_of(mesh, boundary.face(e)));
    const Segment& s = segments.back();
    boxes.push_back(join({s.low, s.low}, {s.high, s.high}));
  }
  const BoxTree tree(boxes);
  Conformity out;
  std::vector<bool> marked(boundary.size(), false);
  std::size_t budget = pairs_an_edge * boundary.size() + 1000;
  for (std::uint32_t e = 0; e < boundary.size() && out.complete; ++e) {
    tree.query(boxes[e], [&](std::uint32_t f) {
      if (budget == 0) return out.complete = false;
      --budget;
      marked[e] = marked[e] || (f != e && lies_against(segments[e], segments[f]));
      return true;
    });
  }
  for (std::uint32_t e = 0; e < boundary.size(); ++e) {
    if (marked[e]) out.faces.push_back(e);
  }
  return out;
}

}  // namespace dartcast
