// One step of all spheres: rounds of planning, advancing the centres, and landing.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "complex/periodic_faces.hpp"
#include "dartcast/cell_tally.hpp"
#include "dartcast/error.hpp"
#include "dartcast/spheres.hpp"
#include "spheres/sphere_run.hpp"
#include "tracking/representable_point.hpp"
#include "tracking/tallied.hpp"
#include "tracking/tally_writer.hpp"

namespace dartcast {

namespace {

using detail::CentreContact;
using detail::SphereRun;
using detail::SphereScene;
using detail::SphereWay;
using detail::WayEnd;

constexpr std::size_t spheres_in_chunk = 256;

void check_radii(const Particles& particles, std::span<const double> radii, std::span<const Vec3> targets,
                 std::span<const double> clearances) {
  if (radii.size() != particles.size() || targets.size() != particles.size())
    throw InvalidArgument(fmt::format("advance: {} radii and {} targets for {} particles", radii.size(), targets.size(),
                                      particles.size()));
  if (!clearances.empty() && clearances.size() != particles.size())
    throw InvalidArgument(fmt::format("advance: {} clearances for {} particles", clearances.size(), particles.size()));
  for (std::size_t i = 0; i < radii.size(); ++i) {
    if (!is_radius(radii[i]))
      throw InvalidArgument(
          fmt::format("advance: the radius of particle {} is {}: it must be between 0 and 2^100", i, radii[i]));
  }
}

// The first contact of each particle's centre, by particle.
class CentreContacts {
 public:
  explicit CentreContacts(const ContactList& list) : list_(list) {}

  CentreContact of(std::uint32_t particle) {
    while (next_ < list_.contacts.size() && list_.contacts[next_].particle < particle) ++next_;
    if (next_ == list_.contacts.size() || list_.contacts[next_].particle != particle) return {};
    return {&list_.contacts[next_], &list_};
  }

 private:
  const ContactList& list_;
  std::size_t next_ = 0;
};

void count_contacts(StepReport& step) {
  step.counters.contacts = {};
  for (const Contact& c : step.contacts.contacts) ++step.counters.contacts[static_cast<std::size_t>(c.kind)];
}

}  // namespace

struct SphereStepper::Buffers {
  // The first stretch of a sphere that does not bring it to its target.
  struct Planned {
    std::uint32_t particle;
    Vec3 begin;
    SphereWay way;
  };

  // Scratch memory and results of the planning of one chunk.
  struct Chunk {
    NearWalls near;
    std::vector<Planned> planned;
    std::vector<SphereOverlap> overlaps;
  };

  std::vector<Chunk> chunks;
  std::vector<Vec3> targets;
  std::vector<SphereRun> runs;  // the first `run_count` are in use, by particle
  std::size_t run_count = 0;
  std::vector<std::uint32_t> active;  // numbers of runs
  std::vector<std::uint32_t> particles;
  std::vector<std::uint8_t> goes_on;
  std::vector<CentreContact> centres;

  SphereRun& add_run() {
    if (run_count == runs.size()) runs.emplace_back();
    return runs[run_count++];
  }
};

// The steps of spheres are not added to a tally walk by walk: each counts as a straight way (dartcast/cell_tally.hpp).
// Those of points are added by the environment, in the first round.
class SphereTally {
 public:
  SphereTally(Environment& environment, const Particles& particles, std::span<const double> radii,
              const ContactCallback& respond, const StepOptions& options)
      : environment_(environment), tally_(environment.tally()), radii_(radii), options_(options) {
    if (tally_ == nullptr) return;
    before_ = particles;
    moved_ = environment.awaits_advance(particles);
    if (respond) former_ = *tally_;
    tallied_ = environment.set_tallied({});
    environment.set_tallied({tally_, tallied_.particles, radii});
  }
  SphereTally(const SphereTally&) = delete;
  SphereTally& operator=(const SphereTally&) = delete;
  ~SphereTally() {
    if (tally_ != nullptr) environment_.set_tallied(tallied_);
  }

  void end_first_round() const { environment_.set_tally(nullptr); }

  void add_spheres(const Particles& after, const ContactList& list) const {
    if (tally_ == nullptr) return;
    const ContactCallback none;
    const Stepper stepper(environment_.complex(), moved_, options_, none);
    detail::TallyWriter writer(*tally_);
    CentreContacts contacts(list);
    for (std::uint32_t i = 0; i < after.size(); ++i) {
      if (radii_[i] == 0.0) continue;
      writer.set_particle(tallied_.particles, i);
      const Contact* const met = contacts.of(i).contact;
      stepper.tally_straight(before_[i], before_.held_weights(i), after[i], met != nullptr ? met->time_of_impact : 1.0,
                             writer);
    }
  }

  /// A response has thrown.
  void restore() const {
    if (former_) *tally_ = *former_;
  }

 private:
  Environment& environment_;
  CellTally* tally_;
  std::span<const double> radii_;
  const StepOptions& options_;
  detail::Tallied tallied_;  // of the caller
  Particles before_;
  std::optional<CellTally> former_;
  bool moved_ = false;
};

namespace {

// One call of advance(), in order:
//  1. plan_all()     the first stretch of every sphere: to its target, a contact, or out of walls
//  2. advance_all()  all centres go to the ends of their stretches; points go all their way
//  3. start_runs()   a run for each sphere whose step is not at its end
//  4. land()         records contacts and calls the response; the runs that go on stay active
//  5. next_round()   the active runs plan, advance and land again, until none is left
//  6. merge()        the report: by particle, contacts of points and of runs
class SphereCall {
  using Buffers = SphereStepper::Buffers;
  using Planned = Buffers::Planned;
  using Chunk = Buffers::Chunk;

 public:
  SphereCall(Buffers& b, Environment& environment, Particles& particles, std::span<const double> radii,
             std::span<const Vec3> targets, const ContactCallback& respond, const StepOptions& options,
             std::span<const double> clearances, const SphereTally& tally)
      : b_(b),
        environment_(environment),
        particles_(particles),
        radii_(radii),
        targets_(targets),
        clearances_(clearances),
        respond_(respond),
        options_(options),
        tally_(tally),
        scene_{&environment.complex(), environment.awaits_advance(particles), &respond_, &options_} {}

  SphereReport run() {
    plan_all();
    StepReport first = advance_all();
    tally_.end_first_round();
    start_runs(first);
    if (b_.run_count > 0) land(particles_, b_.active);
    while (!b_.active.empty()) next_round(first.counters);
    SphereReport report;
    merge(first, report);
    tally_.add_spheres(particles_, report.step.contacts);
    return report;
  }

 private:
  void plan_all() {
    b_.targets.assign(targets_.begin(), targets_.end());
    const std::size_t count = chunk_count(particles_.size(), spheres_in_chunk);
    if (b_.chunks.size() < count) b_.chunks.resize(count);
    parallel_for(particles_.size(), spheres_in_chunk, environment_.threads(), [&](std::size_t begin, std::size_t end) {
      Chunk& chunk = b_.chunks[begin / spheres_in_chunk];
      chunk.planned.clear();
      chunk.overlaps.clear();
      for (std::size_t i = begin; i < end; ++i) plan_first(i, chunk);
    });
  }

  // Whether no wall is within reach of the way. A share of the clearance is given up, because it is a rounded distance.
  [[nodiscard]] bool is_clear(std::size_t i, const Vec3& from) const {
    if (clearances_.empty() || scene_.moved) return false;
    return radii_[i] + norm(targets_[i] - from) <= clearances_[i] * (1.0 - 0x1p-20);
  }

  // Input that the environment refuses is left to it.
  void plan_first(std::size_t i, Chunk& chunk) {
    const ParticleState& state = particles_[i];
    if (radii_[i] == 0.0 || state.held || !is_finite(targets_[i])) return;
    if (!scene_.complex->map().contains(state.cell) || is_clear(i, state.position)) return;
    const auto particle = static_cast<std::uint32_t>(i);
    const SphereWay way = detail::way_of(
        *scene_.complex, {state.cell, {state.position, targets_[i], radii_[i]}, scene_.moved, true}, chunk.near);
    if (way.end == WayEnd::target) return;
    if (way.end == WayEnd::overlap && !scene_.moved)
      detail::list_overlaps(*scene_.complex, state, particle, radii_[i], chunk.near, chunk.overlaps);
    b_.targets[i] = flushed(way.target);
    chunk.planned.push_back({particle, state.position, way});
  }

  // Points go all their way, spheres to the end of their first stretch, or to a wall that the centre meets. There they
  // stay by an answer, also where there are no points: a step without answers may give other last digits.
  StepReport advance_all() {
    if (!respond_) return environment_.advance(particles_, b_.targets, {}, options_);
    const ContactCallback points_only = [this](const Contact& contact, std::span<const WallHit> walls,
                                               std::span<const WallHit> earlier) {
      return radii_[contact.particle] == 0.0 ? respond_(contact, walls, earlier) : AfterContact{};
    };
    return environment_.advance(particles_, b_.targets, points_only, options_);
  }

  // Starts runs for spheres whose first stretch ends in a contact or an overlap, or whose centre met a wall.
  void start_runs(const StepReport& first) {
    b_.run_count = 0;
    b_.active.clear();
    b_.centres.clear();
    std::size_t held = 0;
    std::size_t met = 0;
    const auto& contacts = first.contacts.contacts;
    const auto met_before = [&](std::uint32_t particle) {
      for (; met < contacts.size() && contacts[met].particle < particle; ++met) {
        if (radii_[contacts[met].particle] > 0.0 && (met == 0 || contacts[met - 1].particle != contacts[met].particle))
          start_run({contacts[met].particle, {}, {}}, {&contacts[met], &first.contacts});
      }
    };
    const std::size_t count = chunk_count(particles_.size(), spheres_in_chunk);
    for (std::size_t c = 0; c < count; ++c) {
      std::size_t overlap = 0;
      const Chunk& chunk = b_.chunks[c];
      for (const Planned& planned : chunk.planned) {
        met_before(planned.particle);
        while (held < first.held.size() && first.held[held].particle < planned.particle) ++held;
        const bool is_held = held < first.held.size() && first.held[held].particle == planned.particle;
        CentreContact centre;
        if (met < contacts.size() && contacts[met].particle == planned.particle)
          centre = {&contacts[met], &first.contacts};
        while (met < contacts.size() && contacts[met].particle == planned.particle) ++met;
        if (!is_held) start_run(planned, centre);
        for (; overlap < chunk.overlaps.size() && chunk.overlaps[overlap].particle == planned.particle; ++overlap) {
          if (!is_held) b_.runs[b_.run_count - 1].overlaps().push_back(chunk.overlaps[overlap]);
        }
      }
    }
    met_before(0xffffffffU);
  }

  void start_run(const Planned& planned, CentreContact centre) {
    const std::uint32_t i = planned.particle;
    b_.active.push_back(static_cast<std::uint32_t>(b_.run_count));
    b_.centres.push_back(centre);
    b_.add_run().start(i, {planned.begin, targets_[i], radii_[i]}, planned.way, scene_.moved);
  }

  // Lands the active runs. Their centres are in `now`: at the particles' numbers if those are all, else in order.
  void land(const Particles& now, std::span<const std::uint32_t> active) {
    const bool all = &now == &particles_;
    b_.goes_on.assign(active.size(), 0);
    const std::size_t count = chunk_count(active.size(), spheres_in_chunk);
    if (b_.chunks.size() < count) b_.chunks.resize(count);
    parallel_for(active.size(), spheres_in_chunk, environment_.threads(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        SphereRun& run = b_.runs[active[k]];
        const ParticleState& state = now[all ? run.particle() : k];
        b_.goes_on[k] = run.land(scene_, state, b_.centres[k], b_.chunks[begin / spheres_in_chunk].near) ? 1 : 0;
      }
    });
    std::size_t kept = 0;
    for (std::size_t k = 0; k < active.size(); ++k) {
      if (b_.goes_on[k] != 0) b_.active[kept++] = b_.active[k];
    }
    b_.active.resize(kept);
  }

  void next_round(Counters& counters) {
    b_.particles.clear();
    for (const std::uint32_t a : b_.active) b_.particles.push_back(b_.runs[a].particle());
    Particles some = particles_.selected(b_.particles);
    b_.targets.resize(some.size());
    parallel_for(some.size(), spheres_in_chunk, environment_.threads(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        b_.targets[k] = b_.runs[b_.active[k]].plan(scene_, some[k], b_.chunks[begin / spheres_in_chunk].near);
    });
    const StepReport report = environment_.advance(some, b_.targets, {}, options_);
    counters.orientation.tests += report.counters.orientation.tests;
    counters.orientation.exact += report.counters.orientation.exact;
    for (const HeldParticle& h : report.held) b_.runs[b_.active[h.particle]].hold(h.cell);
    CentreContacts centres(report.contacts);
    b_.centres.clear();
    for (std::size_t k = 0; k < some.size(); ++k) b_.centres.push_back(centres.of(static_cast<std::uint32_t>(k)));
    particles_.replace(b_.particles, some);
    land(some, b_.active);
  }

  // Writes the report by particle: points, and spheres that were held, from the environment; the others from the runs.
  void merge(const StepReport& first, SphereReport& report) const {
    StepReport& step = report.step;
    step.counters = first.counters;
    std::size_t contact = 0;
    std::size_t held = 0;
    std::size_t stopped = 0;
    const auto points_before = [&](std::uint32_t particle) {
      const auto& contacts = first.contacts.contacts;
      for (; contact < contacts.size() && contacts[contact].particle < particle; ++contact) {
        Contact c = contacts[contact];
        if (radii_[c.particle] > 0.0) continue;
        const auto walls = first.contacts.walls_of(c);
        c.first_wall = static_cast<std::uint32_t>(step.contacts.walls.size());
        step.contacts.walls.insert(step.contacts.walls.end(), walls.begin(), walls.end());
        step.contacts.contacts.push_back(c);
      }
      for (; held < first.held.size() && first.held[held].particle < particle; ++held)
        step.held.push_back(first.held[held]);
      for (; stopped < first.stopped.size() && first.stopped[stopped].particle < particle; ++stopped) {
        if (radii_[first.stopped[stopped].particle] == 0.0) step.stopped.push_back(first.stopped[stopped]);
      }
    };
    for (std::size_t k = 0; k < b_.run_count; ++k) {
      points_before(b_.runs[k].particle());
      b_.runs[k].report(report);
    }
    points_before(0xffffffffU);
    count_contacts(step);
  }

  Buffers& b_;
  Environment& environment_;
  Particles& particles_;
  std::span<const double> radii_;
  std::span<const Vec3> targets_;
  std::span<const double> clearances_;
  const ContactCallback& respond_;
  const StepOptions& options_;
  const SphereTally& tally_;
  SphereScene scene_;
};

}  // namespace

SphereStepper::SphereStepper() = default;
SphereStepper::~SphereStepper() = default;
SphereStepper::SphereStepper(SphereStepper&&) noexcept = default;
SphereStepper& SphereStepper::operator=(SphereStepper&&) noexcept = default;

SphereReport SphereStepper::advance(Environment& environment, Particles& particles, std::span<const double> radii,
                                    std::span<const Vec3> targets, const ContactCallback& respond,
                                    const StepOptions& options, std::span<const double> clearances) {
  check_radii(particles, radii, targets, clearances);
  environment.check_advance(particles, options);
  const bool points_only = std::all_of(radii.begin(), radii.end(), [](double r) { return r == 0.0; });
  if (points_only) return {environment.advance(particles, targets, respond, options), {}};
  detail::refuse_periodic(environment.complex(), "spheres");
  if (!buffers_) buffers_ = std::make_unique<Buffers>();
  const SphereTally tally(environment, particles, radii, respond, options);
  SphereCall call(*buffers_, environment, particles, radii, targets, respond, options, clearances, tally);
  if (!respond) return call.run();
  const Particles before = particles;  // a response is the caller's code: it may throw
  try {
    return call.run();
  } catch (...) {
    particles = before;
    tally.restore();
    throw;
  }
}

SphereReport advance_spheres(Environment& environment, Particles& particles, std::span<const double> radii,
                             std::span<const Vec3> targets, const ContactCallback& respond,
                             const StepOptions& options) {
  return SphereStepper().advance(environment, particles, radii, targets, respond, options);
}

}  // namespace dartcast
