// The facets that a walk passes, in their order, and at which fractions of the segment.
#pragma once

#include <algorithm>
#include <vector>

#include "tracking/carry.hpp"
#include "tracking/walk.hpp"

namespace dartcast::detail {

struct PassedFacet {
  SimplexId simplex;  ///< that the walk leaves by it
  unsigned facet;
};

/// As dartcast::walk(). `passed`: if a walk ends at a wall that q is beyond, the last facet is the wall. A walk that
/// begins at a wall, and anew from another simplex around p, has passed what the second one does.
template <class Positions, std::size_t N>
Walk walk_listed(const Space<Positions, N>& space, SimplexId start, const Vec3& p, const Vec3& q,
                 std::vector<PassedFacet>& passed) {
  passed.clear();
  const auto list = [&](SimplexId simplex, unsigned facet) { passed.push_back({simplex, facet}); };
  TestCounts counts;
  const Walk first = walk_to_wall(space, start, p, q, counts, list);
  const bool at_wall =
      first.end == WalkEnd::wall && orient_facet(space.corners(first.wall_simplex), first.wall_facet, p) == Sign::zero;
  if (at_wall) passed.clear();
  return end_walk(space, first, p, q, counts, list);
}

/// Where the line leaves by the facet: a fraction of pq, rounded.
template <std::size_t N>
double fraction_at(const std::array<Vec3, N>& v, unsigned facet, const Vec3& p, const Vec3& q) {
  const double height = orient_facet_value(v, facet, p);
  const double below = orient_facet_value(v, facet, q);
  return height <= 0.0 ? 0.0 : std::min(height / (height - below), 1.0);
}

/// Calls piece(cell, fraction) for the cells that a walk passes, with the fraction of the segment where it leaves each;
/// fractions never fall. The last one is where the walk ends: 1 at q.
template <class Positions, std::size_t N, class Piece>
Walk walk_cells(const Space<Positions, N>& space, SimplexId start, const Vec3& p, const Vec3& q,
                std::vector<PassedFacet>& passed, const Piece& piece) {
  const Walk walk = walk_listed(space, start, p, q, passed);
  double fraction = 0.0;
  for (const PassedFacet& at : passed) {
    const CellView cell = space.map->view(at.simplex.cell);
    const ImplicitSimplex& s = cell.shape().simplices()[at.simplex.simplex];
    if (!s.across[at.facet].outer()) continue;
    fraction = std::max(fraction, fraction_at(space.corners(cell, s), at.facet, p, q));
    piece(at.simplex.cell, fraction);
  }
  if (walk.end == WalkEnd::arrived || walk.at_end) piece(walk.simplex.cell, 1.0);
  if (walk.end == WalkEnd::invalid_cell) piece(walk.simplex.cell, fraction);
  if (walk.at_start) piece(walk.wall_simplex.cell, 0.0);
  return walk;
}

}  // namespace dartcast::detail
