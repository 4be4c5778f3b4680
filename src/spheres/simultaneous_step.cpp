#include "spheres/simultaneous_step.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "dynamics/flat_cells.hpp"
#include "predicates/moving_pair.hpp"
#include "tracking/cells_around.hpp"
#include "tracking/place_in_simplex.hpp"
#include "tracking/space.hpp"

namespace dartcast {

namespace {

// If a point goes on along a wall, it ends this share of the wall's longest side off it. So rounding does not put it
// onto the wall.
constexpr double rest_gap = 0x1p-20;
// Shares of the way to a touch that are left out. A rounded place on the way is the nearer to the wall, the likelier it is
// not proved free.
constexpr std::array<double, 3> left_out = {0x1p-20, 0x1p-10, 0.5};

using WallPlaces = std::array<Vec3, 3>;

WallPlaces corners_at(const CellComplex& complex, const std::array<Vertex, 3>& vertices, double time) {
  const Between places = {complex.previous_positions().data(), complex.positions().data(), time};
  WallPlaces t = {places[vertices[0]], places[vertices[1]], places[vertices[2]]};
  if (complex.map().dimension() == 2) {
    for (Vec3& v : t) v.z = 0.0;
  }
  return t;
}

// Unit, to the free side; 0 where the wall has no area.
Vec3 normal_of(const WallPlaces& t, unsigned dimension) {
  const Vec3 e = t[1] - t[0];
  const Vec3 n = dimension == 2 ? Vec3{-e.y, e.x, 0.0} : cross(t[2] - t[0], e);
  const double length = norm(n);
  return length > 0.0 ? n * (1.0 / length) : Vec3{};
}

// In the plane the third corner is one above the second: the point of the plane touches this triangle where it touches
// the edge.
detail::MovingPair pair_of(const Vec3& from, const Vec3& to, const MovingTriangle& wall, unsigned dimension) {
  detail::MovingPair pair = {{from}, {to}};
  for (std::size_t k = 0; k < 3; ++k) {
    pair.from[k + 1] = flushed(wall.from[k]);
    pair.to[k + 1] = flushed(wall.to[k]);
  }
  if (dimension == 2) pair.from[3].z = pair.to[3].z = 1.0;
  return pair;
}

bool is_apart(const detail::MovingPair& pair) {
  return detail::filtered_touch(pair, detail::PairKind::vertex_face).answer == detail::FilterAnswer::apart;
}

// The vertices that the first wall has in common with all others that share any with it.
std::vector<std::uint16_t> common_points(std::span<const SimultaneousStep::Memory::Touch> met, unsigned dimension) {
  const NearWall& first = met.front().wall;
  const auto has = [](const NearWall& w, Vertex v) {
    return std::find(w.vertex.begin(), w.vertex.end(), v) != w.vertex.end();
  };
  const auto is_beside = [&](const NearWall& w) {
    return std::any_of(first.vertex.begin(), first.vertex.end(), [&](Vertex v) { return has(w, v); });
  };
  const auto common = [&](Vertex v) {
    return std::all_of(met.begin(), met.end(), [&](const auto& m) { return !is_beside(m.wall) || has(m.wall, v); });
  };
  std::vector<std::uint16_t> points;
  for (unsigned k = 0; k < dimension; ++k) {
    if (common(first.vertex[k])) points.push_back(first.local[k]);
  }
  if (points.empty()) points.assign(first.local.begin(), first.local.begin() + dimension);
  return points;
}

}  // namespace

// The state of one point's step.
struct SimultaneousStep::Run {
  std::uint32_t particle;
  ParticleState& state;
  Weights& weights;
  ContactList& contacts;
  Counters& counters;
  Memory& memory;
  SimplexId start;
  unsigned contact_count = 0;
  std::uint32_t first_wall = 0;  // of this point in this step
  std::uint32_t first_here = 0;  // of those at the place of the last contact
  double last_time = -1.0;       // of the last contact
  StepResult result{};
};

// A place before a touch, proved free.
struct SimultaneousStep::Stop {
  double time;
  Vec3 place;
  SimplexId at;
};

StepResult SimultaneousStep::step(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                                  ContactList& contacts, Counters& counters, Memory& memory) const {
  // A particle at a wall is on it, or as near as rounding: the wall carries it.
  if (state.held || state.touching_count > 0)
    return stepper_.step(particle, state, weights, target, contacts, counters);
  Run run{particle, state, weights, contacts, counters, memory, state.at()};
  run.first_wall = static_cast<std::uint32_t>(contacts.walls.size());
  run.first_here = run.first_wall;
  memory.pairs = 0;
  SimultaneousLeg leg{state.at(), state.position, target, 0.0};
  LegEnd end = take(run, leg);
  while (end == LegEnd::goes_on && run.contact_count < options_.max_contacts) end = take(run, leg);
  if (end == LegEnd::arrived) {
    state.touching_count = 0;
    count(run);
    return run.result;
  }
  if (run.contact_count == 0) return stepper_.step(particle, state, weights, target, contacts, counters);
  const bool stays = end == LegEnd::stopped;
  StepState rest;
  rest.begin(particle, state, leg.to, contacts);
  rest.stage = StepStage::carry;
  rest.interval.begin = leg.begin;
  rest.contact_count = run.contact_count;
  rest.first_wall = rest.first_here = run.first_wall;
  rest.last_time = run.last_time;
  rest.result.stopped = stays;  // at the wall that it met last, which carries it
  stepper_.run(rest, {state, weights, contacts, counters});
  if (stays) rest.result.stopped = false;
  if (!stays || rest.result.held) run.result = rest.result;
  return run.result;
}

// If all cells in reach are positive during the move, a point that touches none of the walls there ends at its target. Else
// the cells carry it. A walk that meets no wall and ends there is right in both cases, so no cell is looked at here.
void SimultaneousStep::find_free(std::span<const ParticleState> states, std::span<const Vec3> targets,
                                 std::span<std::uint8_t> free, Memory& memory) const {
  if (all_walls_ != nullptr) return find_free_of_all(states, targets, free, memory);
  const VertexMotion walls = motion_of(memory, 0.0, 1.0);
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (free[i] == 0) continue;
    const auto near = memory.near.search_way(complex_, states[i].cell, states[i].position, targets[i], walls);
    free[i] = std::all_of(near.begin(), near.end(), [&](const NearWall& wall) {
      return is_apart(pair_of(states[i].position, targets[i], wall.corners, complex_.map().dimension()));
    });
  }
}

// Walls with a corner that is not in the exact range are left out, as NearWalls does.
void SimultaneousStep::find_free_of_all(std::span<const ParticleState> states, std::span<const Vec3> targets,
                                        std::span<std::uint8_t> free, Memory& memory) const {
  auto& pairs = memory.ways;
  pairs.clear();
  for (std::uint32_t i = 0; i < states.size(); ++i) {
    if (free[i] != 0) all_walls_->find_near(states[i].position, targets[i], i, pairs);
  }
  const Vec3* before = complex_.previous_positions().data();
  const Vec3* after = complex_.positions().data();
  pairs.resize(detail::keep_undecided(pairs, states.data(), targets.data(), before, after));
  for (const auto& [i, corners] : pairs) {
    MovingTriangle wall;
    bool in_range = true;
    for (std::size_t k = 0; k < 3; ++k) {
      wall.from[k] = before[corners[k]];
      wall.to[k] = after[corners[k]];
      in_range = in_range && in_exact_range(wall.from[k]) && in_exact_range(wall.to[k]);
    }
    if (free[i] != 0 && in_range && !is_apart(pair_of(states[i].position, targets[i], wall, 3))) free[i] = 0;
  }
}

VertexMotion SimultaneousStep::motion_of(Memory& memory, double begin, double end) const {
  const bool whole = begin == 0.0 && end == 1.0;
  if (whole && complex_.map().dimension() == 3) return {complex_.previous_positions(), complex_.positions(), nullptr};
  memory.places.start(complex_, begin, end);
  return {memory.places.before(), memory.places.after(), &memory.places};
}

// Up to the target, or to the next contact and its answer: `leg` is then the next one.
SimultaneousStep::LegEnd SimultaneousStep::take(Run& run, SimultaneousLeg& leg) const {
  Memory& memory = run.memory;
  if (!look(memory, leg, leg.to, 1.0)) return LegEnd::undecided;
  if (memory.touches.empty()) {
    if (run.contact_count > 0 || !walk(run, leg.to)) run.state.put(holding(memory, leg, leg.to, 1.0), leg.to);
    return LegEnd::arrived;
  }
  keep_first_touches(memory);
  const auto stop = stop_before(memory, leg, memory.met.front().time);
  if (!stop && !presses(memory, leg)) return LegEnd::undecided;
  const Contact& contact = describe(run, leg);
  if (stop) {
    run.state.put(stop->at, stop->place);
    leg = {stop->at, stop->place, stop->place, stop->time};
  }
  if (!respond_) {
    run.result.stopped = true;
    run.result.unused = contact.unused;
    return LegEnd::stopped;
  }
  const AfterContact next = respond_(contact, run.contacts.walls_of(contact), run.contacts.earlier_walls_of(contact));
  if (next.displacement == Vec3{}) return LegEnd::stopped;
  leg.to = aim(run, contact, next, leg);
  if (!in_exact_range(leg.to)) {  // no test can be made there
    ++run.counters.unfinished;
    run.result.stopped = true;
    run.result.unused = contact.unused;
    return LegEnd::stopped;
  }
  return stop ? LegEnd::goes_on : LegEnd::on_wall;
}

// Whether a walk of the carried point meets no wall and ends at the target: then it takes the step, as the batch would. If
// several simplices hold the target, it finds the same one.
bool SimultaneousStep::walk(Run& run, const Vec3& target) const {
  ParticleState state = run.state;
  Weights weights = run.weights;
  ContactList contacts;
  Counters counters;
  StepState step;
  step.begin(run.particle, state, target, contacts);
  stepper_.run_to_contact(step, {state, weights, contacts, counters});
  if (step.waits() || state.held || state.position != target) return false;
  run.state = state;
  return true;
}

// The displacement of a wall's point in the whole step: of the one nearest to x at a time.
Vec3 SimultaneousStep::wall_displacement(const NearWall& wall, const Vec3& x, double time) const {
  const WallPlaces before = corners_at(complex_, wall.vertex, 0.0);
  const WallPlaces after = corners_at(complex_, wall.vertex, 1.0);
  const auto nearest = nearest_on_triangle(corners_at(complex_, wall.vertex, time), x);
  Vec3 displacement;
  for (std::size_t k = 0; k < 3; ++k) displacement += (after[k] - before[k]) * nearest.weights[k];
  return displacement;
}

// Whether the point goes towards the wall in `met`, on which it is. Only whether there is a contact now depends on it: in
// both cases the cells carry the point.
bool SimultaneousStep::presses(const Memory& memory, const SimultaneousLeg& leg) const {
  const NearWall& wall = memory.met.front().wall;
  const Vec3 normal = normal_of(corners_at(complex_, wall.vertex, leg.begin), complex_.map().dimension());
  const Vec3 walls = wall_displacement(wall, leg.from, leg.begin) * (1.0 - leg.begin);
  return dot(leg.to - leg.from - walls, normal) < 0.0;
}

// Finds the walls that the point may touch on the way to a place at a time. Returns false where a cell in reach becomes
// flat: they are not known then.
bool SimultaneousStep::search(Memory& memory, const SimultaneousLeg& leg, const Vec3& to, double end) const {
  memory.motion = motion_of(memory, leg.begin, end);
  memory.found = memory.near.search_way(complex_, leg.at.cell, leg.from, to, memory.motion);
  return !first_flat_time(complex_, memory.near.cells_reached(), memory.motion);
}

// The touches on that way. Returns false where they are not known.
bool SimultaneousStep::look(Memory& memory, const SimultaneousLeg& leg, const Vec3& to, double end) const {
  memory.touches.clear();
  if (!search(memory, leg, to, end)) return false;
  for (const NearWall& wall : memory.found) {
    const auto pair = pair_of(leg.from, to, wall.corners, complex_.map().dimension());
    const auto time = detail::first_touch(pair, detail::PairKind::vertex_face);
    if (time) memory.touches.push_back({*time, wall});
  }
  memory.pairs += memory.found.size();
  return true;
}

// Whether that way is proved to touch none.
bool SimultaneousStep::is_proved_free(Memory& memory, const SimultaneousLeg& leg, const Vec3& to, double end) const {
  if (!search(memory, leg, to, end)) return false;
  memory.pairs += memory.found.size();
  return std::none_of(memory.found.begin(), memory.found.end(), [&](const NearWall& wall) {
    return detail::touches(pair_of(leg.from, to, wall.corners, complex_.map().dimension()),
                           detail::PairKind::vertex_face);
  });
}

// The simplex that holds a point at the end of the way that was looked at last, which is free.
SimplexId SimultaneousStep::holding(const Memory& memory, const SimultaneousLeg& leg, const Vec3& x, double end) const {
  const auto positions = memory.motion.after;
  for (const Cell c : memory.near.cells_reached()) {
    const std::size_t count = complex_.map().view(c).shape().simplices().size();
    for (std::uint16_t s = 0; s < count; ++s) {
      const auto v = complex_.vertices({c, s});
      Corners corners = {positions[v[0].value], positions[v[1].value], positions[v[2].value], positions[v[3].value]};
      if (complex_.map().dimension() == 2) corners = raised(corners);
      if (detail::in_closed_simplex(corners, x)) return {c, s};
    }
  }
  std::vector<Vec3> before, after;
  const auto place = [&](double time, Vertex v) {
    return Between{complex_.previous_positions().data(), complex_.positions().data(), time}[v];
  };
  for (std::uint32_t v = 0; v < complex_.map().vertex_count(); ++v) {
    before.push_back(place(leg.begin, Vertex{v}));
    after.push_back(place(end, Vertex{v}));
  }
  ParticleState state;
  state.put(leg.at, leg.from);
  StepReplay replay = detail::replay_of(complex_.map(), {before, after}, state, x, std::array{std::pair{leg.from, x}});
  replay.simultaneous = true;
  throw detail::error_with_replay("advance: no cell in reach holds the end of a free way", std::move(replay));
}

// The walls touched first, into `met`, in the order of time.
void SimultaneousStep::keep_first_touches(Memory& memory) {
  double first = 2.0;
  for (const auto& t : memory.touches) first = std::min(first, t.time);
  memory.met.clear();
  for (const auto& t : memory.touches) {
    if (t.time <= first + share_together) memory.met.push_back(t);
  }
  std::stable_sort(memory.met.begin(), memory.met.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
}

// `time`: of the touch, in the leg. Nothing where the point is on a wall already, or no place is proved free.
std::optional<SimultaneousStep::Stop> SimultaneousStep::stop_before(Memory& memory, const SimultaneousLeg& leg,
                                                                    double time) const {
  for (const double less : left_out) {
    const double share = time * (1.0 - less);
    const double end = leg.begin + share * (1.0 - leg.begin);
    if (!(end > leg.begin)) return {};
    const Vec3 place = flushed(leg.from + (leg.to - leg.from) * share);
    if (is_proved_free(memory, leg, place, end)) return Stop{end, place, holding(memory, leg, place, end)};
  }
  return {};
}

// Records the contact with the walls in `met`.
const Contact& SimultaneousStep::describe(Run& run, const SimultaneousLeg& leg) const {
  const auto& met = run.memory.met;
  const unsigned dimension = complex_.map().dimension();
  const double share = met.front().time;
  Contact& contact = run.contacts.contacts.emplace_back();
  contact.particle = run.particle;
  const double time = leg.begin + share * (1.0 - leg.begin);
  contact.time_of_impact = std::max(time, run.last_time);  // a leg begins before the contact that it comes from
  contact.point = flushed(leg.from + (leg.to - leg.from) * share);
  contact.first_wall = static_cast<std::uint32_t>(run.contacts.walls.size());
  const Vec3 motion = leg.to - leg.from;
  for (const auto& m : met) {
    Vec3 normal = normal_of(corners_at(complex_, m.wall.vertex, time), dimension);
    if (normal == Vec3{}) normal = motion * (-1.0 / std::max(norm(motion), 0x1p-300));
    const auto first = run.contacts.walls.begin() + contact.first_wall;
    const bool known = std::any_of(first, run.contacts.walls.end(), [&](const WallHit& h) {
      constexpr double same_plane = 1.0 - 1e-14;  // as in add_other_walls(): which triangles are listed depends on it
      return h.face == m.wall.face && dot(h.normal, normal) > same_plane;
    });
    if (!known) run.contacts.walls.push_back({m.wall.face, m.wall.triangle, complex_.map().patch(m.wall.face), normal});
  }
  contact.wall_count = static_cast<std::uint32_t>(run.contacts.walls.size()) - contact.first_wall;
  const NearWall& wall = met.front().wall;
  const Shape::Feature feature = complex_.map().shape(wall.face.cell).feature(common_points(met, dimension));
  contact.kind = feature.kind;
  contact.dart = {wall.face.cell, feature.dart};
  contact.wall_displacement = wall_displacement(wall, contact.point, time);
  contact.displacement = motion - contact.wall_displacement * (1.0 - leg.begin);
  contact.unused = contact.displacement * (1.0 - share);
  contact.earlier = contact.first_wall - run.first_wall;
  contact.last = ++run.contact_count >= options_.max_contacts;
  if (time - run.last_time >= share_together) run.first_here = contact.first_wall;
  contact.together = contact.first_wall - run.first_here;
  run.last_time = contact.time_of_impact;
  ++run.counters.contacts[static_cast<std::size_t>(contact.kind)];
  run.state.touching_count = 0;
  for (const WallHit& hit : run.contacts.walls_of(contact)) {
    if (run.state.touching_count < run.state.touching.size()) run.state.touching[run.state.touching_count++] = hit.face;
  }
  return contact;
}

// The target at the end of the step, from the start of a leg. Along walls it is a little off them.
Vec3 SimultaneousStep::aim(const Run& run, const Contact& contact, const AfterContact& next,
                           const SimultaneousLeg& leg) const {
  const Vec3& d = next.displacement;
  if (!is_finite(d))
    throw InvalidArgument("the response for particle " + std::to_string(run.particle) +
                          " returned a displacement that is not finite");
  Vec3 q = flushed(leg.from + d + contact.wall_displacement * (1.0 - leg.begin));
  if (!next.along || !in_exact_range(q)) return q;
  const double slack = along_share * std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
  for (const auto& m : run.memory.met) {
    const WallPlaces t = corners_at(complex_, m.wall.vertex, 1.0);
    const Vec3 normal = normal_of(t, complex_.map().dimension());
    if (!(dot(d, normal) >= -slack)) continue;
    const double side = std::max({norm(t[1] - t[0]), norm(t[2] - t[1]), norm(t[0] - t[2])});
    const double lack = rest_gap * side - dot(normal, q - t[0]);
    if (lack > 0.0) q += normal * lack;
  }
  return flushed(q);
}

void SimultaneousStep::count(const Run& run) const {
  Counters& counters = run.counters;
  const std::uint64_t pairs = run.memory.pairs;
  ++counters.particle_steps;
  counters.orientation.tests += pairs;
  ++counters.histogram[std::min<std::size_t>(pairs, Counters::histogram_size - 1)];
  counters.forecast_kept += run.state.at() == run.start && run.contact_count == 0 ? 1 : 0;
}

}  // namespace dartcast
