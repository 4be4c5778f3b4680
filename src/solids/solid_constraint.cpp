// Constraints of contacts: weights of the place at the time of the touch, and a normal turned by the start of the step.
#include "solids/solid_constraint.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/elementary.hpp"
#include "dynamics/swept_sphere.hpp"
#include "solids/joint_move.hpp"

namespace dartcast {

namespace {

// Edges with a smaller sine than this between them have no useful normal of their own.
constexpr double parallel_sine = 0x1p-26;

using Points = std::array<Vec3, 3>;

Vec3 between(const Vec3& a, const Vec3& b, double t) { return a + (b - a) * t; }

Points solid_points(const ElementTouch& touch, const SolidMotion& motion, double t) {
  Points p;
  for (unsigned i = 0; i < touch.count; ++i)
    p[i] = between(motion.from[touch.vertices[i]], motion.to[touch.vertices[i]], t);
  return p;
}

Points wall_points(const ElementTouch& touch, double t) {
  Points p;
  for (unsigned i = 0; i < touch.wall_count; ++i)
    p[i] = between(touch.wall.corners.from[touch.corners[i]], touch.wall.corners.to[touch.corners[i]], t);
  return p;
}

Vec3 weighted(const std::array<double, 3>& weights, const Points& points) {
  return points[0] * weights[0] + points[1] * weights[1] + points[2] * weights[2];
}

Vec3 unit_or_zero(const Vec3& v) {
  const double length = hypotenuse(v.x, v.y, v.z);
  return length > 0.0 && std::isfinite(length) ? v * (1.0 / length) : Vec3{};
}

// Shares of the ends of two edges at their nearest points. The unit is a power of two, so that products of four lengths stay
// in the range of numbers.
std::pair<double, double> nearest_shares(const Points& a, const Points& b) {
  const double longest = std::max({norm(a[1] - a[0]), norm(b[1] - b[0]), norm(a[0] - b[0])});
  const double unit = longest > 0.0 ? std::ldexp(1.0, -std::ilogb(longest)) : 1.0;
  const Vec3 u = (a[1] - a[0]) * unit;
  const Vec3 v = (b[1] - b[0]) * unit;
  const Vec3 r = (a[0] - b[0]) * unit;
  const double uu = dot(u, u);
  const double uv = dot(u, v);
  const double vv = dot(v, v);
  const double apart = uu * vv - uv * uv;
  const auto share = [](double numerator, double denominator) {
    return denominator > 0.0 ? std::clamp(numerator / denominator, 0.0, 1.0) : 0.5;
  };
  const bool parallel = !(apart > parallel_sine * parallel_sine * (uu * vv));
  const double s = parallel ? 0.5 : share(uv * dot(v, r) - vv * dot(u, r), apart);
  const double t = share(uv * s + dot(v, r), vv);
  return {share(uv * t - dot(u, r), uu), t};
}

double longest_side(const Points& t) { return std::max({norm(t[1] - t[0]), norm(t[2] - t[1]), norm(t[0] - t[2])}); }

// The normal at the time of the touch; 0 if the parts have none.
Vec3 normal_at(const ElementTouch& touch, const Points& solid, const Points& wall) {
  const auto of_triangle = [](const Points& t) { return cross(t[1] - t[0], t[2] - t[0]); };
  switch (touch.kind) {
    case SolidContactKind::vertex_face: return unit_or_zero(of_triangle(wall));
    case SolidContactKind::face_vertex: return unit_or_zero(of_triangle(solid));
    case SolidContactKind::edge_edge: break;
  }
  const Vec3 u = unit_or_zero(solid[1] - solid[0]);
  const Vec3 v = unit_or_zero(wall[1] - wall[0]);
  const Vec3 n = cross(u, v);
  return norm(n) > parallel_sine ? unit_or_zero(n) : Vec3{};
}

Vec3 free_side(const MovingTriangle& t, double time) {
  const auto corner = [&](std::size_t i) { return between(t.from[i], t.to[i], time); };
  return unit_or_zero(cross(corner(2) - corner(0), corner(1) - corner(0)));
}

// The height of a wall triangle over the plane of another with an edge in common: its third corner's.
double height_over(const Vec3& normal, const Vec3& edge_point, const MovingTriangle& t, double time) {
  double height = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double h = dot(normal, between(t.from[i], t.to[i], time) - edge_point);
    if (std::abs(h) > std::abs(height)) height = h;
  }
  return height;
}

// Turns the normal of an edge-edge touch to be between those of the two wall triangles at the edge. If it is not, as at
// any edge that is not convex, the nearer of these takes its place. (Else a point that slides over the edges of a smooth
// wall would catch on each.)
void put_between_faces(SolidConstraint& c) {
  const ElementTouch& touch = c.touch;
  const Vec3 one = free_side(touch.wall.corners, touch.time);
  const Vec3 other = free_side(*touch.beside, touch.time);
  c.is_exit = dot(c.normal, one) < 0.0 && dot(c.normal, other) < 0.0;
  const Vec3 middle = unit_or_zero(one + other);
  if (c.is_exit || middle == Vec3{}) return;
  const bool convex = height_over(one, wall_points(touch, touch.time)[0], *touch.beside, touch.time) < 0.0;
  const bool is_between = convex && dot(c.normal, middle) >= dot(one, middle);
  if (!is_between) c.normal = dot(c.normal, one) >= dot(c.normal, other) ? one : other;
}

Vec3 place_in(const SolidConstraint& c, std::span<const Vec3> positions) {
  Vec3 place;
  for (unsigned i = 0; i < c.touch.count; ++i) place += positions[c.touch.vertices[i]] * c.weights[i];
  return place;
}

// If the parts have none, and lay on each other when the step began: the wall's, or else the one opposite to the motion.
Vec3 any_normal(const ElementTouch& touch, const SolidMotion& motion) {
  const Vec3 of_wall = free_side(touch.wall.corners, touch.time);
  if (of_wall != Vec3{}) return of_wall;
  const Vec3 against = unit_or_zero(solid_points(touch, motion, 0.0)[0] - solid_points(touch, motion, 1.0)[0]);
  return against != Vec3{} ? against : Vec3{0.0, 0.0, 1.0};
}

// The normal of parts that touch: along the given one, to the side at the start.
void choose_normal(SolidConstraint& c, const SolidMotion& motion, const Vec3& normal) {
  const ElementTouch& touch = c.touch;
  const Vec3 apart =
      weighted(c.weights, solid_points(touch, motion, 0.0)) - weighted(c.wall_weights, wall_points(touch, 0.0));
  c.normal = normal;
  const double side = dot(c.normal, apart);
  if (side == 0.0) c.normal = unit_or_zero(apart);
  if (side < 0.0) c.normal = -c.normal;
  if (touch.kind == SolidContactKind::vertex_face)
    c.is_exit = dot(c.normal, free_side(touch.wall.corners, touch.time)) < 0.0;
  if (touch.beside && c.normal != Vec3{}) put_between_faces(c);
  if (c.normal == Vec3{}) c.normal = any_normal(touch, motion);
}

}  // namespace

SolidConstraint constraint_of(const ElementTouch& touch, const SolidMotion& motion, double separation, double longest) {
  SolidConstraint c;
  c.touch = touch;
  const Points solid = solid_points(touch, motion, touch.time);
  const Points wall = wall_points(touch, touch.time);
  switch (touch.kind) {
    case SolidContactKind::vertex_face:
      c.weights = {1.0};
      c.wall_weights = nearest_on_triangle(wall, solid[0]).weights;
      break;
    case SolidContactKind::face_vertex:
      c.weights = nearest_on_triangle(solid, wall[0]).weights;
      c.wall_weights = {1.0};
      break;
    case SolidContactKind::edge_edge: {
      const auto [s, t] = nearest_shares(solid, wall);
      c.weights = {1.0 - s, s};
      c.wall_weights = {1.0 - t, t};
      break;
    }
  }
  const Vec3 near = weighted(c.weights, solid) - weighted(c.wall_weights, wall);
  c.is_apart = motion.margin > 0.0 && norm(near) > 0.5 * motion.margin;
  if (c.is_apart) c.normal = unit_or_zero(near);
  if (!c.is_apart) choose_normal(c, motion, normal_at(touch, solid, wall));
  c.wall_point = weighted(c.wall_weights, wall_points(touch, 1.0));
  const double side_of_wall = longest_side(touch.wall.corners.from);
  c.separation = separation > 0.0 ? separation
                                  : JointMoves::default_separation *
                                        (longest > 0.0 ? std::min(longest, side_of_wall) : side_of_wall);
  return c;
}

double gap_of(const SolidConstraint& c, std::span<const Vec3> targets) {
  return dot(c.normal, place_in(c, targets) - c.wall_point);
}

void satisfy(SolidConstraint& c, std::span<Vec3> targets, std::span<const double> inverse_masses) {
  double mobility = 0.0;
  for (unsigned i = 0; i < c.touch.count; ++i)
    mobility += c.weights[i] * c.weights[i] * inverse_masses[c.touch.vertices[i]];
  const double lack = c.separation - gap_of(c, targets);
  if (!(lack > 0.0) || !(mobility > 0.0)) return;
  c.pressed += lack;
  for (unsigned i = 0; i < c.touch.count; ++i) {
    const std::uint32_t v = c.touch.vertices[i];
    targets[v] += c.normal * (lack * c.weights[i] * inverse_masses[v] / mobility);
  }
}

SolidContact contact_of(const SolidConstraint& c, const CombinatorialMap& map, const SolidMotion& motion,
                        std::span<const Vec3> reached, double walls_made) {
  const NearWall& wall = c.touch.wall;
  SolidContact contact;
  contact.kind = c.touch.kind;
  contact.count = c.touch.count;
  contact.vertices = c.touch.vertices;
  contact.weights = c.weights;
  contact.face = wall.face;
  contact.triangle = wall.triangle;
  contact.patch = map.patch(wall.face);
  std::array<std::uint16_t, 3> local{};
  std::size_t corners = 0;
  for (unsigned i = 0; i < c.touch.wall_count; ++i) {
    if (!c.is_apart || c.wall_weights[i] > 0.0) local[corners++] = wall.local[c.touch.corners[i]];
  }
  const Shape::Feature feature =
      map.shape(wall.face.cell).feature(std::span<const std::uint16_t>(local).first(corners));
  contact.wall_kind = feature.kind;
  contact.dart = {wall.face.cell, feature.dart};
  contact.time_of_impact = c.touch.time;
  contact.point = place_in(c, reached);
  contact.wall_point = weighted(c.wall_weights, wall_points(c.touch, walls_made));
  contact.normal = c.normal;
  contact.gap = dot(c.normal, contact.point - contact.wall_point);
  contact.displacement = place_in(c, motion.to) - place_in(c, motion.from);
  contact.wall_displacement = c.wall_point - weighted(c.wall_weights, wall_points(c.touch, 0.0));
  return contact;
}

}  // namespace dartcast
