// Ties a vessel: finds the crossed cells of a section, blocks them, and draws the walls together.
#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "dartcast/cutting.hpp"
#include "dartcast/error.hpp"
#include "editing/sides.hpp"

namespace dartcast {

namespace {

// Whether the plane crosses the cell, as if it lay a little lower: vertices on it count as above. So a face between two
// cells that are not crossed cannot lead from below to above, for it would need a corner on both sides.
bool is_crossed(ComplexEdit& edit, const Plane& plane, Cell c) {
  const CellView v = edit.map().view(c);
  bool below = false;
  bool above = false;
  for (std::uint16_t k = 0; k < v.shape().corner_count(); ++k) {
    const bool is_below = plane.height(edit.position(v.vertex(k))) < 0.0;
    below |= is_below;
    above |= !is_below;
  }
  return below && above;
}

}  // namespace

std::vector<Cell> ligature(ComplexEdit& edit, const Plane& plane, Cell start) {
  const CombinatorialMap& map = edit.map();
  if (!map.contains(start) || !map.is_free(start) || !is_crossed(edit, plane, start))
    throw InvalidArgument("a ligature starts from a free cell that its plane crosses");
  std::vector<Cell> cells = {start};
  std::unordered_set<std::uint32_t> seen = {start.value};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const CellView v = map.view(cells[i]);
    for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
      const Cell other = v.neighbour(f);
      if (other.valid() && map.is_free(other) && seen.insert(other.value).second && is_crossed(edit, plane, other))
        cells.push_back(other);
    }
  }
  for (const Cell c : cells) edit.topology().set_free(c, false);
  return cells;
}

std::vector<Cell> ligature(ComplexEdit& edit, const Plane& plane, const Vec3& place) {
  Cell nearest;
  double lowest = std::numeric_limits<double>::infinity();
  for (const Cell c : edit.map().cells()) {
    if (!edit.map().is_free(c) || !is_crossed(edit, plane, c)) continue;
    const double distance = norm(detail::middle(edit, c) - place);
    if (!(distance < lowest)) continue;
    lowest = distance;
    nearest = c;
  }
  if (!nearest.valid())
    throw InvalidArgument("the plane of the ligature crosses no free cell: move it into the vessel");
  return ligature(edit, plane, nearest);
}

namespace {

struct FaceRing {
  Vec3 centre;
  double radius = 0.0;
};

// The section's middle, and the distance of its corners from it, parallel to the plane.
FaceRing ring_of(const CellComplex& complex, std::span<const Cell> section, const Plane& plane) {
  std::unordered_set<std::uint32_t> seen;
  std::vector<Vec3> flat;  // in the order of coming: that of a set depends on the standard library
  for (const Cell c : section) {
    if (!complex.map().contains(c)) throw InvalidArgument("there is no such cell in the section: an edit replaced it");
    const CellView v = complex.map().view(c);
    for (std::uint16_t k = 0; k < v.shape().corner_count(); ++k) {
      const Vec3 x = complex.positions()[v.vertex(k).value];
      if (seen.insert(v.vertex(k).value).second) flat.push_back(x - plane.normal * plane.height(x));
    }
  }
  if (flat.empty()) throw InvalidArgument("the section to draw together has no cells");
  FaceRing ring;
  for (const Vec3& x : flat) ring.centre += x * (1.0 / static_cast<double>(flat.size()));
  for (const Vec3& x : flat) ring.radius = std::max(ring.radius, norm(x - ring.centre));
  return ring;
}

// 1 at 0, 0 from 1 on, smooth at both ends.
double fading(double q) {
  const double left = q < 1.0 ? 1.0 - q * q : 0.0;
  return left * left;
}

}  // namespace

void draw_together(const CellComplex& complex, std::span<const Cell> section, const Plane& plane,
                   const TyingOptions& options, std::span<Vec3> positions) {
  if (!(options.share >= 0.0 && options.share < 1.0) || !(options.reach > 0.0) || !std::isfinite(options.reach))
    throw InvalidArgument("walls are drawn together by a share in [0, 1), with a positive reach");
  const FaceRing ring = ring_of(complex, section, plane);
  for (Vec3& x : positions) {
    const double height = plane.height(x);
    const Vec3 out = x - plane.normal * height - ring.centre;
    const double beyond = std::max(norm(out) - ring.radius, 0.0);
    x -= out * (options.share * fading(std::abs(height) / options.reach) * fading(beyond / options.reach));
  }
}

}  // namespace dartcast
