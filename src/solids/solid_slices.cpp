// A way of solids in slices, each of them straight, while the walls make equal parts of theirs. All slices are planned
// before a vertex goes. So the simplices that hold the vertices between two slices are found here, by exact signs.
//
// On an arc each solid has a margin. It is the separation that is asked for, or the distance from the walls at the start if
// that is smaller. The chords of slices keep the margin from walls, and the arc leaves them by half of it at most.
#include <algorithm>

#include "base/parallel.hpp"
#include "dartcast/predicates.hpp"
#include "solids/solid_set_impl.hpp"

namespace dartcast {

void SolidSet::Impl::begin_way() {
  slice = 0;
  from = positions;
  simplices.resize(positions.size());
  for (std::size_t v = 0; v < simplices.size(); ++v) simplices[v] = particles[v].at();
}

// How many slices the arcs need.
void SolidSet::Impl::choose_slices(const VertexMotion& walls) {
  constexpr double least_margin = 0x1p-20;  // of the separation: from nearer places arcs are not proved free
  choose_margins(walls);
  double slices = way.slices;
  for (const std::uint32_t s : all_but_stuck()) {
    const auto [bend, separation] = way.arcs[s];
    if (separation > 0.0) slices = std::max(slices, slices_of(bend, std::max(margins[s], least_margin * separation)));
  }
  way.slices = static_cast<unsigned>(std::min(slices, max_slices));
}

void SolidSet::Impl::choose_margins(const VertexMotion& walls) {
  Solids on_arcs = all_but_stuck();
  std::erase_if(on_arcs, [&](std::uint32_t s) { return way.arcs[s].separation == 0.0; });
  for (const std::uint32_t s : on_arcs) margins[s] = way.arcs[s].separation;
  detect(on_arcs, from, {walls.before, walls.before});
  for (const std::uint32_t s : on_arcs) {
    for (const ElementTouch& t : progress[s].touches) margins[s] = std::min(margins[s], kept_share * t.distance);
  }
  if (have_pairs()) leave_margins_to_solids();
}

// The targets of a slice.
void SolidSet::Impl::aim() {
  if (way.slices == 1) return;  // they are those of the step
  for (const std::uint32_t s : all_but_stuck()) {
    const auto mine = of(targets, s);
    const bool last_slice = slice + 1 == way.slices;
    if (!has_stopped(s) && !last_slice) put_on_way(s, (slice + 1.0) / way.slices, mine);
    if (has_stopped(s) || last_slice) {
      const auto place = of(has_stopped(s) ? from : wanted, s);
      std::copy(place.begin(), place.end(), mine.begin());
    }
  }
  check_range(targets, "solids");
}

void SolidSet::Impl::put_on_way(std::uint32_t solid, double share, std::span<Vec3> place) const {
  way.place(solid, share, place);
  std::transform(place.begin(), place.end(), place.begin(), flushed);
}

// The share of its planned way that a solid makes while the walls make this share of theirs.
double SolidSet::Impl::way_made(std::uint32_t solid, double walls_made) const {
  const Stop& stop = stops[solid];
  const double slices_made = walls_made * way.slices;
  if (slices_made <= stop.slice) return slices_made / way.slices;
  return (stop.slice + stop.share * std::min(slices_made - stop.slice, 1.0)) / way.slices;
}

// The way of the walls in one of equal pieces of their way. Pieces are asked for in order.
VertexMotion SolidSet::Impl::walls_in(unsigned piece, unsigned pieces, const VertexMotion& walls) {
  if (pieces == 1 || walls.at_rest()) return walls;
  const bool last_piece = piece + 1 == pieces;
  std::swap(between[0], between[1]);
  if (!last_piece) {
    const double share = (piece + 1.0) / pieces;
    between[1].resize(walls.before.size());
    for (std::size_t p = 0; p < between[1].size(); ++p)
      between[1][p] = walls.before[p] + (walls.after[p] - walls.before[p]) * share;
    environment.complex().steiner_weights().compute(between[1]);
  }
  return {piece == 0 ? walls.before : between[0], last_piece ? walls.after : between[1]};
}

// The next slice starts where this one, which is free, has ended.
void SolidSet::Impl::end_slice(const VertexMotion& walls) {
  if (way.slices == 1) return;
  constexpr std::size_t grain = 64;
  parallel_for(positions.size(), grain, environment.threads(), [&](std::size_t begin, std::size_t end) {
    NearWalls near;
    for (std::size_t v = begin; v < end; ++v) {
      const bool stays = walls.at_rest() && from[v] == reached[v];
      if (!stays && !is_stuck(solid_of(v)))
        simplices[v] = simplex_after(environment.complex(), simplices[v].cell, from[v], reached[v], walls, near);
    }
  });
  from = reached;
}

}  // namespace dartcast
