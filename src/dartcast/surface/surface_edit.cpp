#include "dartcast/surface/surface_edit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include "dartcast/base/error.hpp"
#include "dartcast/exact/predicates.hpp"
#include "dartcast/surface/surface_locator.hpp"

namespace dartcast {

SurfaceEdit::SurfaceEdit(Surface& surface)
    : surface_(surface), positions_before_(surface.positions_.size()), transaction_(surface.map_) {}

SurfaceEdit::~SurfaceEdit() { surface_.positions_.resize(positions_before_); }

// New vertices take their first positions: numbers used again lie among the others.
void SurfaceEdit::take_born() {
  born_ = std::min(born_, transaction_.born_count());
  auto& positions = surface_.positions_;
  positions.resize(map().vertex_count());
  for (; born_ < transaction_.born_count(); ++born_) {
    const BornVertex& v = transaction_.born(born_);
    const Vec3 a = positions[v.from.value];
    positions[v.vertex.value] = v.from == v.other ? a : (a + positions[v.other.value]) * 0.5;
  }
}

Vec3 SurfaceEdit::position(Vertex v) {
  take_born();
  if (!map().is_vertex(v)) throw InvalidArgument(fmt::format("there is no vertex {}: an edit gave it up", v.value));
  return surface_.positions_[v.value];
}

void SurfaceEdit::place(Vertex v, const Vec3& x) {
  take_born();
  std::size_t i = born_;
  while (i > 0 && transaction_.born(i - 1).vertex != v) --i;
  if (i == 0)
    throw InvalidArgument(
        fmt::format("place: vertex {} was not made by this edit; move the others by a move", v.value));
  if (!in_exact_range(x))
    throw InvalidArgument(
        fmt::format("place: vertex {} would be at ({}, {}, {}): coordinates must be finite, and 0 or "
                    "between 2^-300 and 2^300 in magnitude",
                    v.value, x.x, x.y, x.z));
  surface_.positions_[v.value] = x;
}

SurfaceEditReport SurfaceEdit::commit() {
  take_born();
  for (const Cell c : transaction_.added()) {
    if (!surface_.has_flat_triangle(c, surface_.positions_)) continue;
    const std::uint32_t source = map().source(c);
    transaction_.roll_back();
    take_born();
    throw EditRefused(
        fmt::format("face {} would have a triangle without area: split it at the vertices on its edges", source));
  }
  SurfaceEditReport report;
  for (const Cell c : transaction_.removed()) {
    const auto triangles = map().view(c).shape().simplices().size();
    for (std::uint16_t s = 0; s < triangles; ++s)
      report.gone.push_back({{c, s}, map().source(c), surface_.corners({c, s})});
  }
  std::sort(report.gone.begin(), report.gone.end(),
            [](const auto& a, const auto& b) { return a.triangle < b.triangle; });
  report.map = transaction_.commit();
  positions_before_ = surface_.positions_.size();
  born_ = 0;
  return report;
}

namespace {

// The same corners, from whichever on: the place keeps its weights.
std::optional<SurfacePlace> in_same_corners(const Surface& surface, const GoneTriangle& was, SimplexId now,
                                            const std::array<double, 3>& weights) {
  const auto corners = surface.corners(now);
  for (unsigned turn = 0; turn < 3; ++turn) {
    const auto at = [&](unsigned i) { return (i + turn) % 3; };
    if (corners[0] == was.corners[at(0)] && corners[1] == was.corners[at(1)] && corners[2] == was.corners[at(2)])
      return SurfacePlace{now, {weights[at(0)], weights[at(1)], weights[at(2)]}};
  }
  return {};
}

Vec3 point_in(const GoneTriangle& t, const std::array<double, 3>& w) {
  return t.corners[0] + ((t.corners[1] - t.corners[0]) * w[1] + (t.corners[2] - t.corners[0]) * w[2]);
}

}  // namespace

std::optional<SurfacePlace> followed(const Surface& surface, const SurfaceEditReport& report,
                                     const SurfacePlace& place) {
  const auto was = std::lower_bound(report.gone.begin(), report.gone.end(), place.triangle,
                                    [](const GoneTriangle& a, SimplexId b) { return a.triangle < b; });
  if (was == report.gone.end() || was->triangle != place.triangle) return place;
  const Map& map = surface.map();
  const Vec3 x = point_in(*was, place.weights);
  std::optional<SurfacePlace> nearest;
  std::pair<double, bool> least;  // distance, and whether of another face's origin
  for (const Cell c : report.map.added) {
    const bool other = map.source(c) != was->source;
    for (std::uint16_t s = 0; s < map.shape(c).simplices().size(); ++s) {
      if (!other) {
        if (const auto same = in_same_corners(surface, *was, {c, s}, place.weights)) return same;
      }
      const SurfaceLocation at = nearest_in_triangle(surface, {c, s}, x);
      const std::pair<double, bool> rank = {at.distance, other};
      if (nearest && !(rank < least)) continue;
      nearest = at.place;
      least = rank;
    }
  }
  return nearest;
}

}  // namespace dartcast
