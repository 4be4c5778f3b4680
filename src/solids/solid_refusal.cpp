// Whether a solid may be where it is: its vertices, then its edges and triangles, then walls inside it. Then other solids.
#include "solids/solid_refusal.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "dartcast/predicates.hpp"
#include "dynamics/flat_cells.hpp"
#include "dynamics/near_walls.hpp"
#include "solids/audit_solids.hpp"
#include "solids/element_touches.hpp"
#include "surface/inside.hpp"

namespace dartcast {

namespace {

using Corners3 = std::array<Vec3, 3>;

Corners3 corners_of(const SolidElement& e, std::span<const Vec3> points) {
  return {points[e.vertex[0]], points[e.vertex[1]], points[e.vertex[2]]};
}

// Whether all corners of `a` are on one side of the plane of `b`.
bool on_one_side(const Corners3& a, const Corners3& b) {
  const Sign first = orient3d(b[0], b[1], b[2], a[0]);
  return first != Sign::zero && orient3d(b[0], b[1], b[2], a[1]) == first && orient3d(b[0], b[1], b[2], a[2]) == first;
}

MovingElement at_rest(const SolidElement& e, std::span<const Vec3> points) {
  MovingElement m;
  m.from = corners_of(e, points);
  m.to = m.from;
  m.count = e.count;
  return m;
}

// Whether each edge of the triangles has an even number of them.
bool is_closed(const std::vector<SurfaceTriangle>& triangles) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (const auto& t : triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [a, b] = std::minmax(t[i], t[(i + 1) % 3]);
      edges.push_back({a, b});
    }
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    while (end < edges.size() && edges[end] == edges[i]) ++end;
    if ((end - i) % 2 != 0) return false;
  }
  return !triangles.empty();
}

SolidPlacement refused(SolidRefusal why, const SolidElement& e) { return {why, 0xffffffffU, e.vertex, e.count}; }

VertexMotion walls_at_rest(const CellComplex& complex) { return {complex.positions(), complex.positions()}; }

// Whether an element meets a wall or reaches a flat cell.
SolidRefusal refusal_of(const CellComplex& complex, NearWalls& near, Cell cell, const SolidElement& e,
                        std::span<const Vec3> points) {
  const Corners3 corners = corners_of(e, points);
  for (const NearWall& w : near.search(complex, cell, at_rest(e, points), walls_at_rest(complex))) {
    const Corners3 wall = {flushed(w.corners.to[0]), flushed(w.corners.to[1]), flushed(w.corners.to[2])};
    if (!on_one_side(corners, wall) && audit_meet(corners, wall)) return SolidRefusal::meets_wall;
  }
  const bool flat = first_flat_time(complex, near.cells_reached(), walls_at_rest(complex)).has_value();
  return flat ? SolidRefusal::cell_not_positive : SolidRefusal::none;
}

std::vector<SurfaceTriangle> triangles_of(std::span<const SolidElement> elements) {
  std::vector<SurfaceTriangle> triangles;
  for (const SolidElement& e : elements) {
    if (e.count == 3) triangles.push_back(e.vertex);
  }
  return triangles;
}

// The first point that is inside a closed solid; none if there is none, or it is not closed.
std::optional<std::uint32_t> first_inside(std::span<const Vec3> points, const SolidShape& solid) {
  std::vector<SurfaceTriangle> triangles = triangles_of(solid.elements);
  if (!is_closed(triangles)) return {};
  const InsideTest test({solid.points.begin(), solid.points.end()}, std::move(triangles));
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (test.side(points[i]) == PointSide::inside) return i;
  }
  return {};
}

// Walls inside a closed solid touch nothing, so a search of its whole box looks for them.
bool encloses_wall(const CellComplex& complex, std::span<const Vec3> points, std::span<const SolidElement> elements,
                   std::span<const Cell> cells) {
  std::vector<SurfaceTriangle> triangles = triangles_of(elements);
  if (!is_closed(triangles)) return false;
  const std::uint32_t first = triangles[0][0];
  const InsideTest test({points.begin(), points.end()}, std::move(triangles));
  MovingElement box;
  box.from[0] = points[first];
  box.to[0] = box.from[0];
  double reach = 0.0;
  for (const Vec3& p : points) reach = std::max(reach, norm(p - box.from[0]));
  NearWalls near;
  for (const NearWall& w : near.search(complex, cells[first], box, walls_at_rest(complex), reach * (1.0 + 0x1p-20))) {
    const auto inside = [&](const Vec3& corner) { return test.side(corner) == PointSide::inside; };
    if (std::any_of(w.corners.to.begin(), w.corners.to.end(), inside)) return true;
  }
  return false;
}

}  // namespace

SolidPlacement find_refusal(const CellComplex& complex, std::span<const Vec3> points,
                            std::span<const SolidElement> elements, std::span<const Cell> cells) {
  for (std::uint32_t i = 0; i < cells.size(); ++i) {
    if (!cells[i].valid()) return refused(SolidRefusal::vertex_not_free, {{i}, 1});
  }
  NearWalls near;
  SolidPlacement flat;
  for (const SolidElement& e : elements) {
    const SolidRefusal why = refusal_of(complex, near, cells[e.vertex[0]], e, points);
    if (why == SolidRefusal::meets_wall) return refused(why, e);
    if (why != SolidRefusal::none) flat = refused(why, e);
  }
  if (encloses_wall(complex, points, elements, cells)) return refused(SolidRefusal::encloses_wall, elements.front());
  return flat;
}

SolidPlacement find_overlap(const SolidShape& solid, const SolidShape& other) {
  std::vector<Box> boxes(other.elements.size());
  std::transform(other.elements.begin(), other.elements.end(), boxes.begin(),
                 [&](const SolidElement& e) { return audit_box(corners_of(e, other.points)); });
  const BoxTree tree(std::move(boxes));
  for (const SolidElement& e : solid.elements) {
    const Corners3 corners = corners_of(e, solid.points);
    bool meets = false;
    tree.query(audit_box(corners), [&](std::size_t i) {
      const Corners3 others = corners_of(other.elements[i], other.points);
      meets = !on_one_side(corners, others) && audit_meet(corners, others);
      return !meets;
    });
    if (meets) return refused(SolidRefusal::meets_solid, e);
  }
  if (const auto inside = first_inside(solid.points, other))
    return refused(SolidRefusal::meets_solid, {{*inside, *inside, *inside}, 1});
  if (first_inside(other.points, solid)) return refused(SolidRefusal::meets_solid, solid.elements.front());
  return {};
}

}  // namespace dartcast
