// A joint move: all partners plan; if one has no room for the whole way, walls and partners make one share of theirs.
// The rounded share is checked again, and halved until it is free. Then all move.
#include "solids/joint_move.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "tracking/carry.hpp"
#include "tracking/cells_around.hpp"
#include "tracking/representable_point.hpp"

namespace dartcast {

namespace {

Corners corners_of(const CellComplex& complex, SimplexId simplex, std::span<const Vec3> x) {
  const auto v = complex.vertices(simplex);
  return {x[v[0].value], x[v[1].value], x[v[2].value], x[v[3].value]};
}

}  // namespace

SimplexId simplex_after(const CellComplex& complex, Cell cell, const Vec3& from, const Vec3& to,
                        const VertexMotion& walls, NearWalls& near) {
  MovingElement point;
  point.from[0] = from;
  point.to[0] = to;
  near.search(complex, cell, point, walls);
  for (const Cell c : near.cells_reached()) {
    const std::size_t count = complex.map().view(c).shape().simplices().size();
    for (std::uint16_t s = 0; s < count; ++s) {
      if (detail::in_closed_simplex(corners_of(complex, {c, s}, walls.after), to)) return {c, s};
    }
  }
  ParticleState state;
  state.put({cell, 0}, from);
  const std::size_t count = complex.map().view(cell).shape().simplices().size();
  for (std::uint16_t s = 0; s < count; ++s) {
    if (detail::in_closed_simplex(corners_of(complex, {cell, s}, walls.before), from)) state.simplex = s;
  }
  StepReplay replay =
      detail::replay_of(complex.map(), {walls.before, walls.after}, state, to, std::array{std::pair{from, to}});
  replay.simultaneous = true;
  throw detail::error_with_replay(
      fmt::format("joint move: no cell holds the point ({}, {}, {}) after a move", to.x, to.y, to.z),
      std::move(replay));
}

Vec3 carried_by_cell(const CellComplex& complex, const ParticleState& state, const VertexMotion& walls) {
  const Corners before = corners_of(complex, state.at(), walls.before);
  const Corners after = corners_of(complex, state.at(), walls.after);
  Vec3 x = state.position;
  if (before == after) return x;
  const Weights weights = detail::barycentric(before, x);
  for (std::size_t k = 0; k < 4; ++k) x += (after[k] - before[k]) * weights[k];
  return in_exact_range(x) ? flushed(x) : state.position;  // else a corner has gone out of range
}

Vec3 on_way(const Vec3& from, const Vec3& to, double share) { return flushed(from + (to - from) * share); }

// Environment::advance() is quick, but it carries a particle along and then walks: a wall may be in that way.
void follow_move(Environment& environment, Particles& particles, std::span<const Vec3> to,
                 std::span<const SimplexId> simplices) {
  const CellComplex& complex = environment.complex();
  const VertexMotion walls = {complex.previous_positions(), complex.positions()};
  const std::vector<ParticleState> before(particles.states().begin(), particles.states().end());
  environment.advance(particles, to);
  std::vector<std::uint32_t> missed;
  Particles moved;
  NearWalls near;
  for (std::uint32_t p = 0; p < to.size(); ++p) {
    if (particles[p].position == to[p]) continue;
    missed.push_back(p);
    const SimplexId at = simplices.empty()
                             ? simplex_after(complex, before[p].cell, before[p].position, to[p], walls, near)
                             : simplices[p];
    if (!environment.add(moved, at, to[p]))
      throw InternalError(fmt::format("joint move: cell {} does not hold the point ({}, {}, {}); please report it",
                                      at.cell.value, to[p].x, to[p].y, to[p].z));
  }
  if (!missed.empty()) particles.replace(missed, moved);
}

double move_together(Environment& environment, std::span<MovePartner* const> partners,
                     std::span<const Vec3> positions) {
  const CellComplex& complex = environment.complex();
  if (positions.size() != complex.point_count())
    throw InvalidArgument(fmt::format("move_with: {} positions for {} points of the mesh: give one for each",
                                      positions.size(), complex.point_count()));
  const auto before = complex.positions();
  AlignedVector<Vec3> after(before.size());
  const VertexMotion walls = {before, after};
  std::copy(positions.begin(), positions.end(), after.begin());
  std::copy(before.begin() + static_cast<std::ptrdiff_t>(positions.size()), before.end(),
            after.begin() + static_cast<std::ptrdiff_t>(positions.size()));
  complex.steiner_weights().compute(after);
  double made = 1.0;
  for (MovePartner* p : partners) made = std::min(made, p->plan(walls));
  for (double share = made; made < 1.0; share *= 0.5) {
    made = share < least_share ? 0.0 : share;
    for (std::size_t p = 0; p < positions.size(); ++p) after[p] = before[p] + (positions[p] - before[p]) * made;
    if (made == 0.0) std::copy(before.begin(), before.end(), after.begin());  // also if the way is not finite
    complex.steiner_weights().compute(after);
    if (std::all_of(partners.begin(), partners.end(), [&](MovePartner* p) { return p->shorten(made, walls); })) break;
  }
  environment.move(std::span<const Vec3>(after).first(positions.size()));
  for (MovePartner* p : partners) p->after_move();
  return made;
}

}  // namespace dartcast
