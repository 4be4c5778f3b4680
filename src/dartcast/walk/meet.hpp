// From a walk that ended at a wall to a contact record.
#pragma once

#include <algorithm>

#include "dartcast/walk/contact.hpp"
#include "dartcast/walk/ride.hpp"

namespace dartcast::detail {

/// The corners of the wall facet's simplex that span the feature in whose interior the segment meets the wall.
template <class Positions>
unsigned zeros_at_wall(const Space<Positions>& space, const Walk& w, const Vec3& p, const Vec3& q) {
  const Corners v = space.corners(w.wall_simplex);
  if (w.at_start) return zeros_of(v, p);
  if (w.at_end) return zeros_of(v, q);
  unsigned zeros = 1U << w.wall_facet;
  for (unsigned i = 0; i < 4; ++i) {
    if (i == w.wall_facet) continue;
    // On the side of the facet opposite to corner i, if the segment meets that side's line.
    const auto& e = side_edge[w.wall_facet][i];
    if (orient3d(v[e[0]], v[e[1]], p, q) == Sign::zero) zeros |= 1U << i;
  }
  return zeros;
}

/// Where on the segment the wall is met.
template <class Positions>
double fraction_at_wall(const Space<Positions>& space, const Walk& w, const Vec3& p, const Vec3& q) {
  if (w.at_start) return 0.0;
  if (w.at_end) return 1.0;
  const Corners v = space.corners(w.wall_simplex);
  const auto& f = facet_corners[w.wall_facet];
  const double before = orient3d_value(v[f[0]], v[f[1]], v[f[2]], p);
  const double after = orient3d_value(v[f[0]], v[f[1]], v[f[2]], q);
  return std::clamp(before / (before - after), 0.0, 1.0);
}

/// Adds every wall triangle that meets at the feature, the one that was hit first; a plane face's triangles count as
/// one.
template <class Positions>
void add_walls(const Space<Positions>& space, const Walk& w, const Feature& feature, ContactList& list) {
  const std::size_t first = list.walls.size();
  const auto add = [&](SimplexId id, unsigned facet) {
    const CellView cell = space.map->view(id.cell);
    const Across across = cell.shape().simplices()[id.simplex].across[facet];
    WallHit hit;
    hit.face = {id.cell, across.face()};
    hit.triangle = across.place;
    hit.patch = space.map->patch(hit.face);
    hit.normal = wall_plane(space, id, facet).normal;
    const bool known =
        std::any_of(list.walls.begin() + static_cast<std::ptrdiff_t>(first), list.walls.end(), [&](const WallHit& h) {
          constexpr double same_plane =
              1.0 - 1e-14;  // unit normals, rounded: only which triangles are listed depends on it
          return h.face == hit.face && dot(h.normal, hit.normal) > same_plane;
        });
    if (!known) list.walls.push_back(hit);
  };
  add(w.wall_simplex, w.wall_facet);
  if (feature.count == 3) return;
  search_star(
      *space.map, w.wall_simplex, feature, [](SimplexId, const CellView&, const ImplicitSimplex&) { return true; },
      [&](SimplexId id, const CellView&, const ImplicitSimplex&, unsigned facet) {
        add(id, facet);
        return true;
      });
}

/// Displacement over the whole step of the wall's material point nearest to x: the triangle's corners' displacements,
/// weighted by x's barycentric coordinates in it.
inline Vec3 wall_displacement(const Complex& complex, SimplexId simplex, unsigned facet, const WallPlane& plane,
                              const Vec3& x) {
  const auto vertices = complex.vertices(simplex);
  const std::array<Vec3, 3> corner = {plane.a, plane.b, plane.c};
  std::array<double, 3> weight{};
  double sum = 0.0;
  for (unsigned i = 0; i < 3; ++i) {
    const Vec3& b = corner[(i + 1) % 3];
    const Vec3& c = corner[(i + 2) % 3];
    weight[i] = std::max(0.0, dot(plane.normal, cross(b - x, c - x)));
    sum += weight[i];
  }
  Vec3 result;
  for (unsigned i = 0; i < 3; ++i) {
    const std::uint32_t v = vertices[facet_corners[facet][i]].value;
    const Vec3 moved = complex.positions()[v] - complex.previous_positions()[v];
    if (!is_finite(moved)) continue;  // the move has mended a vertex that was not finite
    result += moved * (sum > 0.0 ? weight[i] / sum : 1.0 / 3.0);
  }
  return result;
}

/// Fills the parts of a contact that the geometry gives: kind, dart, walls, point, and the fraction of the segment.
template <class Positions>
double describe_contact(const Space<Positions>& space, const Walk& w, const Vec3& p, const Vec3& q, Contact& contact,
                        ContactList& list) {
  const CellView cell = space.map->view(w.wall_simplex.cell);
  const ImplicitSimplex& s = cell.shape().simplices()[w.wall_simplex.simplex];
  const unsigned zeros = zeros_at_wall(space, w, p, q);
  std::array<std::uint16_t, 4> points{};
  std::size_t count = 0;
  for (unsigned i = 0; i < 4; ++i) {
    if (((zeros >> i) & 1U) == 0) points[count++] = s.vertex[i];
  }
  const auto feature = cell.shape().feature(std::span<const std::uint16_t>(points.data(), count));
  contact.kind = feature.kind;
  contact.dart = {w.wall_simplex.cell, feature.dart};
  contact.first_wall = static_cast<std::uint32_t>(list.walls.size());
  add_walls(space, w, feature_of(cell, s, zeros), list);
  contact.wall_count = static_cast<std::uint32_t>(list.walls.size()) - contact.first_wall;
  const double t = fraction_at_wall(space, w, p, q);
  contact.point = w.at_start ? p : w.at_end ? q : flushed(p + (q - p) * t);
  return t;
}

}  // namespace dartcast::detail
