// Intersections of triangles by exact signs. In order: the boxes (a tree), the sides of each triangle with the other,
// and, if these lie in one plane, sides with sides.
#include "solids/audit_solids.hpp"

#include <algorithm>

#include "environment/audit_integers.hpp"

namespace dartcast {

namespace {

using detail::AuditInteger;
using detail::AuditPoint;
using detail::cross;
using detail::difference;
using detail::dot;
using detail::volume6;

int sign(const AuditInteger& x) { return x.sign(); }
bool is_zero(const AuditPoint& v) { return v[0] == 0 && v[1] == 0 && v[2] == 0; }

// Whether no two of these are of opposite signs.
bool agree(int a, int b, int c) { return std::min({a, b, c}) >= 0 || std::max({a, b, c}) <= 0; }

bool is_on(const AuditPoint& p, const AuditPoint& a, const AuditPoint& b) {
  if (!is_zero(cross(difference(b, a), difference(p, a)))) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    if ((p[k] - a[k]) * (p[k] - b[k]) > 0) return false;
  }
  return true;
}

bool meet(const AuditPoint& a, const AuditPoint& b, const AuditPoint& c, const AuditPoint& d) {
  const AuditPoint ab = difference(b, a);
  const AuditPoint cd = difference(d, c);
  const AuditPoint normal = cross(ab, cd);
  if (is_zero(normal)) return is_on(a, c, d) || is_on(b, c, d) || is_on(c, a, b) || is_on(d, a, b);
  if (dot(normal, difference(c, a)) != 0) return false;
  // In one plane: each has its ends on both sides of the other's line.
  const auto side = [&](const AuditPoint& way, const AuditPoint& from, const AuditPoint& p) {
    return sign(dot(normal, cross(way, difference(p, from))));
  };
  return side(ab, a, c) * side(ab, a, d) <= 0 && side(cd, c, a) * side(cd, c, b) <= 0;
}

using AuditTriangle = std::array<AuditPoint, 3>;

bool meets_side(const AuditPoint& a, const AuditPoint& b, const AuditTriangle& t) {
  return meet(a, b, t[0], t[1]) || meet(a, b, t[1], t[2]) || meet(a, b, t[2], t[0]);
}

bool meet(const AuditPoint& a, const AuditPoint& b, const AuditTriangle& t) {
  const AuditPoint normal = cross(difference(t[1], t[0]), difference(t[2], t[0]));
  if (is_zero(normal)) return meets_side(a, b, t);
  const int from = sign(dot(normal, difference(a, t[0])));
  const int to = sign(dot(normal, difference(b, t[0])));
  if (from * to > 0) return false;
  if (from != 0 || to != 0)
    return agree(sign(volume6(a, b, t[0], t[1])), sign(volume6(a, b, t[1], t[2])), sign(volume6(a, b, t[2], t[0])));
  const auto side = [&](std::size_t i) {
    return sign(dot(normal, cross(difference(t[(i + 1) % 3], t[i]), difference(a, t[i]))));
  };
  return agree(side(0), side(1), side(2)) || meets_side(a, b, t);
}

std::vector<std::array<Vec3, 3>> walls_of(const CellComplex& complex) {
  std::vector<std::array<Vec3, 3>> walls;
  for (const Cell c : complex.map().cells()) {
    const CellView cell = complex.map().view(c);
    if (!cell.is_free()) continue;
    for (std::uint16_t f = 0; f < cell.shape().face_count(); ++f) {
      if (!cell.is_wall(f)) continue;
      for (std::uint16_t t = 0; t < cell.shape().triangle_count(f); ++t) {
        const auto local = cell.shape().triangle(f, t);
        std::array<Vec3, 3>& wall = walls.emplace_back();
        for (std::size_t i = 0; i < 3; ++i) wall[i] = detail::counted(complex.positions()[cell.vertex(local[i]).value]);
        if (!std::all_of(wall.begin(), wall.end(), detail::is_in_range)) walls.pop_back();
      }
    }
  }
  return walls;
}

std::vector<Box> boxes_around(const std::vector<std::array<Vec3, 3>>& walls) {
  std::vector<Box> boxes(walls.size());
  std::transform(walls.begin(), walls.end(), boxes.begin(), audit_box);
  return boxes;
}

}  // namespace

Box audit_box(const std::array<Vec3, 3>& t) { return join(join(Box{t[0], t[0]}, Box{t[1], t[1]}), Box{t[2], t[2]}); }

bool audit_meet(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  const auto p = detail::to_integers<6>({a[0], a[1], a[2], b[0], b[1], b[2]});
  const AuditTriangle s = {p[0], p[1], p[2]};
  const AuditTriangle t = {p[3], p[4], p[5]};
  for (std::size_t i = 0; i < 3; ++i) {
    if (meet(s[i], s[(i + 1) % 3], t) || meet(t[i], t[(i + 1) % 3], s)) return true;
  }
  return false;
}

WallAudit::WallAudit(const CellComplex& complex) : walls_(walls_of(complex)), tree_(boxes_around(walls_)) {}

bool WallAudit::meets_wall(std::span<const Vec3> positions, const SolidElement& element) const {
  std::array<Vec3, 3> t;
  for (std::size_t i = 0; i < 3; ++i) t[i] = positions[element.vertex[i]];
  if (!std::all_of(t.begin(), t.end(), detail::is_in_range)) return true;
  bool met = false;
  tree_.query(audit_box(t), [&](std::size_t w) {
    met = audit_meet(t, walls_[w]);
    return !met;
  });
  return met;
}

}  // namespace dartcast
