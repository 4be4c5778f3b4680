#include "dartcast/surgery/sides.hpp"

#include <algorithm>
#include <cmath>

#include "dartcast/base/error.hpp"

namespace dartcast::detail {

void check_snap(double snap) {
  if (!(snap >= SectionOptions::least_snap && snap <= 0.25))
    throw InvalidArgument("snap is a share of an edge between 2^-30 and 1/4");
}

Vec3 middle(ComplexEdit& edit, Cell c) {
  const CellView v = edit.map().view(c);
  Vec3 sum;
  for (std::uint16_t k = 0; k < v.shape().corner_count(); ++k) sum += edit.position(v.vertex(k));
  return sum * (1.0 / v.shape().corner_count());
}

Sides::Known& Sides::know(Vertex v) {
  const auto [known, fresh] = known_.try_emplace(v.value);
  if (fresh) {
    known->second.x = edit_.position(v);
    known->second.height = plane_.height(known->second.x);
  }
  return known->second;
}

void Sides::take(Cell c) {
  const CellView v = edit_.map().view(c);
  const Shape& s = v.shape();
  for (std::uint16_t d = 0; d < s.dart_count(); ++d) {
    const Vertex from = v.vertex(s.origin(d));
    const Vertex to = v.vertex(s.origin(s.phi1(d)));
    if (to < from) continue;
    Known& a = know(from);
    Known& b = know(to);  // references into the table stay valid
    const double length = norm(b.x - a.x);
    a.shortest = std::min(a.shortest, length);
    b.shortest = std::min(b.shortest, length);
  }
}

int Sides::operator[](Vertex v) const {
  const Known& k = known_.at(v.value);
  if (std::abs(k.height) <= options_.snap * std::min(k.shortest, options_.finest)) return 0;
  return k.height < 0.0 ? -1 : 1;
}

Vec3 Sides::crossing(Vertex below, Vertex above) const {
  const Known& a = known_.at(below.value);
  const Known& b = known_.at(above.value);
  return a.x + (b.x - a.x) * (a.height / (a.height - b.height));
}

Sides::Reach Sides::reach(Cell c) const {
  const CellView v = edit_.map().view(c);
  Reach reach;
  for (std::uint16_t k = 0; k < v.shape().corner_count(); ++k) {
    const int side = (*this)[v.vertex(k)];
    reach.below |= side < 0;
    reach.above |= side > 0;
  }
  return reach;
}

bool Sides::is_above(Cell c) const {
  const Reach r = reach(c);
  return r.below == r.above ? plane_.height(middle(edit_, c)) > 0.0 : r.above;
}

}  // namespace dartcast::detail
