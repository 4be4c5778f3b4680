#include "dartcast/environment.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <utility>

#include "base/parallel.hpp"
#include "complex/simplex.hpp"
#include "complex/steiner_points.hpp"
#include "dartcast/error.hpp"
#include "dartcast/mesh_check.hpp"
#include "tracking/batch/batch_plane.hpp"
#include "tracking/representable_point.hpp"

namespace dartcast {

namespace {

constexpr std::size_t chunk = detail::max_batch;

// Returns the point as decisions see it.
Vec3 checked_point(const Vec3& x, const char* what, std::size_t index, unsigned dimension) {
  if (!in_exact_range(x))
    throw InvalidArgument(
        fmt::format("{} {} is ({}, {}, {}): coordinates must be finite, and at most 2^300 in magnitude", what, index,
                    x.x, x.y, x.z));
  const Vec3 point = flushed(x);
  if (dimension == 2 && point.z != 0.0)
    throw InvalidArgument(fmt::format("{} {} is ({}, {}, {}): in the plane z must be 0", what, index, x.x, x.y, x.z));
  return point;
}

bool is_particle_position(const CombinatorialMap& map, const Vec3& x) {
  return in_exact_range(x) && flushed(x) == x && (map.dimension() == 3 || x.z == 0.0);
}

Threads checked(Threads threads) {
  check_threads(threads);
  return threads;
}

MeshData checked_mesh(MeshData mesh) {
  const MeshReport report = check_and_repair(mesh);
  if (!report.defects.empty()) {
    const Finding& f = report.defects.front();
    throw InvalidMesh(fmt::format("{}: {}, the first: {}", f.message, f.count, fmt::join(f.first, ", ")));
  }
  return mesh;
}

// The next step, from i on, that was not taken as a whole. Most were: four are looked at together.
std::size_t next_deferred(std::span<const detail::StepStatus> taken, std::size_t i) {
  static_assert(sizeof(detail::StepStatus) == 2 && detail::step_complete == 0xffff);
  for (std::uint64_t four = 0; i + 4 <= taken.size(); i += 4) {
    std::memcpy(&four, &taken[i], sizeof four);
    if (four != ~std::uint64_t{0}) break;
  }
  while (i < taken.size() && taken[i] == detail::step_complete) ++i;
  return i;
}

bool names_simplex(const CombinatorialMap& map, SimplexId s) {
  return map.contains(s.cell) && s.simplex < map.shape(s.cell).simplices().size();
}

// Whether x lies in a closed simplex that is positive and of a free cell.
bool holds(const CellComplex& complex, SimplexId s, const Vec3& x) {
  if (!names_simplex(complex.map(), s) || !complex.map().is_free(s.cell)) return false;
  const Corners v = complex.corners(s);
  return volume_sign(v) == Sign::positive && detail::in_closed_simplex(v, x);
}

bool is_wall(const CombinatorialMap& map, CellFace f) {
  return map.contains(f.cell) && f.face < map.shape(f.cell).face_count() && map.view(f.cell).is_wall(f.face);
}

bool are_weights(const Weights& w) {
  return std::all_of(w.begin(), w.end(), [](double c) { return c >= 0.0 && c <= 1.0; });
}

bool can_be(const CellComplex& complex, const ParticleState& s, const Weights& weights) {
  if (!is_particle_position(complex.map(), s.position)) return false;
  if (s.touching_count > s.touching.size()) return false;
  for (unsigned i = 0; i < s.touching_count; ++i) {
    if (!is_wall(complex.map(), s.touching[i])) return false;
  }
  if (s.held) return names_simplex(complex.map(), s.at()) && are_weights(weights);
  return holds(complex, s.at(), s.position);
}

}  // namespace

// 0 is nobody's: sets that no environment has touched have it.
std::uint64_t Environment::next_id() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

Environment::Environment(MeshData mesh, Threads threads)
    : complex_(checked_mesh(std::move(mesh)), checked(threads)), threads_(threads) {
  const auto& invalid = complex_.invalid_cells();
  if (invalid.empty()) return;
  throw InvalidMesh(fmt::format("{} cells can't be divided into positive simplices; the first: {}; mend or remesh them",
                                invalid.size(), invalid.front().message));
}

Location Environment::locate(const Vec3& x) { return locate(std::span<const Vec3>(&x, 1)).front(); }

std::vector<Location> Environment::locate(std::span<const Vec3> points) {
  std::vector<Vec3> places(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) places[i] = checked_point(points[i], "point", i, map().dimension());
  if (!locator_) locator_ = std::make_unique<Locator>(complex_);
  std::vector<std::pair<std::size_t, std::size_t>> order(points.size());  // by bin: bin, point
  for (std::size_t i = 0; i < points.size(); ++i) order[i] = {locator_->bin(places[i]), i};
  std::sort(order.begin(), order.end());
  std::vector<Location> locations(points.size());
  parallel_for(points.size(), chunk, threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t point = order[i].second;
      locations[point] = locator_->locate(complex_, places[point]);
    }
  });
  return locations;
}

// An empty set fits any environment, at any time. What it kept beside earlier particles must not be read.
void Environment::take_in(Particles& particles) const {
  if (particles.size() > 0) return;
  particles = {};
  particles.environment_ = id_;
  particles.moves_ = moves_;
  particles.edits_ = edits_;
}

void Environment::check_known(const Particles& particles, const char* call) const {
  if (particles.size() == 0) return;
  if (particles.environment_ != id_)
    throw InvalidArgument(fmt::format(
        "{}: the particles are of another environment: add() their positions to a new set in this one", call));
  const bool missed_move = particles.moves_ + 1 < moves_;
  if (!missed_move && particles.edits_ + 1 >= edits_) return;
  throw InvalidArgument(
      fmt::format("{}: the particles missed {} and cannot catch up: add() their positions to a new set; {}", call,
                  missed_move ? "a move" : "an edit",
                  missed_move ? "after each move advance every set, or follow() a later edit, before the next move"
                              : "follow() each edit with every set before the next edit"));
}

void Environment::check_edit_followed(const Particles& particles, const char* call) const {
  check_known(particles, call);
  if (particles.size() > 0 && particles.edits_ != edits_)
    throw InvalidArgument(fmt::format("{}: follow() the last edit with these particles first", call));
}

void Environment::check_current(Particles& particles) const {
  take_in(particles);
  check_edit_followed(particles, "add");
  if (particles.moves_ != moves_)
    throw InvalidArgument("add: advance the particles first, they have not followed the last move");
}

std::vector<AddResult> Environment::add(Particles& particles, std::span<const Vec3> positions) {
  check_current(particles);
  const std::vector<Location> locations = locate(positions);
  std::vector<AddResult> added(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    added[i].location = locations[i];
    if (locations[i].place != Place::free) continue;
    added[i].particle = static_cast<std::uint32_t>(particles.size());
    add_to(particles, locations[i].simplex, flushed(positions[i]));
  }
  return added;
}

void Environment::add_to(Particles& particles, SimplexId simplex, const Vec3& position) const {
  particles.index_.reset();
  particles.states_.emplace_back().put(simplex, position);
  particles.weights_.emplace_back();
  const auto& vertices = particles.vertices_.emplace_back(detail::vertex_numbers(complex_, simplex));
  if (particles.cache_kind_ != detail::CacheKind::none)
    particles.caches_.push_back(
        detail::cache_entry_of(particles.cache_kind_, complex_.positions(), vertices, position));
}

bool Environment::add(Particles& particles, SimplexId simplex, const Vec3& position) {
  check_current(particles);
  const Vec3 place = flushed(position);
  if (!is_particle_position(map(), place) || !holds(complex_, simplex, place)) return false;
  add_to(particles, simplex, place);
  return true;
}

Particles Environment::restored(std::span<const ParticleState> states, std::span<const Weights> weights) const {
  if (weights.size() != states.size()) throw InvalidArgument("restored: one set of weights per state is needed");
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (!can_be(complex_, states[i], weights[i]))
      throw InvalidArgument(
          fmt::format("restored: the state of particle {} is not one of this environment as it stands", i));
  }
  Particles particles;
  take_in(particles);
  particles.states_.assign(states.begin(), states.end());
  particles.weights_.assign(weights.begin(), weights.end());
  for (const ParticleState& s : states) particles.vertices_.push_back(detail::vertex_numbers(complex_, s.at()));
  return particles;
}

void Environment::set_threads(Threads threads) { threads_ = checked(threads); }

void Environment::move() {
  complex_.commit_positions();
  locator_.reset();
  ++moves_;
}

void Environment::check_positions(std::span<const Vec3> positions) const {
  if (positions.size() != complex_.point_count())
    throw InvalidArgument(fmt::format("move: {} positions for {} points", positions.size(), complex_.point_count()));
  if (map().dimension() != 2) return;
  const auto out = std::find_if(positions.begin(), positions.end(), [](const Vec3& x) { return flushed(x).z != 0.0; });
  if (out != positions.end())
    throw InvalidArgument(fmt::format("move: point {} goes to ({}, {}, {}): in the plane z must be 0",
                                      out - positions.begin(), out->x, out->y, out->z));
}

std::vector<Vec3> Environment::with_steiner_points(std::span<const Vec3> positions) const {
  check_positions(positions);
  std::vector<Vec3> all(positions.begin(), positions.end());
  all.resize(complex_.positions().size());
  complex_.steiner_weights().compute(all);
  return all;
}

std::optional<CellInversion> Environment::first_inversion(std::span<const Vec3> positions) const {
  return dartcast::first_inversion(map(), complex_.positions(), with_steiner_points(positions), threads_);
}

double Environment::move_until_inverted(std::span<const Vec3> positions, double share) {
  const std::vector<Vec3> after = with_steiner_points(positions);
  const auto inversion = dartcast::first_inversion(map(), complex_.positions(), after, threads_);
  if (!inversion) {
    move(positions);
    return 1.0;
  }
  std::vector<Vec3> reached(after.size());
  const double time = move_towards(map(), complex_.steiner_weights(), complex_.positions(), after,
                                   share * inversion->how.safe_time, reached, threads_);
  move(std::span<const Vec3>(reached).first(positions.size()));
  return time;
}

void Environment::move(std::span<const Vec3> positions) {
  check_positions(positions);
  std::copy(positions.begin(), positions.end(), next_positions().begin());
  move();
}

ComplexEditReport Environment::edit(const std::function<void(ComplexEdit&)>& make) {
  ComplexEdit edit(complex_);
  make(edit);
  last_edit_ = edit.commit();
  ++edits_;
  moves_at_edit_ = moves_;
  locator_.reset();
  return last_edit_;
}

std::vector<Vec3> Environment::check_targets(const Particles& particles, std::span<const Vec3> targets) const {
  if (targets.size() != particles.size())
    throw InvalidArgument(fmt::format("advance: {} targets for {} particles", targets.size(), particles.size()));
  const bool plane = map().dimension() == 2;
  std::vector<std::uint8_t> good(chunk_count(targets.size(), chunk));
  parallel_for(targets.size(), chunk, threads_, [&](std::size_t begin, std::size_t end) {
    const std::span<const Vec3> some = targets.subspan(begin, end - begin);
    good[begin / chunk] = detail::all_as_decided(some) &&
                          (!plane || std::all_of(some.begin(), some.end(), [](const Vec3& q) { return q.z == 0.0; }));
  });
  if (std::all_of(good.begin(), good.end(), [](std::uint8_t g) { return g != 0; })) return {};
  std::vector<Vec3> decided(targets.size());
  for (std::size_t i = 0; i < targets.size(); ++i)
    decided[i] = checked_point(targets[i], "the target of particle", i, map().dimension());
  return decided;
}

void Environment::check_advance(const Particles& particles, const StepOptions& options, const char* caller) const {
  check_edit_followed(particles, caller);
  check(options, caller);
}

namespace {

// Those of consecutive particles.
StepReport joined(std::vector<StepReport> parts) {
  if (parts.size() == 1) return std::move(parts.front());
  std::size_t contacts = 0;
  std::size_t walls = 0;
  for (const StepReport& part : parts) {
    contacts += part.contacts.contacts.size();
    walls += part.contacts.walls.size();
  }
  StepReport report;
  report.contacts.contacts.reserve(contacts);
  report.contacts.walls.reserve(walls);
  for (const StepReport& part : parts) {
    report.contacts.append(part.contacts);
    report.held.insert(report.held.end(), part.held.begin(), part.held.end());
    report.stopped.insert(report.stopped.end(), part.stopped.begin(), part.stopped.end());
    report.counters += part.counters;
  }
  return report;
}

}  // namespace

// One call of advance().
struct Environment::Steps {
  Particles& particles;
  std::span<const Vec3> targets;
  Stepper stepper;
  detail::BatchScene filtered;
};

void Environment::step_chunk(const Steps& steps, std::size_t begin, std::size_t end, StepReport& part) const {
  const std::size_t size = end - begin;
  const std::span<ParticleState> states = std::span(steps.particles.states_).subspan(begin, size);
  const std::span<const Vec3> targets = steps.targets.subspan(begin, size);
  std::array<detail::StepStatus, chunk> taken;
  std::vector<PartialStep> partial;
  partial.reserve(size);
  std::vector<WallImpact> impacts;
  const std::span<detail::VertexNumbers> vertices = std::span(steps.particles.vertices_).subspan(begin, size);
  detail::SimplexCache& caches = steps.particles.caches_;
  const detail::BatchSteps batch{states,  vertices, caches.from(begin), targets, std::span(taken).first(size),
                                 partial, impacts};
  if (map().dimension() == 2)
    detail::step_plane(steps.filtered, batch, part.counters);
  else
    detail::step_batch(steps.filtered, batch, part.counters);
  part.contacts.contacts.reserve(partial.size());
  part.contacts.walls.reserve(3 * partial.size());  // at a corner there are several
  part.stopped.reserve(partial.size());
  for (std::size_t i = next_deferred(batch.taken, 0); i < size; i = next_deferred(batch.taken, i + 1)) {
    const auto particle = static_cast<std::uint32_t>(begin + i);
    const PartialStep* const first = taken[i] == detail::step_untouched ? nullptr : &partial[taken[i]];
    const StepResult result = steps.stepper.step(particle, states[i], steps.particles.weights_[particle], targets[i],
                                                 part.contacts, part.counters, first);
    if (result.held) part.held.push_back({particle, result.invalid_cell});
    if (result.stopped) part.stopped.push_back({particle, result.unused});
    if (first != nullptr && first->stays(states[i])) continue;
    vertices[i] = detail::vertex_numbers(complex_, states[i].at());
    if (steps.particles.cache_kind_ == detail::CacheKind::previous_geometry)
      caches.put(begin + i, detail::cache_entry_of(detail::CacheKind::previous_geometry, complex_.positions(),
                                                   vertices[i], states[i].position));
    else if (!caches.empty())
      caches.forget(begin + i);
  }
}

void Environment::step_all(const Steps& steps, std::vector<StepReport>& parts) const {
  parallel_for(steps.targets.size(), chunk, threads_,
               [&](std::size_t begin, std::size_t end) { step_chunk(steps, begin, end, parts[begin / chunk]); });
}

// Coordinates are made from the second step in a row in which nothing has moved.
detail::CacheKind Environment::cache_kind(const Particles& particles, bool moved) const {
  if (map().dimension() == 2) return detail::CacheKind::none;
  if (moved) return detail::CacheKind::previous_geometry;
  return particles.stood_still_ ? detail::CacheKind::barycentric : detail::CacheKind::none;
}

StepReport Environment::advance(Particles& particles, std::span<const Vec3> targets, const ContactCallback& respond,
                                const StepOptions& options) {
  const std::vector<Vec3> decided = check_targets(particles, targets);
  check_advance(particles, options, "advance");
  const bool moved = particles.moves_ != moves_;
  const detail::CacheKind kind = cache_kind(particles, moved);
  const bool caches_match = kind == particles.cache_kind_;
  const Steps steps{particles,
                    decided.empty() ? targets : std::span<const Vec3>(decided),
                    Stepper(complex_, moved, options, respond),
                    {&complex_, moved, caches_match, options.tolerance, !particles.walls_changed_}};
  std::vector<StepReport> parts(chunk_count(particles.size(), chunk));
  particles.index_.reset();
  take_in(particles);
  const Particles before = respond ? particles : Particles{};  // a response is the caller's code: it may throw
  particles.cache_kind_ = kind;
  particles.caches_.resize(kind == detail::CacheKind::none ? 0 : particles.size());
  particles.stood_still_ = !moved;
  particles.walls_changed_ = false;
  if (respond) {
    try {
      step_all(steps, parts);
    } catch (...) {
      particles = before;
      throw;
    }
  } else {
    step_all(steps, parts);
  }
  particles.moves_ = moves_;
  return joined(std::move(parts));
}

std::vector<Trace> Environment::trace(const Particles& particles, std::size_t particle, std::span<const Vec3> targets,
                                      const ContactCallback& respond, const StepOptions& options) const {
  std::vector<Vec3> decided;
  for (std::size_t i = 0; i < targets.size(); ++i)
    decided.push_back(checked_point(targets[i], "target", i, map().dimension()));
  if (particle >= particles.size())
    throw InvalidArgument(fmt::format("trace: there is no particle {} among {}", particle, particles.size()));
  check_advance(particles, options, "trace");
  bool moved = particles.moves_ != moves_;
  ParticleState state = particles[particle];
  Weights weights = particles.weights_[particle];
  std::vector<Trace> traces;
  for (const Vec3& target : decided) {
    Trace& trace = traces.emplace_back();
    trace.before = state;
    trace.start = forecast(map(), state, moved ? complex_.previous_corners(state.at()) : complex_.corners(state.at()));
    trace.result =
        Stepper(complex_, moved, options, respond)
            .trace(static_cast<std::uint32_t>(particle), state, weights, target, trace.contacts, trace.crossings);
    trace.after = state;
    trace.end = forecast(map(), state, complex_.corners(state.at()));
    if (trace.result.stopped || trace.result.held) break;
    moved = false;
  }
  return traces;
}

}  // namespace dartcast
