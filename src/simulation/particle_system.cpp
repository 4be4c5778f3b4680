// A step of the particles: motion of the vertices, forces, the walk, and the removal of particles that leave. Edits.
#include "simulation/particle_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "base/are_several.hpp"
#include "complex/periodic_faces.hpp"
#include "complex/simplex.hpp"
#include "dartcast/cell_tally.hpp"
#include "dartcast/error.hpp"
#include "simulation/force_step.hpp"
#include "simulation/polyline.hpp"
#include "simulation/timer.hpp"
#include "tracking/carry.hpp"

namespace dartcast {

namespace {

WallResponses responses_of(const SimulationOptions& options, const CombinatorialMap& map) {
  WallResponses responses(options.response);
  for (const auto& [name, response] : options.patch_responses) responses.set(map.patch(name), response);
  return responses;
}

// Names of the arrays that output writes itself.
constexpr std::string_view own_names[] = {"id",   "radius",   "velocity", "cell",    "kind",
                                          "held", "contacts", "diameter", "density", "charge_per_mass"};

void check_names(const std::vector<std::string>& names) {
  for (auto name = names.begin(); name != names.end(); ++name) {
    const bool taken = std::find(std::begin(own_names), std::end(own_names), *name) != std::end(own_names) ||
                       std::find(names.begin(), name, *name) != name;
    if (name->empty() || taken)
      throw InvalidArgument(fmt::format(
          "simulation: user data \"{}\": give each number a name of its own, and none that output uses itself", *name));
  }
}

void check_integrator(const SimulationOptions& o) {
  if (o.integrator == Integrator::euler) return;
  if (o.drag != 0.0)
    throw InvalidArgument(
        "simulation: the integrator rk4 is for particles without mass, which follow a field: drag "
        "must be 0");
  if (o.substeps != 1)
    throw InvalidArgument(
        "simulation: the integrator rk4 takes a step as one segment: substeps must be 1; for smaller "
        "errors take a smaller dt");
  if (o.collisions)
    throw InvalidArgument(
        "simulation: the integrator rk4 is for particles that do not meet: leave collisions out, or "
        "take the integrator euler");
}

void check_wall_motion(const SimulationOptions& o) {
  if (o.wall_motion == WallMotion::carried) return;
  if (o.substeps != 1)
    throw InvalidArgument(
        "simulation: points and walls that move at the same time take a step as one segment: substeps must be 1; or "
        "take the wall motion carried");
  if (o.collisions)
    throw InvalidArgument(
        "simulation: points that move at the same time as the walls do not meet: leave collisions out, or take the "
        "wall "
        "motion carried");
}

// While it lives, steps in the environment are added to a tally; null: as before.
class TallyUse {
 public:
  TallyUse(Environment& environment, CellTally* tally, const TallyValues& values)
      : environment_(environment), former_(environment.tally()) {
    if (tally != nullptr) environment.set_tally(tally, values.spans());
  }
  TallyUse(const TallyUse&) = delete;
  TallyUse& operator=(const TallyUse&) = delete;
  ~TallyUse() { environment_.set_tally(former_); }

 private:
  Environment& environment_;
  CellTally* former_;
};

// While it lives, the particles' images are counted.
class ImagesUse {
 public:
  ImagesUse(Environment& environment, const PeriodicImages& images, ParticleSet& set)
      : environment_(environment), counts_(images.size() > 0) {
    if (counts_) environment.set_crossing_callback(images.callback(set));
  }
  ImagesUse(const ImagesUse&) = delete;
  ImagesUse& operator=(const ImagesUse&) = delete;
  ~ImagesUse() {
    if (counts_) environment_.set_crossing_callback({});
  }

 private:
  Environment& environment_;
  bool counts_;
};

void check_periodic(const SimulationOptions& o, const CellComplex& complex) {
  if (o.collisions) detail::refuse_periodic(complex, "simulation: spheres that collide");
  if (o.wall_motion == WallMotion::simultaneous)
    detail::refuse_periodic(complex, "simulation: points that move at the same time as the walls");
}

void check(const SimulationOptions& o, bool planar) {
  if (!(o.dt >= smallest_dt && o.dt <= largest_dt))
    throw InvalidArgument(fmt::format("simulation: dt is {}: it must be between 2^-100 and 2^100 s", o.dt));
  if (!(o.drag >= 0.0) || !std::isfinite(o.drag))
    throw InvalidArgument("simulation: drag must be finite and not negative");
  if (!is_finite(o.gravity)) throw InvalidArgument("simulation: gravity must be finite");
  if (!(o.diffusion >= 0.0) || !std::isfinite(o.diffusion))
    throw InvalidArgument("simulation: diffusion must be finite and not negative");
  if (o.diffusion > 0.0 && !o.diffusivity.empty())
    throw InvalidArgument("simulation: diffusion and diffusivity are both given: give one of them");
  if ((o.diffusion > 0.0 || !o.diffusivity.empty()) && o.collisions)
    throw InvalidArgument("simulation: spheres that collide have no random ways: leave collisions or diffusion out");
  if (o.brownian_bridge && o.diffusion == 0.0 && o.diffusivity.empty())
    throw InvalidArgument("simulation: brownian_bridge belongs to diffusion: give that, or leave it out");
  if (o.substeps == 0) throw InvalidArgument("simulation: substeps must be at least 1");
  check_integrator(o);
  check_wall_motion(o);
  check_forces(o, planar);
  check(o.step, "simulation");
  check_names(o.user_data);
  if (knows_drops(o) && o.forces.fluid.surface_tension == 0.0)
    throw InvalidArgument("simulation: stick_below_weber needs the fluid's surface tension: give it");
  if (!o.collisions) return;
  if (any_response(o, [](const WallResponse& r) {
        return r.stick_below != 0.0 || r.stick_below_weber != 0.0 || !r.table.speeds.empty();
      }))
    throw InvalidArgument(
        "simulation: spheres that collide know of one restitution for each wall: leave collisions out, or leave out "
        "stick_below, stick_below_weber and tables of restitution");
  if (are_several(o.ranks))
    throw InvalidArgument(
        "simulation: spheres that collide need all others, and ranks have some each: run this scene with one process, "
        "or "
        "leave collisions out");
  const CollisionOptions& c = *o.collisions;
  if (!(c.restitution >= 0.0 && c.restitution <= 1.0))
    throw InvalidArgument("simulation: the spheres' restitution must be between 0 and 1");
  if (!(c.friction >= 0.0) || !std::isfinite(c.friction))
    throw InvalidArgument("simulation: the spheres' friction must be finite and not negative");
  if (!(c.density >= smallest_density && c.density <= largest_density))
    throw InvalidArgument(
        fmt::format("simulation: the spheres' density is {}: it must be between 2^-100 and 2^100", c.density));
  if (c.iterations == 0) throw InvalidArgument("simulation: collisions need an iteration at least");
}

}  // namespace

ParticleSystem::ParticleSystem(Environment& environment, Followers& followers, MovingVertices& motion,
                               const SimulationOptions& options)
    : environment_(environment),
      motion_(motion),
      options_(options),
      responses_(responses_of(options, environment.map())),
      set_(options.user_data.size()),
      parcels_(options_),
      aiming_(environment, followers, motion, options_, responses_, sampled_),
      sampled_(environment, followers, options_.user_data),
      images_(environment.complex(), options_.user_data),
      contacts_(environment, followers, motion, options_, responses_) {
  check(options, environment.map().dimension() == 2);
  check_periodic(options, environment.complex());
  if (environment.map().dimension() == 2 && options.gravity.z != 0.0)
    throw InvalidArgument(fmt::format("simulation: gravity is ({}, {}, {}): in the plane its z must be 0",
                                      options.gravity.x, options.gravity.y, options.gravity.z));
  for (auto* counts : {&totals_.contacts_by_patch, &totals_.deposited_by_patch, &totals_.escaped_by_patch})
    counts->resize(environment.map().patch_names().size());
}

// Phases, in order:
//  1. inlets have injected;
//  2. vertices move (with collisions: in phase 3, after the spheres' impulses);
//  3. for each segment of the way: velocities change, targets are set, particles walk and respond at walls;
//  4. contacts are counted, and those absorbed or escaped leave.
void ParticleSystem::step(double /*begin*/) {
  std::vector<std::uint8_t> departed;  // to other ranks; empty: none
  if (!collides()) move_vertices();
  for (unsigned segment = 0; segment < options_.substeps; ++segment) advance_segment(segment, departed);
  const ScopeTimer timer(totals_.seconds_respond);
  totals_.counters += last_.report.counters;
  totals_.collisions += last_.collisions;
  count_contacts();
  mark_held();
  remove_gone(departed);
  motion_.count_step();
  take_samples(options_.dt);
}

void ParticleSystem::move_vertices() {
  if (!motion_.deforms()) return;
  const ScopeTimer timer(totals_.seconds_deform);
  motion_.move();
}

void ParticleSystem::advance_segment(unsigned segment, std::vector<std::uint8_t>& departed) {
  const double dt = options_.dt / options_.substeps;
  const bool moving = motion_.deforms() && segment == 0;
  aiming_.set_times(motion_.time() + segment * dt, dt);
  aiming_.set_moment(motion_.steps() * options_.substeps + segment);
  if (collides()) {
    {
      const ScopeTimer timer(totals_.seconds_collide);
      aiming_.aim(set_, dt, false);
      last_.collisions += contacts_.collide(set_, aiming_.targets(), dt, moving, aiming_.acceleration(dt).value);
    }
    if (moving) {
      move_vertices();
      aiming_.aim_stuck(set_, dt);
    }
  } else {
    const ScopeTimer timer(totals_.seconds_respond);
    aiming_.aim(set_, dt, moving);
  }
  const ScopeTimer timer(totals_.seconds_detect);
  const ContactCallback respond = response(dt);
  TallyValues tallied;
  if (tally_ != nullptr)
    tallied = plan_->values(set_, parcels_, aiming_.losses(), motion_.time() + (segment + 0.5) * dt);
  const TallyUse use(environment_, tally_, tallied);
  const ImagesUse images(environment_, images_, set_);
  if (set_.spheres == 0) {
    StepReport report =
        part_ != nullptr ? advance_in_part(aiming_.acceleration(dt), departed)
        : options_.wall_motion == WallMotion::simultaneous
            ? simultaneous_stepper_.advance(environment_, set_.states, aiming_.targets(), respond, options_.step)
            : environment_.advance(set_.states, aiming_.targets(), respond, options_.step);
    hold_stopped(report, responses_, set_.velocities(), set_.statuses(), options_.dt, aiming_.acceleration(dt));
    take_back_amounts(report, tallied.amounts);
    append_segment(last_.report, std::move(report), segment, options_.substeps);
    return;
  }
  const std::span<const double> clearances = collides() ? contacts_.clearances() : std::span<const double>();
  SphereReport report =
      stepper_.advance(environment_, set_.states, set_.radii(), aiming_.targets(), respond, options_.step, clearances);
  hold_stopped(report.step, responses_, set_.velocities(), set_.statuses(), options_.dt, aiming_.acceleration(dt));
  take_back_amounts(report.step, tallied.amounts);
  contacts_.add_to(report.step);
  append_segment(last_.report, std::move(report.step), segment, options_.substeps);
  for (const SphereOverlap& o : report.overlaps) totals_.deepest_in_wall = std::max(totals_.deepest_in_wall, o.depth);
  totals_.wall_overlaps += report.overlaps.size();
  last_.overlaps.insert(last_.overlaps.end(), report.overlaps.begin(), report.overlaps.end());
}

// A particle that leaves in a segment has its amounts up to there.
void ParticleSystem::take_back_amounts(const StepReport& report, std::span<const double> amounts) {
  if (amounts.empty()) return;
  const std::size_t width = plan_->amounts();
  std::vector<double> rest(width);
  const std::vector<Contact>& contacts = report.contacts.contacts;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const std::uint32_t i = contacts[k].particle;
    const bool is_last = k + 1 == contacts.size() || contacts[k + 1].particle != i;
    if (!is_last || !leaves(set_.statuses()[i])) continue;
    for (std::size_t a = 0; a < width; ++a) rest[a] = amounts[i * width + a] * (1.0 - contacts[k].time_of_impact);
    tally_->take_back_amounts(set_.states[i].cell, rest, plan_->class_of(set_, i));
  }
}

// Valid until there are more or fewer particles.
ContactCallback ParticleSystem::answer(const Acceleration& acceleration) {
  Drops drops;
  if (options_.forces.fluid.surface_tension > 0.0)
    drops = {set_.table[set_.table.diameter], set_.table[set_.table.density], options_.forces.fluid.surface_tension};
  return respond_with(responses_, set_.velocities(), set_.statuses(), options_.dt, acceleration, drops);
}

// Impulses of other spheres change velocities, too: contacts of pushed spheres know of no acceleration.
ContactCallback ParticleSystem::response(double dt) {
  ContactCallback free = answer(aiming_.acceleration(dt));
  if (!collides()) return free;
  return [this, free, pushed = answer({})](const Contact& contact, std::span<const WallHit> walls,
                                           std::span<const WallHit> earlier) {
    return (contacts_.pushed(contact.particle) ? pushed : free)(contact, walls, earlier);
  };
}

void ParticleSystem::count_contacts() {
  const ContactList& list = last_.report.contacts;
  const std::span<std::uint32_t> counts = set_.table[set_.table.contact_count];
  last_.contact_ids.reserve(list.contacts.size());
  last_.contact_sources.reserve(list.contacts.size());
  for (const Contact& c : list.contacts) {
    last_.contact_ids.push_back(set_.ids()[c.particle]);
    if (lists_parcels_) last_.parcels.push_back(parcels_.parcel(set_, c.particle));
    counts[c.particle] += counts[c.particle] == UINT32_MAX ? 0 : 1;
    const WallHit& wall = list.walls_of(c).front();
    last_.contact_sources.push_back(environment_.map().source(wall.face.cell));
    ++totals_.contacts_by_patch[wall.patch.value];
    const bool is_last = &c == &list.contacts.back() || (&c)[1].particle != c.particle;
    const ParticleStatus end = set_.statuses()[c.particle];
    if (!is_last || end == ParticleStatus::alive) continue;  // a stuck particle has no contacts after this
    if (tally_ != nullptr && end != ParticleStatus::escaped)
      tally_->deposit(wall.face.cell, parcels_.number(set_, c.particle), plan_->class_of(set_, c.particle));
    ++(end == ParticleStatus::escaped ? totals_.escaped_by_patch : totals_.deposited_by_patch)[wall.patch.value];
  }
}

void ParticleSystem::mark_held() {
  const std::span<std::uint8_t> held = set_.table[set_.table.held];
  std::fill(held.begin(), held.end(), std::uint8_t{0});  // those that left are not removed yet
  for (const HeldParticle& h : last_.report.held) held[h.particle] = 1;
}

void ParticleSystem::remove_gone(std::span<const std::uint8_t> departed) {
  std::vector<std::uint8_t> gone(set_.states.size(), 0);
  const std::span<const std::uint64_t> ids = set_.ids();
  const std::span<const ParticleStatus> statuses = set_.statuses();
  std::uint64_t absorbed = 0;
  const std::vector<Contact>& contacts = last_.report.contacts.contacts;
  std::uint32_t next = 0;  // the first contact of a particle behind the last one that left
  for (std::size_t i = 0; i < gone.size(); ++i) {
    gone[i] = departed.empty() ? 0 : departed[i];
    if (!leaves(statuses[i]) || gone[i] != 0) continue;
    gone[i] = 1;
    while (next < contacts.size() && contacts[next].particle <= i) ++next;
    last_.left.push_back({ids[i], statuses[i], set_.states[i].position, next - 1});
    if (tally_ != nullptr)
      tally_->take_back(
          set_.states[i].cell,
          (1.0 - contacts[next - 1].time_of_impact) * options_.substeps * static_cast<double>(parcels_.number(set_, i)),
          plan_->class_of(set_, i));
    ++(statuses[i] == ParticleStatus::absorbed ? absorbed : last_.escaped);
    gone_.add(ids[i], whole_state(i), set_.velocities()[i], static_cast<std::uint64_t>(statuses[i]));
  }
  last_.absorbed += absorbed;
  totals_.absorbed += absorbed;
  totals_.escaped += last_.escaped;
  if (absorbed + last_.escaped == 0 && departed.empty()) return;
  set_.remove(gone);
  contacts_.forget_walls();
  if (part_ != nullptr) set_.put_in_order_of_ids();
}

void ParticleSystem::update_after_edit(const ComplexEditReport& /*edit*/, OrphanPolicy orphaned) {
  const std::vector<ParticleState> before(set_.states.states().begin(), set_.states.states().end());
  edited_.report = environment_.update_after_edit(set_.states, orphaned);
  remove_absorbed(edited_.report, before);
}

void ParticleSystem::remove_absorbed(const UpdateReport& report, std::span<const ParticleState> before) {
  std::vector<std::uint8_t> marks(set_.ids().size(), 0);
  std::uint64_t absorbed = 0;
  edited_.absorbed.clear();
  for (const OrphanedParticle& p : report.orphaned) {
    if (p.outcome != OrphanPolicy::absorb) continue;
    marks[p.particle] = 1;
    ++absorbed;
    edited_.absorbed.push_back({set_.ids()[p.particle], parcels_.number(set_, p.particle)});
    gone_.add(set_.ids()[p.particle], before[p.particle], set_.velocities()[p.particle],
              static_cast<std::uint64_t>(ParticleStatus::absorbed));
  }
  if (absorbed == 0) return;
  totals_.absorbed += absorbed;
  edited_.since_step += absorbed;
  set_.remove_rows(marks);
}

}  // namespace dartcast
