// The law of a random way between its ends: of those that touch a plane, as many end at a place as at its mirror image.
#include "simulation/brownian_bridge.hpp"

#include <cmath>

#include "base/elementary.hpp"
#include "tracking/carry.hpp"

namespace dartcast {

namespace {

bool ends_particles(WallResponseKind kind) {
  switch (kind) {
    case WallResponseKind::absorb:
    case WallResponseKind::stick:
    case WallResponseKind::escape: return true;
    case WallResponseKind::reflect:
    case WallResponseKind::slide: break;
  }
  return false;
}

// Where the cells' last move has taken it.
Vec3 carried(const CellComplex& complex, const ParticleState& state) {
  return detail::combine(complex.corners(state.at()),
                         detail::barycentric(complex.previous_corners(state.at()), state.position));
}

}  // namespace

// A wall beyond `reach` is 3 standard deviations from the end, too: exp(-2 * 3 * 3) < 2^-25.
Vec3 bridged(const CellComplex& complex, const WallResponses& responses, NearWalls& scratch, const RandomWay& way) {
  const Vec3 from = way.moving ? carried(complex, way.from) : way.from.position;
  if (!is_finite(from)) return way.target;
  const double reach = way.radius + norm(way.target - from) + 3.0 * std::sqrt(way.variance);
  const std::span<const NearWall> walls = scratch.search(complex, way.from.cell, {from, from, reach}, false);
  const std::span<const NearestOnTriangle> places = scratch.nearest(from);
  const NearestOnTriangle* nearest = nullptr;
  for (std::size_t i = 0; i < walls.size(); ++i) {
    if (ends_particles(responses.of(complex.map().patch(walls[i].face)).kind) &&
        (nearest == nullptr || places[i].distance < nearest->distance))
      nearest = &places[i];
  }
  if (nearest == nullptr) return way.target;
  const double before = nearest->distance - way.radius;
  const double after = before + dot(way.target - from, nearest->normal);
  if (!(before > 0.0 && after > 0.0)) return way.target;
  const double touches = exponential(-2.0 * before * after / way.variance);
  if ((static_cast<double>(way.chance) + 0.5) * 0x1p-32 >= touches) return way.target;
  return way.target - nearest->normal * (2.0 * after);
}

}  // namespace dartcast
