#include "oracle/oracle.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <deque>
#include <optional>

#include "complex/simplex.hpp"
#include "oracle/fraction.hpp"

namespace dartcast::oracle {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const auto point = [](const Vec3& p) { return Kernel::Point_3(p.x, p.y, p.z); };
  return static_cast<int>(CGAL::orientation(point(a), point(b), point(c), point(d)));
}

using Corners = std::array<Vec3, 3>;

// Where a segment touches a triangle: the first time, and which edges (from corner i to the next) hold the point.
struct Meeting {
  Fraction time;
  std::array<bool, 3> on_edge;
};

// The segment's ends are not both in the plane, and not strictly on the same side.
std::optional<Meeting> meet_across(const Corners& t, const Vec3& p, const Vec3& q) {
  std::array<int, 3> side{};
  for (std::size_t i = 0; i < 3; ++i) side[i] = orientation(t[i], t[(i + 1) % 3], p, q);
  const auto [least, most] = std::minmax_element(side.begin(), side.end());
  if (*least < 0 && *most > 0) return std::nullopt;
  const Exact at_p = determinant(t[0], t[1], t[2], p);
  const Exact at_q = determinant(t[0], t[1], t[2], q);
  return Meeting{Fraction(at_p, at_p - at_q), {side[0] == 0, side[1] == 0, side[2] == 0}};
}

// The whole segment lies in the triangle's plane. The functions that vanish on its edges and are positive inside: with
// a fourth point above the plane, det[edge, above, x].
std::optional<Meeting> meet_in_plane(const Corners& t, const Vec3& p, const Vec3& q) {
  const Vec3 size = Box::around({t[0], t[1], t[2]}).high - Box::around({t[0], t[1], t[2]}).low;
  const double step = std::max({size.x, size.y, size.z});
  Vec3 above;
  int sign = 0;
  for (const Vec3& d : {Vec3{step, 0, 0}, Vec3{0, step, 0}, Vec3{0, 0, step}}) {
    above = t[0] + d;
    sign = orientation(t[0], t[1], t[2], above);
    if (sign != 0) break;
  }
  std::array<Linear, 3> side;
  Clip clip;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto at = [&](const Vec3& x) {
      const Exact d = determinant(t[i], t[(i + 1) % 3], x, above);
      return sign > 0 ? d : -d;
    };
    side[i] = {at(p), at(q)};
    clip.keep_non_negative(side[i]);
  }
  if (clip.empty()) return std::nullopt;
  Meeting m{clip.first(), {}};
  for (std::size_t i = 0; i < 3; ++i) m.on_edge[i] = side[i].sign_at(clip.first()) == 0;
  return m;
}

// The feature of the mesh at a point of a wall: a corner where two edges meet, an edge, or the face (including
// diagonals of its fan).
int dimension_of(const WallTriangle& wall, const std::array<bool, 3>& on_edge, std::size_t mesh_point_count) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (on_edge[i] && on_edge[(i + 2) % 3]) return wall.vertex[i] < mesh_point_count ? 0 : 2;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    if (on_edge[i]) return wall.mesh_edge[i] ? 1 : 2;
  }
  return 2;
}

struct TimedTouch {
  Touch touch;
  Fraction time;
  bool inside;  // of the triangle: on none of its edges
};

// Where a union of intervals that holds 0 ends.
Fraction reach(const std::vector<Clip>& intervals) {
  Fraction end(0);
  for (bool grown = true; grown;) {
    grown = false;
    for (const Clip& c : intervals) {
      if (!(end < c.first()) && end < c.last()) {
        end = c.last();
        grown = true;
      }
    }
  }
  return end;
}

}  // namespace

Oracle::Oracle(const MeshData& mesh, std::vector<Vec3> points, const InteriorVertices& interior)
    : triangulation_(mesh, interior), points_(std::move(points)) {
  std::vector<Box> boxes;
  for (const Simplex& s : triangulation_.simplices()) {
    boxes.push_back(
        Box::around({points_[s.vertex[0]], points_[s.vertex[1]], points_[s.vertex[2]], points_[s.vertex[3]]}));
  }
  simplex_grid_ = BoxGrid(std::move(boxes));
  boxes.clear();
  for (const WallTriangle& w : triangulation_.walls()) {
    boxes.push_back(Box::around({points_[w.vertex[0]], points_[w.vertex[1]], points_[w.vertex[2]]}));
  }
  wall_grid_ = BoxGrid(std::move(boxes));
}

// Sign of the volume with q in the place of one vertex.
int Oracle::facet_sign(const Simplex& s, std::size_t opposite, const Vec3& q) const {
  std::array<Vec3, 4> corner{};
  for (std::size_t i = 0; i < 4; ++i) corner[i] = i == opposite ? q : points_[s.vertex[i]];
  return orientation(corner[0], corner[1], corner[2], corner[3]);
}

int Oracle::volume_sign(std::uint32_t simplex) const {
  const Simplex& s = triangulation_.simplices()[simplex];
  return facet_sign(s, 0, points_[s.vertex[0]]);
}

bool Oracle::all_positive(bool free_only) const {
  for (std::uint32_t s = 0; s < triangulation_.simplices().size(); ++s) {
    if (free_only && !triangulation_.is_free(triangulation_.simplices()[s].cell)) continue;
    if (volume_sign(s) <= 0) return false;
  }
  return true;
}

bool Oracle::contains(std::uint32_t simplex, const Vec3& q) const {
  const Simplex& s = triangulation_.simplices()[simplex];
  for (std::size_t i = 0; i < 4; ++i) {
    if (facet_sign(s, i, q) < 0) return false;
  }
  return true;
}

std::vector<std::uint32_t> Oracle::all_containing(const Vec3& q, bool free_only) const {
  std::vector<std::uint32_t> found;
  simplex_grid_.each_overlapping(Box::around({q}), [&](std::uint32_t s) {
    if (free_only && !triangulation_.is_free(triangulation_.simplices()[s].cell)) return;
    if (contains(s, q)) found.push_back(s);
  });
  return found;
}

Oracle::Passed Oracle::passed(std::uint32_t simplex, const Vec3& p, const Vec3& q) const {
  const Simplex& s = triangulation_.simplices()[simplex];
  Clip clip;
  bool inside = true;
  for (std::size_t i = 0; i < 4; ++i) {
    std::array<Vec3, 4> corner{};
    for (std::size_t k = 0; k < 4; ++k) corner[k] = points_[s.vertex[k]];
    const auto at = [&](const Vec3& x) {
      corner[i] = x;
      return determinant(corner[0], corner[1], corner[2], corner[3]);
    };
    const Linear side{at(p), at(q)};
    inside = inside && (CGAL::sign(side.at_p) != 0 || CGAL::sign(side.at_q) != 0);
    clip.keep_non_negative(side);
  }
  if (clip.empty()) return {};
  return {clip.first().rounded(), clip.last().rounded(), inside};
}

int Oracle::dimension_at(std::uint32_t simplex, const Vec3& q) const {
  const Simplex& s = triangulation_.simplices()[simplex];
  std::vector<std::uint32_t> around;
  for (std::size_t i = 0; i < 4; ++i) {
    if (facet_sign(s, i, q) != 0) around.push_back(s.vertex[i]);
  }
  return triangulation_.dimension(s.cell, around);
}

std::vector<std::uint32_t> Oracle::walls_at(const Vec3& q) const {
  std::vector<std::uint32_t> found;
  wall_grid_.each_overlapping(Box::around({q}), [&](std::uint32_t w) {
    const auto& v = triangulation_.walls()[w].vertex;
    const Corners t = {points_[v[0]], points_[v[1]], points_[v[2]]};
    if (orientation(t[0], t[1], t[2], q) == 0 && meet_in_plane(t, q, q)) found.push_back(w);
  });
  return found;
}

Trace Oracle::trace(const Vec3& p, const Vec3& q) const {
  const Box box = Box::around({p, q});
  std::vector<TimedTouch> touched;
  wall_grid_.each_overlapping(box, [&](std::uint32_t w) {
    const WallTriangle& wall = triangulation_.walls()[w];
    const Corners t = {points_[wall.vertex[0]], points_[wall.vertex[1]], points_[wall.vertex[2]]};
    const int from = orientation(t[0], t[1], t[2], p);
    const int to = orientation(t[0], t[1], t[2], q);
    if (from * to > 0) return;
    const auto meeting = from == 0 && to == 0 ? meet_in_plane(t, p, q) : meet_across(t, p, q);
    if (!meeting) return;
    const auto& on = meeting->on_edge;
    const int dimension = dimension_of(wall, on, triangulation_.mesh_point_count());
    touched.push_back(
        {{w, meeting->time.rounded(), 0, dimension, from, to}, meeting->time, !on[0] && !on[1] && !on[2]});
  });
  Trace trace;
  if (touched.empty()) return trace;
  std::stable_sort(touched.begin(), touched.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
  for (std::size_t i = 0; i < touched.size(); ++i) {
    if (i > 0) touched[i].touch.rank = touched[i - 1].touch.rank + (touched[i - 1].time < touched[i].time ? 1 : 0);
    trace.touches.push_back(touched[i].touch);
  }
  const bool alone = touched.size() == 1 || touched[0].time < touched[1].time;
  if (alone && touched[0].inside && touched[0].touch.passes_out()) {  // the usual case, which needs no simplices
    trace.leaves = true;
    trace.exit_time = touched[0].touch.time;
    return trace;
  }
  std::vector<Clip> inside;
  simplex_grid_.each_overlapping(box, [&](std::uint32_t index) {
    const Simplex& s = triangulation_.simplices()[index];
    if (!triangulation_.is_free(s.cell)) return;
    for (std::size_t i = 0; i < 4; ++i) {
      if (facet_sign(s, i, p) < 0 && facet_sign(s, i, q) < 0) return;
    }
    Clip clip;
    for (std::size_t i = 0; i < 4 && !clip.empty(); ++i) {
      const auto at = [&](const Vec3& x) {
        std::array<Vec3, 4> corner{};
        for (std::size_t k = 0; k < 4; ++k) corner[k] = k == i ? x : points_[s.vertex[k]];
        return determinant(corner[0], corner[1], corner[2], corner[3]);
      };
      if (facet_sign(s, i, p) < 0 || facet_sign(s, i, q) < 0) clip.keep_non_negative({at(p), at(q)});
    }
    if (!clip.empty()) inside.push_back(clip);
  });
  const Fraction end = reach(inside);
  trace.leaves = end < Fraction(1);
  trace.exit_time = end.rounded();
  for (const TimedTouch& t : touched) {
    if (!(end < t.time)) trace.exit_rank = t.touch.rank;
  }
  return trace;
}

bool Oracle::can_start(std::uint32_t simplex, const Vec3& p, const Vec3& q) const {
  std::vector<std::uint32_t> seen = {simplex};
  for (std::size_t next = 0; next < seen.size(); ++next) {
    const Simplex& s = triangulation_.simplices()[seen[next]];
    bool blocked = false;
    for (std::size_t i = 0; i < 4; ++i) {
      if (facet_sign(s, i, p) != 0) continue;
      blocked = blocked || facet_sign(s, i, q) < 0;
      const std::uint32_t other = s.beyond[i];
      if (s.wall[i] == none && other != none && std::find(seen.begin(), seen.end(), other) == seen.end())
        seen.push_back(other);
    }
    if (!blocked) return true;
  }
  return false;
}

}  // namespace dartcast::oracle
