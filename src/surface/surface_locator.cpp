// Finds the place of a surface that is nearest to a point.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/elementary.hpp"
#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "dartcast/surface.hpp"
#include "mesh/box_tree.hpp"

namespace dartcast {

namespace {

std::vector<SimplexId> triangles_by_source(const Surface& surface) {
  std::vector<SimplexId> all = surface.triangles();
  std::sort(all.begin(), all.end(), [&](SimplexId a, SimplexId b) {
    return std::pair{surface.map().source(a.cell), a} < std::pair{surface.map().source(b.cell), b};
  });
  return all;
}

Box box_of_triangle(const Surface& surface, SimplexId t) {
  const auto v = surface.corners(t);
  return join(join({v[0], v[0]}, {v[1], v[1]}), {v[2], v[2]});
}

std::vector<Box> boxes_of_triangles(const Surface& surface, std::span<const SimplexId> triangles) {
  std::vector<Box> boxes;
  boxes.reserve(triangles.size());
  for (const SimplexId t : triangles) boxes.push_back(box_of_triangle(surface, t));
  return boxes;
}

double longest_side(const Box& box) {
  const Vec3 size = box.high - box.low;
  return std::max({size.x, size.y, size.z});
}

// A box of all points at a distance up to r, and of more by the rounding of x and r.
Box box_around(const Vec3& x, double r) {
  const double half = r + 0x1p-50 * std::max({r, std::abs(x.x), std::abs(x.y), std::abs(x.z)});
  return {x - Vec3{half, half, half}, x + Vec3{half, half, half}};
}

double distance_to(const Box& box, const Vec3& x) {
  const auto off = [](double low, double high, double c) { return std::max({low - c, c - high, 0.0}); };
  return hypotenuse(off(box.low.x, box.high.x, x.x), off(box.low.y, box.high.y, x.y), off(box.low.z, box.high.z, x.z));
}

// Weights of the foot of x on the triangle, from products of its edges: Ericson's names.
std::array<double, 3> foot_weights(const Vec3& ab, const Vec3& ac, const Vec3& ap) {
  const Vec3 bp = ap - ab;
  const Vec3 cp = ap - ac;
  const double d1 = dot(ab, ap);
  const double d2 = dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {1.0, 0.0, 0.0};
  const double d3 = dot(ab, bp);
  const double d4 = dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return {0.0, 1.0, 0.0};
  const double d5 = dot(ab, cp);
  const double d6 = dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return {0.0, 0.0, 1.0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {-d3, d1, 0.0};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {-d6, 0.0, d2};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 >= d3 && d5 >= d6) return {0.0, d5 - d6, d4 - d3};
  return {std::max(va, 0.0), std::max(vb, 0.0), std::max(vc, 0.0)};
}

}  // namespace

SurfaceLocation nearest_in_triangle(const Surface& surface, SimplexId triangle, const Vec3& x) {
  const auto v = surface.corners(triangle);
  const Vec3 extent = extent_of(v[1] - v[0], v[2] - v[0], x - v[0]);
  const double scale = std::ldexp(1.0, -std::ilogb(std::max({extent.x, extent.y, extent.z})));
  auto w = foot_weights((v[1] - v[0]) * scale, (v[2] - v[0]) * scale, (x - v[0]) * scale);
  if (!(w[0] + w[1] + w[2] > 0.0)) w = {1.0, 0.0, 0.0};  // all underflowed: a triangle far below its distance
  SurfaceLocation out;
  out.place = surface.place(triangle, w);
  const Vec3 off = surface.point(out.place) - x;
  out.distance = hypotenuse(off.x, off.y, off.z);
  return out;
}

struct SurfaceLocator::Tree {
  std::vector<SimplexId> triangles;  // by face of the mesh
  BoxTree boxes;
  Box bounds;
  double start = 0.0;  // a first guess at a distance: half the mean size of the triangles

  explicit Tree(const Surface& surface)
      : triangles(triangles_by_source(surface)), boxes(boxes_of_triangles(surface, triangles)) {
    const auto count = static_cast<double>(triangles.size());
    bounds = box_of_triangle(surface, triangles.front());
    for (const SimplexId t : triangles) {
      const Box box = box_of_triangle(surface, t);
      bounds = join(bounds, box);
      start += longest_side(box) / (2.0 * count);
    }
  }
};

SurfaceLocator::SurfaceLocator(const Surface& surface) : tree_(std::make_shared<const Tree>(surface)) {}

// A place at a distance up to r lies in the box of that size around x, so the box of its triangle overlaps it. The best
// of these places is the best of all if it is no farther than r.
SurfaceLocation SurfaceLocator::nearest(const Surface& surface, const Vec3& x) const {
  if (!in_exact_range(x))
    throw InvalidArgument("nearest: a point's coordinates must be finite, and at most 2^300 in magnitude");
  const auto padded = [](double r) { return r * (1.0 + 0x1p-40); };
  double r = padded(distance_to(tree_->bounds, x)) + tree_->start;
  while (true) {
    std::uint32_t best = 0xffffffffU;
    SurfaceLocation found;
    found.distance = std::numeric_limits<double>::infinity();
    tree_->boxes.query(box_around(x, r), [&](std::uint32_t i) {
      const SurfaceLocation here = nearest_in_triangle(surface, tree_->triangles[i], x);
      if (here.distance < found.distance || (here.distance == found.distance && i < best)) {
        found = here;
        best = i;
      }
      return true;
    });
    if (padded(found.distance) <= r) return found;
    r = std::min(2.0 * r, padded(padded(found.distance)));
  }
}

}  // namespace dartcast
