// Kinds, darts and faces derived from where a particle is.
#include "dartcast/particle_state.hpp"

#include <algorithm>

#include "complex/simplex.hpp"
#include "dartcast/combinatorial_map.hpp"

namespace dartcast {

Placement placement(const CombinatorialMap& map, SimplexId simplex, const Corners& corners, const Vec3& x) {
  const CellView cell = map.view(simplex.cell);
  const ImplicitSimplex& s = cell.shape().simplices()[simplex.simplex];
  std::array<std::uint16_t, 4> points{};
  std::size_t count = 0;
  const unsigned dimension = map.dimension();
  for (unsigned i = 0; i <= dimension; ++i) {
    if (orient_facet(corners, i, x) != Sign::zero) points[count++] = s.vertex[i];
  }
  const Kind inside = static_cast<Kind>(dimension);
  if (count == 0) return {inside, {}};
  const auto feature = cell.shape().feature(std::span<const std::uint16_t>(points.data(), count));
  if (feature.kind == inside) return {inside, {}};
  return {feature.kind, {simplex.cell, feature.dart}};
}

Forecast forecast(const CombinatorialMap& map, const ParticleState& state, const Corners& corners) {
  const CellView cell = map.view(state.cell);
  const Across base = cell.shape().simplices()[state.simplex].across[0];
  Forecast result;
  // Facet 0 is the fan triangle over which the simplex is coned; its side opposite to the fan's centre is an edge of
  // the face.
  const std::uint16_t face = base.face();
  const bool from_first = map.dimension() == 2 || cell.shape().key().faces[face].has_point;
  const auto dart = static_cast<std::uint16_t>(cell.shape().first_dart(face) + base.place + (from_first ? 0 : 1));
  result.dart = {state.cell, dart};
  result.face = {state.cell, face};
  result.kind = placement(map, state.at(), corners, state.position).kind;
  if (state.touching_count > 0) {
    const auto touched = static_cast<Kind>(map.dimension() - std::min<unsigned>(state.touching_count, map.dimension()));
    result.kind = std::min(result.kind, touched);
  }
  return result;
}

}  // namespace dartcast
