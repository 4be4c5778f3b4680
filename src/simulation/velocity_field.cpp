// Interpolates a velocity field, and carries it with a mesh that deforms.
#include "dartcast/velocity_field.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "dartcast/error.hpp"

namespace dartcast {

namespace {

// Interior vertices take values as they take positions.
std::vector<Vec3> at_all_vertices(const CellComplex& complex, std::span<const Vec3> values) {
  std::vector<Vec3> all(values.begin(), values.end());
  all.resize(complex.positions().size());
  complex.steiner_weights().compute(all);
  return all;
}

// The linear map that takes the edges of one simplex to those of another, applied to u.
Vec3 mapped(const Corners& from, const Corners& to, const Vec3& u) {
  const Vec3 a = from[1] - from[0];
  const Vec3 b = from[2] - from[0];
  const Vec3 c = from[3] - from[0];
  const double volume = dot(a, cross(b, c));
  if (!(volume > 0.0)) return u;
  const Vec3 moved = (to[1] - to[0]) * dot(cross(b, c), u) + (to[2] - to[0]) * dot(cross(c, a), u) +
                     (to[3] - to[0]) * dot(cross(a, b), u);
  return moved * (1.0 / volume);
}

}  // namespace

VelocityField::VelocityField(const CellComplex& complex, std::span<const Vec3> values, FieldFrame frame)
    : frame_(frame) {
  if (values.size() != complex.point_count()) {
    throw InvalidArgument(
        fmt::format("the velocity field has {} values for {} points", values.size(), complex.point_count()));
  }
  const auto bad = std::find_if_not(values.begin(), values.end(), is_finite);
  if (bad != values.end())
    throw InvalidArgument(fmt::format("the velocity at point {} is not finite", bad - values.begin()));
  const auto out = std::find_if(values.begin(), values.end(), [](const Vec3& v) { return v.z != 0.0; });
  if (complex.map().dimension() == 2 && out != values.end())
    throw InvalidArgument(fmt::format("the velocity at point {} is ({}, {}, {}): in the plane its z must be 0",
                                      out - values.begin(), out->x, out->y, out->z));
  values_ = at_all_vertices(complex, values);
  if (frame == FieldFrame::mesh) rest_.assign(complex.positions().begin(), complex.positions().end());
}

void VelocityField::update_after_edit(const ComplexEditReport& edit, const CellComplex& complex) {
  const auto take_over = [&](std::vector<Vec3>& values) {
    dartcast::update_after_edit(edit, complex.positions().size(), values);
    complex.steiner_weights().compute(values);
  };
  take_over(values_);
  if (frame_ == FieldFrame::mesh) take_over(rest_);
}

Vec3 VelocityField::at(const CellComplex& complex, SimplexId simplex, const std::array<double, 4>& w,
                       const Corners& now) const {
  const auto v = complex.vertices(simplex);
  const Vec3 u = (values_[v[0].value] * w[0] + values_[v[1].value] * w[1]) +
                 (values_[v[2].value] * w[2] + values_[v[3].value] * w[3]);
  switch (frame_) {
    case FieldFrame::space: return u;
    case FieldFrame::mesh: break;
  }
  const Corners rest = {rest_[v[0].value], rest_[v[1].value], rest_[v[2].value], rest_[v[3].value]};
  return mapped(complex.map().dimension() == 2 ? raised(rest) : rest, now, u);
}

}  // namespace dartcast
