// The sides of planes on which vertices lie, each decided once.
#include "editing/sides.hpp"

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

std::uint32_t Sides::decide(Vertex v) {
  const Vec3 x = edit_.position(v);
  for (const Plane& plane : planes_) {
    const double height = plane.height(x);
    sides_.push_back(static_cast<Side>((height < -within_ ? below_bit : 0) | (height > within_ ? above_bit : 0)));
  }
  return number_[v.value] = count_++;
}

Vec3 Sides::crossing(Vertex low, Vertex high, std::size_t plane) {
  const Vec3 a = edit_.position(low);
  const Vec3 b = edit_.position(high);
  const double height = planes_[plane].height(a);
  return a + (b - a) * (height / (height - planes_[plane].height(b)));
}

}  // namespace dartcast::detail
