// The environment: moves, edits and queries, and checks of sets of particles. The steps themselves are in tracking/.
#include "dartcast/environment.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <utility>

#include "base/parallel.hpp"
#include "complex/periodic_faces.hpp"
#include "complex/simplex.hpp"
#include "complex/steiner_points.hpp"
#include "dartcast/cell_tally.hpp"
#include "dartcast/error.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/validity.hpp"
#include "environment/addition.hpp"
#include "environment/environment_members.hpp"
#include "environment/particle_details.hpp"
#include "environment/watched_step.hpp"
#include "response/library_response.hpp"
#include "tracking/batch/batch_stepper.hpp"
#include "tracking/checked_point.hpp"
#include "tracking/representable_point.hpp"

namespace dartcast {

namespace {

constexpr std::size_t most_particles = 0xffffffffU;  // their numbers have 32 bits, and the last is no particle
constexpr std::size_t chunk = 1024;                  // points located by one thread at a time

// 0 is nobody's: sets that no environment has touched have it.
std::uint64_t next_id() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

bool is_particle_position(const CombinatorialMap& map, const Vec3& x) {
  return in_exact_range(x) && flushed(x) == x && (map.dimension() == 3 || x.z == 0.0);
}

Threads checked(Threads threads) {
  check_threads(threads);
  return threads;
}

[[noreturn]] void refuse(const Finding& f) {
  throw InvalidMesh(fmt::format("{}: {}, the first: {}", f.message, f.count, fmt::join(f.first, ", ")));
}

// Checks the values that its owner has set for the particles of the next step.
void check_tallied(const detail::Tallied& tallied, std::size_t count, const char* caller) {
  const auto& [numbers, classes, amounts] = tallied.particles;
  const auto check_size = [&](std::size_t given, std::size_t width, const char* what) {
    if (given != 0 && given != count * width)
      throw InvalidArgument(fmt::format("{}: the tally has {} {} for {} particles, not {}: call set_tally() again",
                                        caller, given, what, count, count * width));
  };
  check_size(numbers.size(), 1, "numbers");
  check_size(classes.size(), 1, "classes");
  check_size(amounts.size(), tallied.tally->amounts(), "amounts");
  for (const std::uint32_t c : classes) {
    if (c >= tallied.tally->classes())
      throw InvalidArgument(fmt::format("{}: a particle is of the class {}, and the tally has {}: make it for as many",
                                        caller, c, tallied.tally->classes()));
  }
  if (!std::all_of(amounts.begin(), amounts.end(), [](double a) { return std::isfinite(a); }))
    throw InvalidArgument(fmt::format("{}: an amount for the tally is not finite: give finite ones", caller));
}

MeshData checked_mesh(MeshData mesh) {
  const MeshReport report = check_and_repair(mesh);
  if (!report.defects.empty()) refuse(report.defects.front());
  return mesh;
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

Environment::Members::Members(const MeshData& checked_mesh, Threads all)
    : complex(valid_complex(checked_mesh, checked(all))), threads(all), id(next_id()) {}

CellComplex Environment::Members::valid_complex(const MeshData& checked_mesh, Threads threads) {
  CellComplex complex(checked_mesh, threads);
  const auto& invalid = complex.invalid_cells();
  if (invalid.empty()) return complex;
  throw InvalidMesh(fmt::format("{} cells can't be divided into positive simplices; the first: {}; mend or remesh them",
                                invalid.size(), invalid.front().message));
}

// Data of earlier particles must not be read.
void Environment::Members::adopt(Particles& particles) const {
  if (particles.size() > 0) return;
  particles = {};
  particles.details().environment = id;
  particles.details().moves = moves;
  particles.details().edits = edits;
}

void Environment::Members::check_known(const Particles& particles, const char* call) const {
  if (particles.size() == 0) return;
  const Particles::Details& known = particles.details();
  if (known.environment != id)
    throw InvalidArgument(fmt::format(
        "{}: the particles are of another environment: add() their positions to a new set in this one", call));
  const bool missed_move = known.moves + 1 < moves;
  if (!missed_move && known.edits + 1 >= edits) return;
  throw InvalidArgument(fmt::format(
      "{}: the particles missed {} and cannot catch up: add() their positions to a new set; {}", call,
      missed_move ? "a move" : "an edit",
      missed_move ? "call advance() with every set after each move, or update_after_edit() after a later edit"
                  : "call update_after_edit() with every set after each edit"));
}

void Environment::Members::check_edit_followed(const Particles& particles, const char* call) const {
  check_known(particles, call);
  if (particles.size() > 0 && particles.details().edits != edits)
    throw InvalidArgument(
        fmt::format("{}: these particles missed the last edit: call update_after_edit() with them first", call));
}

void Environment::Members::check_current(const Particles& particles) const {
  check_edit_followed(particles, "add");
  if (particles.size() > 0 && particles.details().moves != moves)
    throw InvalidArgument("add: these particles missed the last move: call advance() with them first");
}

void Environment::Members::add_to(Particles& particles, SimplexId simplex, const Vec3& position) const {
  if (particles.size() >= most_particles)
    throw Error(fmt::format("add: a set holds at most {} particles; use several sets", most_particles));
  adopt(particles);
  Particles::Details& details = particles.details();
  details.index.reset();
  particles.states_.emplace_back().put(simplex, position);
  details.weights.emplace_back();
  details.cache.add(complex, simplex, position);
}

void Environment::Members::add_at(Particles& particles, SimplexId simplex, const Weights& weights) const {
  const Corners corners = complex.corners(simplex);
  if (volume_sign(corners) == Sign::positive) {
    const SimplexPlacement placed = detail::carried(complex, simplex, weights);
    return add_to(particles, placed.simplex, placed.position);
  }
  const Vec3 place = flushed(detail::combine(corners, weights));
  add_to(particles, simplex, is_particle_position(complex.map(), place) ? place : Vec3{});
  particles.states_.back().held = true;
  particles.details().weights.back() = weights;
}

void Environment::Members::check_positions(std::span<const Vec3> positions) const {
  if (positions.size() != complex.point_count())
    throw InvalidArgument(fmt::format("move: {} positions for {} points", positions.size(), complex.point_count()));
  if (complex.map().dimension() != 2) return;
  const auto out = std::find_if(positions.begin(), positions.end(), [](const Vec3& x) { return flushed(x).z != 0.0; });
  if (out != positions.end())
    throw InvalidArgument(fmt::format("move: point {} goes to ({}, {}, {}): in the plane z must be 0",
                                      out - positions.begin(), out->x, out->y, out->z));
}

StepReport Environment::Members::advance(Particles& particles, std::span<const Vec3> targets,
                                         const detail::BatchStepper& stepper) const {
  adopt(particles);
  Particles::Details& details = particles.details();
  details.index.reset();
  StepReport report = stepper.advance({particles.states_, details.weights, details.cache}, targets);
  details.moves = moves;
  return report;
}

template <class Callback, class Take>
StepReport Environment::Members::watched(const Environment& environment, Particles& particles,
                                         std::span<const Vec3> targets, const StepOptions& options,
                                         const Callback& respond, const Take& take, bool simultaneous) const {
  if (!replay_hook) return take(respond);
  WatchedStep step(environment, particles, targets, options, simultaneous);
  const Callback noted = step.noted(respond);
  StepReport report = step.run([&] { return take(noted); });
  step.check(particles.states(), particles.details().weights);
  return report;
}

std::vector<Vec3> Environment::Members::with_steiner_points(std::span<const Vec3> positions) const {
  check_positions(positions);
  std::vector<Vec3> all(positions.begin(), positions.end());
  all.resize(complex.positions().size());
  complex.steiner_weights().compute(all);
  return all;
}

Environment::Environment(MeshData mesh, Threads threads)
    : Environment(std::make_unique<Members>(checked_mesh(std::move(mesh)), threads)) {}
Environment::Environment(std::unique_ptr<Members> members) : members_(std::move(members)) {}
Environment::~Environment() = default;

const CellComplex& Environment::complex() const { return members_->complex; }
const CombinatorialMap& Environment::map() const { return complex().map(); }
std::span<const Vec3> Environment::positions() const { return complex().positions().first(complex().point_count()); }
std::uint64_t Environment::edit_count() const { return members_->edits; }
const ComplexEditReport& Environment::last_edit() const { return members_->last_edit; }
Threads Environment::threads() const { return members_->threads; }
void Environment::set_threads(Threads threads) { members_->threads = checked(threads); }

Validity Environment::validity(std::size_t max_count) const { return check_validity(complex(), threads(), max_count); }

Location Environment::locate(const Vec3& x) { return locate(std::span<const Vec3>(&x, 1)).front(); }

std::vector<Location> Environment::locate(std::span<const Vec3> points) {
  const CellComplex& complex = members_->complex;
  const unsigned dimension = complex.map().dimension();
  std::vector<Vec3> places(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) places[i] = detail::checked_point(points[i], "point", i, dimension);
  if (!members_->locator) members_->locator = std::make_unique<Locator>(complex);
  const Locator& locator = *members_->locator;
  std::vector<std::pair<std::size_t, std::size_t>> order(points.size());  // by bin: bin, point
  for (std::size_t i = 0; i < points.size(); ++i) order[i] = {locator.bin(places[i]), i};
  std::sort(order.begin(), order.end());
  std::vector<Location> locations(points.size());
  parallel_for(points.size(), chunk, threads(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t point = order[i].second;
      locations[point] = locator.locate(complex, places[point]);
    }
  });
  return locations;
}

std::vector<AddResult> Environment::add(Particles& particles, std::span<const Vec3> positions) {
  members_->check_current(particles);
  const std::vector<Location> locations = locate(positions);
  std::vector<AddResult> added(positions.size());
  Addition addition(particles);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    added[i].location = locations[i];
    if (locations[i].place != Place::free) continue;
    added[i].particle = static_cast<std::uint32_t>(particles.size());
    members_->add_to(particles, locations[i].simplex, flushed(positions[i]));
  }
  addition.keep();
  return added;
}

bool Environment::add(Particles& particles, SimplexId simplex, const Vec3& position) {
  members_->check_current(particles);
  const Vec3 place = flushed(position);
  if (!is_particle_position(map(), place) || !holds(complex(), simplex, place)) return false;
  Addition addition(particles);
  members_->add_to(particles, simplex, place);
  addition.keep();
  return true;
}

bool Environment::add_at(Particles& particles, SimplexId simplex, const Weights& weights) {
  members_->check_current(particles);
  if (!are_weights(weights)) throw InvalidArgument("add_at: coordinates must be finite and at least 0");
  if (!names_simplex(map(), simplex) || !map().is_free(simplex.cell)) return false;
  Addition addition(particles);
  members_->add_at(particles, simplex, weights);
  addition.keep();
  return true;
}

Particles Environment::restored(std::span<const ParticleState> states, std::span<const Weights> weights) const {
  if (weights.size() != states.size()) throw InvalidArgument("restored: one set of weights per state is needed");
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (!can_be(complex(), states[i], weights[i]))
      throw InvalidArgument(fmt::format(
          "restored: the state of particle {} does not fit this environment: restore the environment first", i));
  }
  Particles particles;
  members_->adopt(particles);
  Particles::Details& details = particles.details();
  particles.states_.assign(states.begin(), states.end());
  details.weights.assign(weights.begin(), weights.end());
  for (const ParticleState& s : states) details.cache.add(complex(), s.at(), s.position);
  return particles;
}

std::span<Vec3> Environment::next_positions() { return members_->complex.next_positions(); }

void Environment::move() {
  if (const detail::PeriodicFaces* pairs = complex().periodic()) pairs->check_move(next_positions());
  members_->complex.commit_positions();
  members_->locator.reset();
  ++members_->moves;
}

void Environment::move(std::span<const Vec3> positions) {
  members_->check_positions(positions);
  std::copy(positions.begin(), positions.end(), next_positions().begin());
  move();
}

std::optional<CellInversion> Environment::first_inversion(std::span<const Vec3> positions) const {
  return dartcast::first_inversion(map(), complex().positions(), members_->with_steiner_points(positions), threads());
}

double Environment::move_until_inverted(std::span<const Vec3> positions, double share) {
  const std::vector<Vec3> after = members_->with_steiner_points(positions);
  const auto inversion = dartcast::first_inversion(map(), complex().positions(), after, threads());
  if (!inversion) {
    move(positions);
    return 1.0;
  }
  std::vector<Vec3> reached(after.size());
  const double time = move_towards(map(), complex().steiner_weights(), complex().positions(), after,
                                   share * inversion->how.safe_time, reached, threads());
  move(std::span<const Vec3>(reached).first(positions.size()));
  return time;
}

void Environment::replace(MeshData mesh) {
  Members& m = *members_;
  if (mesh.dimension() != map().dimension())
    throw InvalidArgument(fmt::format("replace: the new mesh has the dimension {}, and the environment {}",
                                      mesh.dimension(), map().dimension()));
  CellComplex complex = Members::valid_complex(checked_mesh(std::move(mesh)), m.threads);
  m.replaced_positions.assign(m.complex.positions().begin(), m.complex.positions().end());
  m.complex = std::move(complex);
  m.last_edit = {};
  m.last_edit.replaced = true;
  ++m.edits;
  m.moves_at_edit = m.moves;
  m.locator.reset();
  m.tallied = {};
}

ComplexEditReport Environment::edit(const std::function<void(ComplexEdit&)>& make) {
  ComplexEdit edit(members_->complex);
  make(edit);
  members_->last_edit = edit.commit();
  members_->replaced_positions = {};
  ++members_->edits;
  members_->moves_at_edit = members_->moves;
  members_->locator.reset();
  return members_->last_edit;
}

bool Environment::awaits_advance(const Particles& particles) const {
  return particles.details().moves != members_->moves;
}

void Environment::check_advance(const Particles& particles, const StepOptions& options, const char* caller) const {
  members_->check_edit_followed(particles, caller);
  check(options, caller);
  if (tally() != nullptr && !tally()->fits(complex()))
    throw InvalidArgument(fmt::format(
        "{}: the tally has missed an edit of its environment: call its update_after_edit() after each edit", caller));
  if (tally() != nullptr) check_tallied(members_->tallied, particles.size(), caller);
}

StepReport Environment::advance(Particles& particles, std::span<const Vec3> targets, const ContactCallback& respond,
                                const StepOptions& options) {
  return advance_by({}, particles, targets, respond, options);
}

// `make`: makes the decider of the step, with the response that it has to call; none: there is no decider.
StepReport Environment::advance_by(const MakeDecider& make, Particles& particles, std::span<const Vec3> targets,
                                   const ContactCallback& respond, const StepOptions& options) {
  check_advance(particles, options);
  const auto take = [&](const ContactCallback& answer) {
    const bool may_throw = answer && !detail::is_library_response(answer);  // the caller's code may throw
    const std::unique_ptr<detail::StepDecider> decider = make ? make(answer) : nullptr;
    return members_->advance(particles, targets,
                             detail::BatchStepper(complex(), awaits_advance(particles), threads(), options, answer,
                                                  may_throw, decider.get(), members_->tallied, &members_->crossed));
  };
  return members_->watched(*this, particles, targets, options, respond, take, static_cast<bool>(make));
}

StepReport Environment::advance_in_rounds(Particles& particles, std::span<const Vec3> targets,
                                          const RoundCallback& respond, const StepOptions& options) {
  check_advance(particles, options, "advance_in_rounds");
  if (!respond) return advance(particles, targets, {}, options);
  if (tally() != nullptr)
    throw InvalidArgument("advance_in_rounds: steps in rounds are not added to tallies: use advance()");
  const auto take = [&](const RoundCallback& answer) {
    return members_->advance(
        particles, targets,
        detail::BatchStepper(complex(), awaits_advance(particles), threads(), options, answer, &members_->crossed));
  };
  return members_->watched(*this, particles, targets, options, respond, take, false);
}

void Environment::set_replay_hook(ReplayHook hook) { members_->replay_hook = std::move(hook); }
const ReplayHook& Environment::replay_hook() const { return members_->replay_hook; }

void Environment::set_crossing_callback(CrossingCallback crossed) { members_->crossed = std::move(crossed); }

void Environment::set_tally(CellTally* tally, const TalliedParticles& particles) {
  members_->tallied = {tally, particles, {}};
}
CellTally* Environment::tally() const { return members_->tallied.tally; }
detail::Tallied Environment::set_tallied(const detail::Tallied& tallied) {
  return std::exchange(members_->tallied, tallied);
}

// Repairs would turn the corners of cells that look inside out.
std::unique_ptr<Environment> environment_as_it_is(const MeshData& mesh) {
  MeshData copy = mesh;
  for (const Finding& f : check_and_repair(copy).defects)
    if (f.kind != "inverted" && f.kind != "flat") refuse(f);
  return std::unique_ptr<Environment>(new Environment(std::make_unique<Environment::Members>(mesh, Threads{1})));
}

StepReplay Environment::record(const Particles& particles, std::size_t particle, const Vec3& target,
                               const ContactCallback& respond, const StepOptions& options) const {
  std::vector<Vec3> targets(particles.size());
  if (particle < targets.size()) targets[particle] = target;
  WatchedStep watched(*this, particles, targets, options, false);
  const ContactCallback noted = watched.noted(respond);
  std::optional<Vec3> end;
  try {
    end = trace(particles, particle, {&target, 1}, noted, options).at(0).after.position;
  } catch (const InternalError&) {  // it is recorded all the same
  }
  StepReplay replay = watched.replay_of(static_cast<std::uint32_t>(particle));
  replay.end = end;
  return replay;
}

std::vector<Trace> Environment::trace(const Particles& particles, std::size_t particle, std::span<const Vec3> targets,
                                      const ContactCallback& respond, const StepOptions& options) const {
  const CellComplex& complex = members_->complex;
  std::vector<Vec3> decided;
  for (std::size_t i = 0; i < targets.size(); ++i)
    decided.push_back(detail::checked_point(targets[i], "target", i, map().dimension()));
  if (particle >= particles.size())
    throw InvalidArgument(fmt::format("trace: there is no particle {} among {}", particle, particles.size()));
  check_advance(particles, options, "trace");
  bool moved = awaits_advance(particles);
  ParticleState state = particles[particle];
  Weights weights = particles.held_weights(particle);
  std::vector<Trace> traces;
  for (const Vec3& target : decided) {
    Trace& trace = traces.emplace_back();
    trace.before = state;
    trace.start = forecast(map(), state, moved ? complex.previous_corners(state.at()) : complex.corners(state.at()));
    trace.result =
        Stepper(complex, moved, options, respond)
            .trace(static_cast<std::uint32_t>(particle), state, weights, target, trace.contacts, trace.crossings);
    trace.after = state;
    trace.end = forecast(map(), state, complex.corners(state.at()));
    if (trace.result.stopped || trace.result.held) break;
    moved = false;
  }
  return traces;
}

}  // namespace dartcast
