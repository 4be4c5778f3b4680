// Edits of a surface, and the places that follow them.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "complex/created_positions.hpp"
#include "dartcast/error.hpp"
#include "dartcast/surface.hpp"

namespace dartcast {

struct SurfaceEdit::Created : detail::CreatedPositions<std::vector<Vec3>> {
  using CreatedPositions::CreatedPositions;
};

SurfaceEdit::SurfaceEdit(Surface& surface)
    : surface_(surface),
      transaction_(surface.map_),
      created_(std::make_unique<Created>(transaction_, surface.positions_)) {}

SurfaceEdit::~SurfaceEdit() { created_->give_up(); }

Vec3 SurfaceEdit::position(Vertex v) { return created_->at(v); }

void SurfaceEdit::place(Vertex v, const Vec3& x) { created_->place(v, x); }

SurfaceEditReport SurfaceEdit::commit() {
  created_->take();
  for (const Cell c : transaction_.added()) {
    if (!surface_.has_flat_triangle(c, surface_.positions_)) continue;
    const std::uint32_t source = map().source(c);
    transaction_.roll_back();
    created_->take();
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
  created_->keep();
  return report;
}

namespace {

// The triangles have the same corners, in any rotation: the place keeps its weights.
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
  const CombinatorialMap& map = surface.map();
  const Vec3 x = point_in(*was, place.weights);
  std::optional<SurfacePlace> nearest;
  std::pair<double, bool> lowest;  // distance, and whether the face has another source
  for (const Cell c : report.map.added) {
    const bool other = map.source(c) != was->source;
    for (std::uint16_t s = 0; s < map.shape(c).simplices().size(); ++s) {
      if (!other) {
        if (const auto same = in_same_corners(surface, *was, {c, s}, place.weights)) return same;
      }
      const SurfaceLocation at = nearest_in_triangle(surface, {c, s}, x);
      const std::pair<double, bool> rank = {at.distance, other};
      if (nearest && !(rank < lowest)) continue;
      nearest = at.place;
      lowest = rank;
    }
  }
  return nearest;
}

}  // namespace dartcast
