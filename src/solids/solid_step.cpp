// A step of solids: detect, correct, cut, commit. docs/method.md, "Solids", has the proofs.
//
//  1. start()               targets; all solids have their whole way before them
//  2. correct_in_rounds()   detect() finds all touches on the way (solid_detection.cpp); correct() moves the targets away from
//                           these walls
//  3. cut_each()            what still touches goes a share of its way, each solid its own. Walls that run into a solid even
//                           so stop, and all solids with them: shorten(). The rounded share is detected again. Then
//                           stop_at_solids() cuts ways that touch each other (solid_pairs.cpp)
//  4. report()
//  5. commit_at_rest(), after_move()   the vertices, which are particles, get there
//
// A way that is not straight (SolidWay) is taken in slices, each with 2 and 3, before the vertices go. The walls make
// equal parts of their way in the meantime. On arcs a wall counts as touched at a distance (solid_slices.cpp).
//
// With moving walls solids are partners of a joint move (joint_move.hpp), which calls the phases.
//
// Whole solids are cut, because a part of a straight motion that is proved free is free. To stop vertices one by one
// would make another motion, without a proof.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <tuple>
#include <utility>

#include "base/parallel.hpp"
#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "solids/solid_set_impl.hpp"
#include "tracking/cells_around.hpp"

namespace dartcast {

namespace {

constexpr double least_share_among_moving_walls = 0x1p-10;
constexpr double pressing_share = 2.0;  // of the separation: a contact with a larger gap at the end has no effect

void check(const SolidStepOptions& o, const char* caller) {
  if (o.iterations == 0) throw InvalidArgument(fmt::format("{}: iterations is 0: give at least 1", caller));
  if (!(o.separation >= 0.0) || !std::isfinite(o.separation))
    throw InvalidArgument(
        fmt::format("{}: separation is {}: give a finite length of at least 0", caller, o.separation));
}

// By solid, then by time. A pair that was found in several rounds counts once, as it was found first.
void sort_and_join(std::vector<SolidContact>& contacts) {
  const auto by_pair = [](const SolidContact& c) {
    return std::tie(c.solid, c.kind, c.vertices, c.wall_kind, c.dart, c.triangle);
  };
  std::stable_sort(contacts.begin(), contacts.end(),
                   [&](const SolidContact& a, const SolidContact& b) { return by_pair(a) < by_pair(b); });
  const auto same = [&](const SolidContact& a, const SolidContact& b) { return by_pair(a) == by_pair(b); };
  contacts.erase(std::unique(contacts.begin(), contacts.end(), same), contacts.end());
  std::stable_sort(contacts.begin(), contacts.end(), [](const SolidContact& a, const SolidContact& b) {
    return std::tie(a.solid, a.time_of_impact) < std::tie(b.solid, b.time_of_impact);
  });
}

// The vertex's way as a step of a particle that nothing answers.
[[noreturn]] void throw_met_wall(Environment& environment, std::size_t vertex, const Vec3& from, const Vec3& to) {
  ParticleState state;
  state.put(environment.locate(from).simplex, from);
  const CellComplex& complex = environment.complex();
  throw detail::error_with_replay(fmt::format("solids: vertex {} met a wall on a way that was proved free", vertex),
                                  detail::replay_of(complex.map(), {complex.positions(), complex.positions()}, state,
                                                    to, std::array{std::pair{from, to}}));
}

}  // namespace

SolidSet::Impl::Solids SolidSet::Impl::all_but_stuck() const {
  Solids solids;
  for (std::uint32_t s = 0; s < count(); ++s) {
    if (!is_stuck(s)) solids.push_back(s);
  }
  return solids;
}

void SolidSet::Impl::check_range(std::span<const Vec3> given, const char* caller) {
  const auto bad = std::find_if_not(given.begin(), given.end(), in_exact_range);
  if (bad != given.end())
    throw InvalidArgument(fmt::format("{}: the target of vertex {} is not finite or outside the exact range", caller,
                                      bad - given.begin()));
}

// All that may touch a wall.
SolidSet::Impl::Solids SolidSet::Impl::movers(const VertexMotion& walls) const {
  Solids solids = all_but_stuck();
  if (!walls.at_rest()) return solids;
  std::erase_if(solids, [&](std::uint32_t s) {
    return std::equal(from.begin() + first_vertex[s], from.begin() + first_vertex[s + 1],
                      targets.begin() + first_vertex[s]);
  });
  return solids;
}

void SolidSet::Impl::start(SolidWay given, const SolidStepOptions& options, const char* caller) {
  check(options, caller);
  check_current(caller);
  if (given.targets.size() != positions.size())
    throw InvalidArgument(fmt::format("{}: {} targets for {} vertices: give one for each", caller, given.targets.size(),
                                      positions.size()));
  check_range(given.targets, caller);
  way = std::move(given);
  step_options = options;
  wanted.resize(positions.size());
  std::transform(way.targets.begin(), way.targets.end(), wanted.begin(), flushed);
  targets = wanted;
  uncorrected.resize(positions.size());
  stops.assign(count(), no_stop);
  margins.assign(count(), 0.0);
  shares.assign(count(), 1.0);
  first_touches.clear();
  meetings.clear();
  begin_way();
  progress.resize(count());
  for (Progress& p : progress) p.constraints.clear();
  pairs_before = pairs_so_far();
  last = {};
  last.made.assign(count(), 1.0);
  for (const SolidPlacement& p : stuck) {  // no part of a step moves these
    stops[p.solid] = {};
    last.made[p.solid] = 0.0;
    last.held.push_back(p.solid);
    const auto place = of(positions, p.solid);
    std::copy(place.begin(), place.end(), of(targets, p.solid).begin());
  }
}

// At the end `open` has the solids whose way is still not free. If a cell that becomes flat is all that is in a solid's
// way, no correction helps.
void SolidSet::Impl::correct_in_rounds(Solids& open, const VertexMotion& walls, const SolidStepOptions& options) {
  Solids not_helped;
  for (unsigned round = 0;; ++round) {
    if (round == 0) detect(open, targets, walls);
    if (round > 0) detect_corrected(open, walls);
    std::erase_if(open, [&](std::uint32_t s) { return progress[s].is_free(); });
    if (round == options.rounds) break;
    const auto has_touches = [&](std::uint32_t s) { return !progress[s].touches.empty(); };
    const auto others = std::stable_partition(open.begin(), open.end(), has_touches);
    not_helped.insert(not_helped.end(), others, open.end());
    open.erase(others, open.end());
    if (open.empty()) break;
    last.rounds = round + 1;
    parallel_for(open.size(), 1, environment.threads(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) correct(open[i], options);
    });
  }
  open.insert(open.end(), not_helped.begin(), not_helped.end());
  std::sort(open.begin(), open.end());
}

// Adds the constraints that the last detection found, and sweeps over all so far (Gauss-Seidel). Targets that leave the range of numbers are taken back.
void SolidSet::Impl::correct(std::uint32_t solid, const SolidStepOptions& options) {
  Progress& p = progress[solid];
  const std::span<Vec3> mine = of(targets, solid);
  std::copy(mine.begin(), mine.end(), of(uncorrected, solid).begin());
  const SolidMotion motion = {from, targets};
  for (std::size_t i = p.known_touches; i < p.touches.size(); ++i) {
    const SolidConstraint c = constraint_of(p.touches[i], motion, options.separation, longest[solid]);
    if (!c.is_exit) p.constraints.push_back(c);
  }
  for (unsigned i = 0; i < options.iterations; ++i) {
    for (SolidConstraint& c : p.constraints) satisfy(c, targets, inverse_masses);
  }
  const bool good = std::all_of(mine.begin(), mine.end(), in_exact_range);
  if (good) std::transform(mine.begin(), mine.end(), mine.begin(), flushed);
  if (!good) std::copy_n(wanted.begin() + first_vertex[solid], mine.size(), mine.begin());
}

// Where a share of the slice takes a solid.
void SolidSet::Impl::go(std::uint32_t solid, double share) {
  shares[solid] = share;
  if (way.place && share > 0.0 && share < 1.0 && !has_stopped(solid))
    return put_on_way(solid, (slice + share) / way.slices, of(reached, solid));
  for (std::uint32_t v = first_vertex[solid]; v < first_vertex[solid + 1]; ++v)
    reached[v] = share == 0.0 ? from[v] : share == 1.0 ? targets[v] : on_way(from[v], targets[v], share);
}

void SolidSet::Impl::keep_first_touches(const Solids& cut, const SolidStepOptions& options) {
  for (const std::uint32_t s : cut) {
    const Progress& p = progress[s];
    const auto earlier = [](const ElementTouch& a, const ElementTouch& b) { return a.time < b.time; };
    const auto first = std::min_element(p.touches.begin(), p.touches.end(), earlier);
    if (p.flat_time == 0.0 && slice == 0) last.held.push_back(s);
    if (first == p.touches.end() || p.flat_time < first->time) continue;
    first_touches.push_back(constraint_of(*first, {from, targets, margins[s]}, options.separation, longest[s]));
    first_touches.back().slice = slice;
  }
}

// Makes the ways of these solids shorter until they meet no wall, from the shares that they have. At the end `open` has
// those that walls run into even if they stay.
void SolidSet::Impl::cut_each(Solids& open, const VertexMotion& walls) {
  const double least = walls.at_rest() ? least_share : least_share_among_moving_walls;
  Solids squeezed;
  while (!open.empty()) {
    for (const std::uint32_t s : open) go(s, shares[s] < least ? 0.0 : shares[s]);
    if (walls.at_rest()) std::erase_if(open, [&](std::uint32_t s) { return shares[s] == 0.0; });
    detect(open, reached, walls);
    std::erase_if(open, [&](std::uint32_t s) { return progress[s].is_free(); });
    std::copy_if(open.begin(), open.end(), std::back_inserter(squeezed),
                 [&](std::uint32_t s) { return shares[s] == 0.0; });
    std::erase_if(open, [&](std::uint32_t s) { return shares[s] == 0.0; });
    for (const std::uint32_t s : open) shares[s] *= 0.5;
  }
  open = std::move(squeezed);
}

// The way so far, and where walls stop: at one share of their ways, with all solids.
bool SolidSet::Impl::shorten(double share, const VertexMotion& walls) {
  const Solids all = all_but_stuck();
  last.walls_made = share;
  begin_way();
  const auto pieces = static_cast<unsigned>(std::max(1.0, std::ceil(share * way.slices)));
  for (unsigned piece = 0; piece < pieces; ++piece) {
    for (const std::uint32_t s : all) go_on(s, share * ((piece + 1.0) / pieces));
    if (share == 0.0) return true;
    const VertexMotion now = walls_in(piece, pieces, walls);
    detect(all, reached, now);
    if (!std::all_of(all.begin(), all.end(), [&](std::uint32_t s) { return progress[s].is_free(); })) return false;
    if (have_pairs() && !touching_pairs(reached).empty()) return false;
    end_slice(now);
  }
  return true;
}

// Where the planned way takes a solid while the walls make this share of theirs.
void SolidSet::Impl::go_on(std::uint32_t solid, double walls_made) {
  const double made = last.made[solid] = way_made(solid, walls_made);
  if (way.place && made > 0.0) return put_on_way(solid, made, of(reached, solid));
  for (std::uint32_t v = first_vertex[solid]; v < first_vertex[solid + 1]; ++v)
    reached[v] = made == 0.0 ? positions[v] : on_way(positions[v], targets[v], walls_made);
}

void SolidSet::Impl::commit_at_rest() {
  if (way.slices > 1) follow_move(environment, particles, reached, ends());
  if (way.slices == 1) environment.advance(particles, reached);
  for (std::size_t v = 0; v < reached.size(); ++v) {
    if (particles[v].position != reached[v]) throw_met_wall(environment, v, positions[v], reached[v]);
  }
  positions = reached;
}

void SolidSet::Impl::after_move() {
  report();
  if (stuck.empty()) {
    follow_move(environment, particles, reached, ends());
  } else {
    move_all_but_stuck();
  }
  for (std::size_t v = 0; v < positions.size(); ++v) positions[v] = particles[v].position;
  report_meetings();
}

// Contacts that press at the end, and those that stopped a solid; by solid, then by time, each pair once.
void SolidSet::Impl::report() {
  const auto describe = [&](const SolidConstraint& c, std::uint32_t solid) {
    const double walls_made = last.walls_made * way.slices - c.slice;  // in multiples of that slice
    SolidContact contact = contact_of(c, environment.map(), {positions, wanted}, reached, walls_made);
    contact.solid = solid;
    contact.time_of_impact = (c.slice + c.touch.time) / way.slices;
    contact.wall_displacement = contact.wall_displacement * way.slices;
    for (unsigned i = 0; i < contact.count; ++i) contact.vertices[i] -= first_vertex[solid];
    return contact;
  };
  for (std::uint32_t s = 0; s < count(); ++s) {
    bool corrected = false;
    for (const SolidConstraint& c : progress[s].constraints) {
      if (!(c.pressed > 0.0)) continue;
      corrected = true;
      const SolidContact contact = describe(c, s);
      if (contact.gap <= pressing_share * c.separation) last.contacts.push_back(contact);
    }
    last.corrected += corrected ? 1 : 0;
    last.cut += last.made[s] < 1.0 && !is_stuck(s) ? 1 : 0;
  }
  for (const SolidConstraint& c : first_touches) last.contacts.push_back(describe(c, solid_of(c.touch.vertices[0])));
  std::sort(last.held.begin(), last.held.end());
  sort_and_join(last.contacts);
  last.pairs = pairs_so_far() - pairs_before;
}

void SolidSet::Impl::advance(SolidWay given, const SolidStepOptions& options) {
  start(std::move(given), options, "advance");
  const auto rest = environment.complex().positions();
  plan({rest, rest});
  report();
  commit_at_rest();
  report_meetings();
}

void SolidSet::Impl::prepare(SolidWay given, const SolidStepOptions& options) {
  start(std::move(given), options, "move_with");
}

double SolidSet::Impl::plan(const VertexMotion& walls) {
  double walls_made = 1.0;
  if (!way.arcs.empty()) choose_slices(walls);
  for (; slice < way.slices && walls_made == 1.0; ++slice) {
    const VertexMotion now = walls_in(slice, way.slices, walls);
    aim();
    const double share = plan_slice(now);
    for (std::uint32_t s = 0; s < count(); ++s) {
      if (shares[s] < 1.0 && !has_stopped(s)) stops[s] = {slice, shares[s]};
    }
    if (share < 1.0) walls_made = (slice + share) / way.slices;
    if (share == 1.0) end_slice(now);
  }
  targets = reached;
  for (std::uint32_t s = 0; s < count(); ++s) last.made[s] = way_made(s, 1.0);
  return walls_made;
}

// Returns the share of the slice up to which walls need not stop.
double SolidSet::Impl::plan_slice(const VertexMotion& walls) {
  Solids open = movers(walls);
  shares.assign(count(), 1.0);
  correct_in_rounds(open, walls, step_options);
  reached = targets;
  keep_first_touches(open, step_options);
  for (const std::uint32_t s : open) shares[s] = cut_share * progress[s].free_until();
  cut_each(open, walls);
  if (have_pairs()) stop_at_solids(open, walls);
  double share = 1.0;
  for (const std::uint32_t s : open) share = std::min(share, cut_share * progress[s].free_until());
  return share;
}

}  // namespace dartcast
