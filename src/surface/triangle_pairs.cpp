// Two triangles meet if an edge of one meets the other one. If they share a corner, the part in common that begins
// there ends at an edge opposite to it. If they share an edge, they meet beyond it only in one plane.
#include "surface/triangle_pairs.hpp"

#include <algorithm>

#include "dartcast/predicates.hpp"
#include "mesh/box_tree.hpp"

namespace dartcast {
namespace {

using Triangle = std::array<Vec3, 3>;

/// The point seen along an axis: x and y hold the two other coordinates.
Vec3 seen_along(const Vec3& p, unsigned axis) {
  switch (axis) {
    case 0: return {p.y, p.z, 0.0};
    case 1: return {p.z, p.x, 0.0};
    default: return {p.x, p.y, 0.0};
  }
}

int sign_of(Sign s) { return static_cast<int>(s); }

int side(const Vec3& a, const Vec3& b, const Vec3& c) { return sign_of(orient2d(a, b, c)); }

/// An axis along which the triangle is seen with an area.
unsigned axis_of(const Triangle& t) {
  unsigned axis = 0;
  while (axis < 2 && side(seen_along(t[0], axis), seen_along(t[1], axis), seen_along(t[2], axis)) == 0) ++axis;
  return axis;
}

/// Whether a point of the line through p and q lies between them.
bool is_between(const Vec3& p, const Vec3& q, const Vec3& x) {
  return std::min(p.x, q.x) <= x.x && x.x <= std::max(p.x, q.x) && std::min(p.y, q.y) <= x.y &&
         x.y <= std::max(p.y, q.y);
}

bool segments_meet(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const int abc = side(a, b, c);
  const int abd = side(a, b, d);
  const int cda = side(c, d, a);
  const int cdb = side(c, d, b);
  if (abc * abd < 0 && cda * cdb < 0) return true;
  return (abc == 0 && is_between(a, b, c)) || (abd == 0 && is_between(a, b, d)) || (cda == 0 && is_between(c, d, a)) ||
         (cdb == 0 && is_between(c, d, b));
}

bool meets_in_plane(const Vec3& p, const Vec3& q, const Triangle& t) {
  const unsigned axis = axis_of(t);
  const Triangle s = {seen_along(t[0], axis), seen_along(t[1], axis), seen_along(t[2], axis)};
  const Vec3 a = seen_along(p, axis);
  const Vec3 b = seen_along(q, axis);
  const int turn = side(s[0], s[1], s[2]);
  const bool inside =
      side(s[0], s[1], a) * turn >= 0 && side(s[1], s[2], a) * turn >= 0 && side(s[2], s[0], a) * turn >= 0;
  return inside || segments_meet(a, b, s[0], s[1]) || segments_meet(a, b, s[1], s[2]) ||
         segments_meet(a, b, s[2], s[0]);
}

/// Whether a segment and a triangle, both closed, have a point in common.
bool segment_meets(const Vec3& p, const Vec3& q, const Triangle& t) {
  const int at_p = sign_of(orient3d(t[0], t[1], t[2], p));
  const int at_q = sign_of(orient3d(t[0], t[1], t[2], q));
  if (at_p == 0 && at_q == 0) return meets_in_plane(p, q, t);
  if (at_p * at_q > 0) return false;
  const int a = sign_of(orient3d(p, q, t[0], t[1]));
  const int b = sign_of(orient3d(p, q, t[1], t[2]));
  const int c = sign_of(orient3d(p, q, t[2], t[0]));
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

/// Two triangles with the edge u v in common, and the corners c and d opposite to it.
bool fold_over(const Vec3& u, const Vec3& v, const Vec3& c, const Vec3& d) {
  if (orient3d(u, v, c, d) != Sign::zero) return false;
  const unsigned axis = axis_of({u, v, c});
  const auto seen = [&](const Vec3& p) { return seen_along(p, axis); };
  return side(seen(u), seen(v), seen(c)) == side(seen(u), seen(v), seen(d));
}

Triangle corners_of(std::span<const Vec3> points, const TriangleCorners& t) {
  return {flushed(points[t[0]]), flushed(points[t[1]]), flushed(points[t[2]])};
}

}  // namespace

bool cross_or_touch(std::span<const Vec3> points, const TriangleCorners& a, const TriangleCorners& b) {
  std::vector<unsigned> own_a;  // numbers of the corners that are not shared
  std::vector<unsigned> own_b;
  const auto has = [](const TriangleCorners& t, std::uint32_t p) {
    return std::find(t.begin(), t.end(), p) != t.end();
  };
  for (unsigned k = 0; k < 3; ++k) {
    if (!has(b, a[k])) own_a.push_back(k);
    if (!has(a, b[k])) own_b.push_back(k);
  }
  const Triangle s = corners_of(points, a);
  const Triangle t = corners_of(points, b);
  if (own_a.empty()) return true;
  if (own_a.size() == 1) return fold_over(s[(own_a[0] + 1) % 3], s[(own_a[0] + 2) % 3], s[own_a[0]], t[own_b[0]]);
  if (own_a.size() == 2)
    return segment_meets(s[own_a[0]], s[own_a[1]], t) || segment_meets(t[own_b[0]], t[own_b[1]], s);
  for (unsigned k = 0; k < 3; ++k) {
    if (segment_meets(s[k], s[(k + 1) % 3], t) || segment_meets(t[k], t[(k + 1) % 3], s)) return true;
  }
  return false;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> crossing_pairs(std::span<const Vec3> points,
                                                                    std::span<const TriangleCorners> triangles,
                                                                    std::size_t limit) {
  std::vector<Box> boxes;
  boxes.reserve(triangles.size());
  for (const TriangleCorners& t : triangles) {
    const Triangle c = corners_of(points, t);
    boxes.push_back(join(join({c[0], c[0]}, {c[1], c[1]}), {c[2], c[2]}));
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  const BoxTree tree(boxes);
  for (std::uint32_t i = 0; i < triangles.size() && pairs.size() < limit; ++i) {
    tree.query(boxes[i], [&](std::uint32_t j) {
      if (j > i && cross_or_touch(points, triangles[i], triangles[j])) pairs.emplace_back(i, j);
      return pairs.size() < limit;
    });
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace dartcast
