// From a walk that ended at a wall to a contact record.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "dartcast/contact.hpp"
#include "tracking/carry.hpp"
#include "tracking/step_state.hpp"

namespace dartcast::detail {

/// A determinant of three differences of stored doubles, computed in doubles, and its permanent. After Shewchuk, the
/// error is at most a sixth of determinant_error (dartcast/predicates.hpp) times the permanent.
struct Determinant {
  double value;
  double permanent;

  Determinant(const Vec3& u, const Vec3& v, const Vec3& w)
      : value(dot(u, cross(v, w))),
        permanent(std::abs(u.x) * (std::abs(v.y * w.z) + std::abs(v.z * w.y)) +
                  std::abs(u.y) * (std::abs(v.z * w.x) + std::abs(v.x * w.z)) +
                  std::abs(u.z) * (std::abs(v.x * w.y) + std::abs(v.y * w.x))) {}

  static constexpr double error = determinant_error / 6.0;
  static constexpr double smallest_permanent = 0x1p-700;  // covers products that underflow, as filter_applies() does
  static constexpr double for_fraction = 0x1p+42;         // errors: the accuracy that a time of impact needs

  /// Whether the value exceeds `times` its error.
  [[nodiscard]] bool exceeds(double times) const {
    return permanent >= smallest_permanent && std::abs(value) > times * error * permanent;
  }
};

/// How a segment from p, in front of a wall's facet, to q, beyond it, passes the facet. N: as for Space.
template <std::size_t N>
class SegmentHit;

/// A triangle. All differences are to p.
template <>
class SegmentHit<4> {
 public:
  SegmentHit(const WallPlane& w, const Vec3& p, const Vec3& q)
      : wall_(w),
        p_(p),
        q_(q),
        height_(w.a - p, w.c - p, w.b - p),
        sides_{Determinant(q - p, w.c - p, w.b - p), Determinant(q - p, w.a - p, w.c - p),
               Determinant(q - p, w.b - p, w.a - p)} {}

  /// Whether the line meets the side opposite to corner i of the triangle; exact.
  [[nodiscard]] bool meets_side(unsigned i) const {
    if (sides_[i].exceeds(1.0)) return false;
    const std::array<Vec3, 3> corner = {wall_.a, wall_.b, wall_.c};
    return orient3d_exact(corner[(i + 1) % 3], corner[(i + 2) % 3], p_, q_) == Sign::zero;
  }

  /// The fraction of the segment at the wall, with a relative error of at most 2^-40. The sum of the sides'
  /// determinants is the difference of the heights of p and q.
  [[nodiscard]] double fraction() const {
    constexpr double enough = Determinant::for_fraction;
    const double before = height_.exceeds(enough) ? height_.value : orient3d_value(wall_.a, wall_.b, wall_.c, p_);
    double whole = sides_[0].value + sides_[1].value + sides_[2].value;
    const double permanent = sides_[0].permanent + sides_[1].permanent + sides_[2].permanent;
    if (!(permanent >= Determinant::smallest_permanent && std::abs(whole) > enough * Determinant::error * permanent))
      whole = before - orient3d_value(wall_.a, wall_.b, wall_.c, q_);
    return std::clamp(before / whole, 0.0, 1.0);
  }

 private:
  const WallPlane& wall_;
  const Vec3& p_;
  const Vec3& q_;
  Determinant height_;
  std::array<Determinant, 3> sides_;
};

/// An edge: its sides are its ends.
template <>
class SegmentHit<3> {
 public:
  SegmentHit(const WallPlane& w, const Vec3& p, const Vec3& q) : wall_(w), p_(p), q_(q) {}

  /// Whether the line meets the end opposite to corner i of the edge; exact.
  [[nodiscard]] bool meets_side(unsigned i) const { return orient2d(p_, q_, i == 0 ? wall_.b : wall_.a) == Sign::zero; }

  /// As above.
  [[nodiscard]] double fraction() const {
    const double before = orient2d_value(wall_.a, wall_.b, p_);
    return std::clamp(before / (before - orient2d_value(wall_.a, wall_.b, q_)), 0.0, 1.0);
  }

 private:
  const WallPlane& wall_;
  const Vec3& p_;
  const Vec3& q_;
};

/// The wall behind a facet.
inline WallHit wall_hit(const CombinatorialMap& map, SimplexId id, const CellView& cell, unsigned facet,
                        const Vec3& normal) {
  const Across across = cell.shape().simplices()[id.simplex].across[facet];
  const CellFace face = {id.cell, across.face()};
  return {face, across.place, map.patch(face), normal};
}

/// Adds the other wall triangles that meet at an edge or a vertex. The triangles of a flat face count as one. Returns
/// whether all of them have normals. Precondition: the triangle that was hit is the last of the list.
template <class Positions, std::size_t N>
bool add_other_walls(const Space<Positions, N>& space, const Walk& w, const Feature& feature, ContactList& list) {
  const auto first = static_cast<std::ptrdiff_t>(list.walls.size()) - 1;
  bool all_have_normals = true;
  search_walls<N>(*space.map, w.wall_simplex, feature,
                  [&](SimplexId id, const CellView& cell, const ImplicitSimplex& s, unsigned facet) {
                    if (id == w.wall_simplex && facet == w.wall_facet) return true;
                    const CellFace face = {id.cell, s.across[facet].face()};
                    const Vec3 normal = facet_normal(space.corners(cell, s), facet);
                    all_have_normals &= normal != Vec3{};
                    const bool known = std::any_of(list.walls.begin() + first, list.walls.end(), [&](const WallHit& h) {
                      constexpr double same_plane =
                          1.0 - 1e-14;  // unit normals, rounded: only which triangles are listed depends on it
                      return h.face == face && dot(h.normal, normal) > same_plane;
                    });
                    if (!known) list.walls.push_back(wall_hit(*space.map, id, cell, facet, normal));
                    return true;
                  });
  return all_have_normals;
}

/// Gives walls of a contact that have no normal of their own the one that dartcast/contact.hpp says. `motion`: not 0.
[[gnu::cold]] inline void complete_normals(std::span<WallHit> walls, const Vec3& motion) {
  const auto has_normal = [](const WallHit& wall) { return wall.normal != Vec3{}; };
  const auto known = std::find_if(walls.begin(), walls.end(), has_normal);
  const Vec3 normal = known != walls.end() ? known->normal : unit_of(motion) * -1.0;
  for (WallHit& wall : walls) {
    if (!has_normal(wall)) wall.normal = normal;
  }
}

/// The barycentric coordinates in a wall's facet of the point nearest to x, up to a factor; none is negative.
inline std::array<double, 3> weights_in(const Corners&, const WallPlane& plane, const Vec3& x) {
  const std::array<Vec3, 3> corner = {plane.a, plane.b, plane.c};
  std::array<double, 3> weight{};
  for (unsigned i = 0; i < 3; ++i) {
    const Vec3& b = corner[(i + 1) % 3];
    const Vec3& c = corner[(i + 2) % 3];
    weight[i] = std::max(0.0, dot(plane.normal, cross(b - x, c - x)));
  }
  return weight;
}
inline std::array<double, 2> weights_in(const PlaneCorners&, const WallPlane& line, const Vec3& x) {
  const Vec3 along = line.b - line.a;
  return {std::max(0.0, dot(along, line.b - x)), std::max(0.0, dot(along, x - line.a))};
}

/// Displacement over the whole step of the wall's material point nearest to x: the facet's corners' displacements,
/// weighted by x's barycentric coordinates in it. `v`: of the simplex.
template <std::size_t N>
Vec3 wall_displacement(const CellComplex& complex, SimplexId simplex, unsigned facet, const std::array<Vec3, N>& v,
                       const WallPlane& plane, const Vec3& x) {
  const auto vertices = complex.vertices(simplex);
  const std::array<double, N - 1> weight = weights_in(v, plane, x);
  double sum = 0.0;
  for (const double w : weight) sum += w;
  const bool known = sum > 0.0 && std::isfinite(sum);  // a corner far beyond the range makes it infinite
  Vec3 result;
  for (unsigned i = 0; i < N - 1; ++i) {
    const std::uint32_t vertex = vertices[facet_corner<N>(facet, i)].value;
    const Vec3& before = complex.previous_positions()[vertex];
    const Vec3& now = complex.positions()[vertex];
    // A vertex that comes from out of range, or goes there, does not move the wall.
    if (!in_exact_range(before) || !in_exact_range(now)) continue;
    Vec3 moved = now - before;
    if constexpr (N == 3) moved.z = 0.0;  // as Space::corners()
    result += moved * (known ? weight[i] / sum : 1.0 / (N - 1.0));
  }
  return result;
}

/// The cell of the map that holds the points of a simplex in whose interior a point with these zero facets lies.
template <std::size_t N>
Shape::Feature map_feature(const Shape& shape, std::uint16_t simplex, unsigned wall_facet, unsigned zeros) {
  const ImplicitSimplex& s = shape.simplices()[simplex];
  if (zeros == 1U << wall_facet)  // inside the facet
    return {static_cast<Kind>(N - 2), shape.first_dart(s.across[wall_facet].face())};
  std::array<std::uint16_t, N> points{};
  std::size_t count = 0;
  for (unsigned i = 0; i < N; ++i) {  // without branches, which would mispredict
    points[count] = s.vertex[i];
    count += ((zeros >> i) & 1U) == 0 ? 1U : 0U;
  }
  return shape.feature(std::span<const std::uint16_t>(points.data(), count));
}

/// For a walk that ends on a wall: the facets of the wall's simplex that q lies on. They hold the feature that q lies
/// on in the last simplex of the walk. No coordinate is read.
template <std::size_t N>
unsigned zeros_at_end(const CombinatorialMap& map, const Walk& w) {
  if (w.simplex == w.wall_simplex) return w.zeros;
  const CellView last = map.view(w.simplex.cell);
  const CellView cell = map.view(w.wall_simplex.cell);
  const Feature feature = feature_of<N>(last, last.shape().simplices()[w.simplex.simplex], w.zeros);
  return facets_holding<N>(feature, cell, cell.shape().simplices()[w.wall_simplex.simplex]);
}

/// Where a walk meets a wall: the fraction of the segment, and a bit for each facet that the point lies on. Bit i is
/// for the facet opposite to corner i of the wall's simplex.
struct ContactGeometry {
  double fraction;
  unsigned zeros;
};
template <std::size_t N>
ContactGeometry contact_geometry(const CombinatorialMap& map, const std::array<Vec3, N>& v, const WallPlane& wall,
                                 const Walk& w, const Vec3& p, const Vec3& q) {
  if (w.at_start) return {0.0, zeros_of(v, p)};
  if (w.at_end) return {1.0, zeros_at_end<N>(map, w)};
  const SegmentHit<N> hit(wall, p, q);
  unsigned zeros = 1U << w.wall_facet;
  for (unsigned i = 0; i < N - 1; ++i) zeros |= hit.meets_side(i) ? 1U << facet_corner<N>(w.wall_facet, i) : 0U;
  return {hit.fraction(), zeros};
}

/// Fills the parts of a contact that the geometry gives: kind, dart, walls, point. Returns the fraction of the segment.
/// `v`, `wall`: the corners of the simplex at the wall, and the plane of the facet met.
template <class Positions, std::size_t N>
double describe_contact(const Space<Positions, N>& space, const Walk& w, const std::array<Vec3, N>& v,
                        const WallPlane& wall, const Vec3& p, const Vec3& q, Contact& contact, ContactList& list) {
  const CellView cell = space.map->view(w.wall_simplex.cell);
  const ImplicitSimplex& s = cell.shape().simplices()[w.wall_simplex.simplex];
  const auto [t, zeros] = contact_geometry(*space.map, v, wall, w, p, q);
  const Shape::Feature feature = map_feature<N>(cell.shape(), w.wall_simplex.simplex, w.wall_facet, zeros);
  contact.kind = feature.kind;
  contact.dart = {w.wall_simplex.cell, feature.dart};
  contact.first_wall = static_cast<std::uint32_t>(list.walls.size());
  list.walls.push_back(wall_hit(*space.map, w.wall_simplex, cell, w.wall_facet, wall.normal));
  bool all_have_normals = wall.normal != Vec3{};
  if (zeros != 1U << w.wall_facet) all_have_normals &= add_other_walls(space, w, feature_of<N>(cell, s, zeros), list);
  if (!all_have_normals) complete_normals(std::span(list.walls).subspan(contact.first_wall), q - p);
  contact.wall_count = static_cast<std::uint32_t>(list.walls.size()) - contact.first_wall;
  contact.point = w.at_start ? p : w.at_end ? q : flushed(p + (q - p) * t);
  return t;
}

/// The same from an impact that has been computed.
inline void describe_impact(const CombinatorialMap& map, const Walk& w, const WallImpact& impact, Contact& contact,
                            ContactList& list) {
  const CellView cell = map.view(w.wall_simplex.cell);
  contact.first_wall = static_cast<std::uint32_t>(list.walls.size());
  contact.wall_count = 1;
  list.walls.push_back(wall_hit(map, w.wall_simplex, cell, w.wall_facet, impact.normal));
  const CellFace face = list.walls.back().face;
  contact.kind = static_cast<Kind>(map.dimension() - 1);
  contact.dart = {face.cell, cell.shape().first_dart(face.face)};
  contact.point = impact.point;
  contact.wall_displacement = impact.wall_displacement;
}

}  // namespace dartcast::detail
