// The sides of a plane on which vertices and cells lie, each decided once.
#include "editing/sides.hpp"

#include <cmath>

#include "dartcast/error.hpp"

namespace dartcast::detail {

void check_snap(double snap) {
  if (!(snap >= SectionOptions::min_snap && snap <= 0.25))
    throw InvalidArgument("snap is a share of an edge between 2^-30 and 1/4");
}

Vec3 middle(ComplexEdit& edit, Cell c) {
  const CellView v = edit.map().view(c);
  Vec3 sum;
  for (std::uint16_t k = 0; k < v.shape().corner_count(); ++k) sum += edit.position(v.vertex(k));
  return sum * (1.0 / v.shape().corner_count());
}

// A new vertex lies on the plane but for rounding.
double Sides::height(Vertex v) const {
  return !on_.empty() && on_.contains(v.value) ? 0.0 : plane_.height(edit_.position(v));
}

int Sides::operator[](Vertex v) {
  const double h = height(v);
  if (std::abs(h) <= within_) return 0;
  return h < 0.0 ? -1 : 1;
}

Vec3 Sides::crossing(Vertex below, Vertex above) {
  const Vec3 a = edit_.position(below);
  const Vec3 b = edit_.position(above);
  return a + (b - a) * (height(below) / (height(below) - height(above)));
}

Sides::Reach Sides::reach(Cell c) {
  const CellView v = edit_.map().view(c);
  Reach reach;
  for (std::uint16_t k = 0; k < v.shape().corner_count(); ++k) {
    const int side = (*this)[v.vertex(k)];
    reach.below |= side < 0;
    reach.above |= side > 0;
  }
  return reach;
}

bool Sides::is_above(Cell c) {
  const Reach r = reach(c);
  return r.below == r.above ? plane_.height(middle(edit_, c)) > 0.0 : r.above;
}

bool Sides::reaches_below(Cell c) { return reach(c).below || !is_above(c); }

bool Sides::looks_down(CellFace f) {
  const CellView v = edit_.map().view(f.cell);
  const auto corners = v.shape().corners(f.face);
  const auto x = [&](std::size_t k) { return edit_.position(v.vertex(corners[k])); };
  Vec3 area;
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) area += cross(x(k) - x(0), x(k + 1) - x(0));
  return dot(area, plane_.normal) < 0.0;
}

}  // namespace dartcast::detail
