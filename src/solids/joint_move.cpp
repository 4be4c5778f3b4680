// A joint move: all partners plan; where one has no room for the whole way, walls and partners make one share of theirs.
// The rounded share is checked again, and halved until it is free. Then all move.
#include "solids/joint_move.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "complex/simplex.hpp"
#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"

namespace dartcast {

namespace {

// Whether a simplex holds a point, border included.
bool holds(const CellComplex& complex, SimplexId simplex, std::span<const Vec3> positions, const Vec3& x) {
  const auto vertices = complex.vertices(simplex);
  Corners v;
  for (unsigned i = 0; i < 4; ++i) v[i] = positions[vertices[i].value];
  for (unsigned f = 0; f < 4; ++f) {
    if (orient_facet(v, f, x) == Sign::negative) return false;
  }
  return true;
}

// The first of these cells' simplices that does.
SimplexId holding(const CellComplex& complex, std::span<const Cell> cells, std::span<const Vec3> positions,
                  const Vec3& x) {
  for (const Cell c : cells) {
    const std::size_t count = complex.map().view(c).shape().simplices().size();
    for (std::uint16_t s = 0; s < count; ++s) {
      if (holds(complex, {c, s}, positions, x)) return {c, s};
    }
  }
  return {};
}

}  // namespace

Vec3 on_way(const Vec3& from, const Vec3& to, double share) { return flushed(from + (to - from) * share); }

SimplexId simplex_after(const CellComplex& complex, NearWalls& near, SimplexId before, const Vec3& from, const Vec3& to,
                        const VertexMotion& walls) {
  if (holds(complex, before, walls.after, to)) return before;
  MovingElement point;
  point.from[0] = from;
  point.to[0] = to;
  near.search(complex, before.cell, point, walls);
  const SimplexId found = holding(complex, near.cells_reached(), walls.after, to);
  if (!found.cell.valid())
    throw InternalError(fmt::format("joint move: no cell holds the point ({}, {}, {}) after a move; please report it",
                                    to.x, to.y, to.z));
  return found;
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
    if (made == 0.0) std::copy(before.begin(), before.end(), after.begin());  // also where the way is not finite
    complex.steiner_weights().compute(after);
    if (std::all_of(partners.begin(), partners.end(), [&](MovePartner* p) { return p->shorten(made, walls); })) break;
  }
  for (MovePartner* p : partners) p->before_move(walls);
  environment.move(std::span<const Vec3>(after).first(positions.size()));
  for (MovePartner* p : partners) p->after_move();
  return made;
}

}  // namespace dartcast
