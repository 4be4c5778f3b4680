// Searches outwards, from cell to cell, for the nearest point of the free cells.
#include "tracking/nearest_free.hpp"

#include <limits>
#include <queue>
#include <unordered_set>
#include <utility>
#include <vector>

#include "dartcast/validity.hpp"

namespace dartcast {

Vec3 closest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) {
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const double d1 = dot(ab, x - a);
  const double d2 = dot(ac, x - a);
  if (d1 <= 0.0 && d2 <= 0.0) return a;
  const double d3 = dot(ab, x - b);
  const double d4 = dot(ac, x - b);
  if (d3 >= 0.0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return a + ab * (d1 / (d1 - d3));
  const double d5 = dot(ab, x - c);
  const double d6 = dot(ac, x - c);
  if (d6 >= 0.0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return a + ac * (d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  const double sum = va + vb + vc;
  return a + ab * (vb / sum) + ac * (vc / sum);
}

namespace {

// The point of a cell's surface that is nearest to x.
struct OnSurface {
  Vec3 point;
  double distance = std::numeric_limits<double>::infinity();
  std::uint16_t face = 0;
  std::uint16_t triangle = 0;
};

OnSurface nearest_on_surface(const CellComplex& complex, Cell c, const Vec3& x) {
  const CellView v = complex.map().view(c);
  const Shape& s = v.shape();
  OnSurface nearest;
  for (std::uint16_t f = 0; f < s.face_count(); ++f) {
    for (std::uint16_t t = 0; t < s.triangle_count(f); ++t) {
      const auto local = s.triangle(f, t);
      const auto at = [&](unsigned i) { return complex.positions()[v.vertex(local[i]).value]; };
      const Vec3 point = closest_on_triangle(at(0), at(1), at(2), x);
      const double distance = norm(point - x);
      if (distance < nearest.distance) nearest = {point, distance, f, t};
    }
  }
  return nearest;
}

class NearestFreeSearch {
 public:
  NearestFreeSearch(const CellComplex& complex, const Vec3& x) : complex_(complex), x_(x) {}

  std::optional<NearestFree> from(std::span<const Cell> start) {
    for (const Cell c : start) reach(c);
    while (!reached_.empty()) {
      const Cell c = reached_.top().second;
      reached_.pop();
      const CellView v = complex_.map().view(c);
      if (v.is_free() && !check_cell(complex_.map(), complex_.positions(), c)) return placed_in(c);
      for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
        if (v.neighbour(f).valid()) reach(v.neighbour(f));
      }
    }
    return {};
  }

 private:
  void reach(Cell c) {
    if (seen_.insert(c.value).second) reached_.emplace(nearest_on_surface(complex_, c, x_).distance, c);
  }

  [[nodiscard]] NearestFree placed_in(Cell c) const {
    const OnSurface on = nearest_on_surface(complex_, c, x_);
    const SimplexId simplex{c, complex_.map().shape(c).entry(on.face, on.triangle).index};
    const SimplexPlacement placed = place_in_simplex(complex_, simplex, on.point);
    return {placed, norm(placed.position - x_)};
  }

  using Reached = std::pair<double, Cell>;

  const CellComplex& complex_;
  const Vec3& x_;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> reached_;
  std::unordered_set<std::uint32_t> seen_;
};

}  // namespace

std::optional<NearestFree> nearest_free(const CellComplex& complex, std::span<const Cell> start, const Vec3& x) {
  return NearestFreeSearch(complex, x).from(start);
}

}  // namespace dartcast
