// The simulation's interface: a step, an edit and a checkpoint go through all components in their order.
#include "dartcast/simulation.hpp"

#include <utility>

#include "base/are_several.hpp"
#include "dartcast/error.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/validity.hpp"
#include "simulation/balance.hpp"
#include "simulation/gathered_step.hpp"
#include "simulation/simulation_parts.hpp"
#include "simulation/simulation_state.hpp"
#include "simulation/simulation_view.hpp"
#include "simulation/timer.hpp"

namespace dartcast {

SimulationCheckpoint::SimulationCheckpoint(SimulationState state)
    : state_(std::make_shared<const SimulationState>(std::move(state))) {}

std::uint64_t SimulationCheckpoint::steps() const { return state_->particles.steps; }

Simulation::Simulation(Environment& environment, const SimulationOptions& options)
    : parts_(std::make_unique<Parts>(nullptr, environment, options)) {}

Simulation::~Simulation() = default;

// If ranks share the simulation by cells, these may first move between them. Files of the motion or of fields that cannot
// be read end a step before anything changes. Then a step goes through these phases:
//  1. events that are due edit the environment;
//  2. the particles step: inlets inject, vertices move, velocities change, particles advance, some leave;
//  3. the other components step in the environment as it stands then: solids, bodies, catheters, statistics;
//  4. the first rank gets what happened on all, and statistics count it;
//  5. invalid cells are remeshed and crowded cells are subdivided, if that is due.
const SimulationStep& Simulation::step() {
  constexpr std::uint64_t steps_between_balances = 10;
  if (parts_->motion_of_part && steps() % steps_between_balances == 0) balance(*parts_);
  const double begin = time();
  parts_->motion.load_step();
  parts_->particles.aiming().load_step();
  parts_->particles.sampled().hold(time(), time() + options().dt);
  parts_->events.before_step(*this);
  parts_->particles.inject(parts_->inlets);
  parts_->statistics.note_start();
  for (SimulationComponent* component : parts_->components) {
    const ScopeTimer timer(parts_->clock_of(component));
    component->step(begin);
  }
  if (are_several(options().ranks))
    gather_step(*options().ranks, parts_->particles, parts_->statistics, parts_->gathers_contacts);
  parts_->statistics.count();
  parts_->events.after_step(*this);
  return parts_->particles.last_step();
}

SimulationEdit Simulation::edit(const std::function<void(ComplexEdit&)>& make, OrphanPolicy orphaned) {
  SimulationEdit done;
  done.edit = parts_->environment.edit(make);
  parts_->followers.call(done.edit, orphaned);
  done.particles = parts_->particles.edited().report;
  return done;
}

void Simulation::set_after_edit(AfterEdit after_edit) { parts_->after_edit = std::move(after_edit); }

RepairReport Simulation::repair(const RepairOptions& options) {
  std::vector<Cell> invalid;
  for (const InvalidCell& c : environment().validity(static_cast<std::size_t>(-1)).first) invalid.push_back(c.cell);
  RepairReport report;
  if (invalid.empty()) return report;
  edit([&](ComplexEdit& e) { report = dartcast::repair(e, invalid, options); });
  return report;
}

AdaptiveSubdivisionReport Simulation::adapt() { return parts_->events.adapt(*this); }

void Simulation::set_events(std::vector<Event> events) { parts_->events.set_events(std::move(events)); }
void Simulation::set_remeshing(const RemeshScene& remeshing) { parts_->events.set_remeshing(remeshing); }
void Simulation::set_adaptive_subdivision(const AdaptiveSubdivisionScene& subdivision) {
  parts_->events.set_adaptive_subdivision(subdivision);
}

void Simulation::set_statistics(const StatisticsOptions& options) {
  if (!options.cells.empty() && parts_->part)
    throw InvalidArgument(
        "simulation: quantities by cell are not kept if ranks share the cells: let them share the "
        "particles");
  parts_->statistics.set_options(options);
  parts_->particles.set_tally(parts_->statistics.tally(), parts_->statistics.plan());
  parts_->particles.list_parcels(parts_->statistics.lists_parcels());
}
const StatisticsOptions& Simulation::statistics_options() const { return parts_->statistics.options(); }
const Statistics& Simulation::statistics() const { return parts_->statistics.statistics(); }

SimulationCheckpoint Simulation::checkpoint() const {
  SimulationState state;
  for (const SimulationComponent* component : parts_->components) component->save(state);
  state.events = parts_->events.log();
  return SimulationCheckpoint(std::move(state));
}

void Simulation::restore(const SimulationCheckpoint& saved) {
  parts_->statistics.check(saved.state());
  parts_->motion.set_known_places(saved.state().solids.places);
  {
    const Followers::Repeating repeating(parts_->followers);
    parts_->events.replay(*this, saved.state().events);
  }
  parts_->motion.set_known_places({});
  // Whether states fit is seen only where the vertices stand as they did then. So a refusal comes late, and is undone.
  const SimulationCheckpoint former = checkpoint();
  const VertexPlaces places = parts_->motion.places();
  try {
    parts_->motion.restore(saved.state());
    for (SimulationComponent* component : parts_->components) component->restore(saved.state());
  } catch (...) {
    parts_->motion.put_back(places);
    for (SimulationComponent* component : parts_->components) component->restore(former.state());
    throw;
  }
  parts_->events.set_log(saved.state().events);
}

void Simulation::go_to(std::uint64_t steps) {
  if (particles().size() > 0)
    throw InvalidArgument(
        "simulation: its particles cannot follow to another step: use a simulation without particles");
  parts_->motion.go_to(steps);
}

void Simulation::set_field(VelocityField field) {
  parts_->motion_of_part = {};
  parts_->particles.aiming().set_field(std::move(field));
}
void Simulation::set_force(VectorField force) {
  parts_->motion_of_part = {};
  parts_->particles.aiming().set_force(std::move(force));
}
void Simulation::set_deformation(Deformation deformation) {
  parts_->motion_of_part = {};
  parts_->motion.set_deformation(std::move(deformation));
}

void Simulation::pull(std::span<const Vec3> displacement, double duration) {
  parts_->motion_of_part = {};
  parts_->motion.pull(displacement, duration);
}

void Simulation::steer(std::size_t catheter, const CatheterInput& input) { parts_->catheters.steer(catheter, input); }

void Simulation::steer_solid(std::size_t solid, const Vec3& velocity, const Vec3& turn) {
  parts_->solids.steer(solid, velocity, turn);
}

void Simulation::set_law(ParticleLaw law) { parts_->particles.aiming().set_law(std::move(law)); }

void Simulation::add_inlet(Patch patch, double rate, const Vec3& velocity, double radius,
                           std::span<const double> user_data, const Material& material) {
  ParticlesScene group;
  group.velocity = velocity;
  group.radius = radius;
  group.user_data.assign(user_data.begin(), user_data.end());
  group.material = material;
  parts_->inlets.add(group, InletParticles{{}, rate}, patch, parts_->particles.sampled_part());
  parts_->motion_of_part = {};
}

std::vector<AddResult> Simulation::add(std::span<const Vec3> positions, const Vec3& velocity, double radius,
                                       std::span<const double> user_data, const Material& material) {
  return parts_->particles.add(positions, {velocity, radius, user_data, material});
}

std::vector<AddResult> Simulation::add(std::initializer_list<Vec3> positions, const Vec3& velocity, double radius) {
  return parts_->particles.add({positions.begin(), positions.size()}, {velocity, radius, {}, {}});
}

std::vector<AddResult> Simulation::add(std::span<const Vec3> positions, std::span<const Vec3> velocities,
                                       std::span<const double> radii, std::span<const double> user_data,
                                       std::span<const Material> materials) {
  return parts_->particles.add(positions, velocities, radii, user_data, materials);
}

void Simulation::add_random(std::size_t count, const Vec3& velocity, double radius, std::span<const double> user_data,
                            const Material& material) {
  parts_->particles.add_random(count, {velocity, radius, user_data, material});
}

namespace {

// With collisions the spheres meet the bodies.
void introduce(ParticleSystem& particles, BodiesComponent& bodies) {
  if (particles.options().collisions && bodies.bodies()) particles.sphere_contacts().set_bodies(*bodies.bodies());
}

}  // namespace

AddBodyResult Simulation::add_body(std::span<const Vec3> points, const BodyOptions& options) {
  AddBodyResult added = parts_->bodies.add(points, options);
  if (!options.surface.points.empty()) parts_->move_walls_jointly();
  introduce(parts_->particles, parts_->bodies);
  return added;
}

void Simulation::add(const BodyScene& body) {
  parts_->bodies.add(body);
  if (body.edges) parts_->move_walls_jointly();
  introduce(parts_->particles, parts_->bodies);
}

void Simulation::add(const CatheterScene& catheter) {
  parts_->catheters.add(catheter);
  if (catheter.options.edges) parts_->move_walls_jointly();
}

void Simulation::add(const SolidScene& solid) {
  parts_->solids.add(solid);
  parts_->move_walls_jointly();
}

const SimulationOptions& Simulation::options() const { return parts_->particles.options(); }
std::uint64_t Simulation::steps() const { return parts_->motion.steps(); }
const Environment& Simulation::environment() const { return parts_->environment; }
void Simulation::set_replay_hook(ReplayHook hook) { parts_->environment.set_replay_hook(std::move(hook)); }
bool Simulation::deforms() const { return parts_->motion.deforms(); }
const Particles& Simulation::particles() const { return parts_->particles.set().states; }
std::span<const std::uint64_t> Simulation::ids() const { return parts_->particles.set().ids(); }
std::span<const Vec3> Simulation::velocities() const { return parts_->particles.set().velocities(); }
std::span<const ParticleStatus> Simulation::statuses() const { return parts_->particles.set().statuses(); }
std::span<const std::uint32_t> Simulation::contact_counts() const { return parts_->particles.set().contact_counts(); }
std::span<const double> Simulation::radii() const { return parts_->particles.set().radii(); }
std::span<const double> Simulation::diameters() const {
  const ParticleTable& table = parts_->particles.set().table;
  return table[table.diameter];
}
std::span<const double> Simulation::densities() const {
  const ParticleTable& table = parts_->particles.set().table;
  return table[table.density];
}
std::span<const double> Simulation::charges_per_mass() const {
  const ParticleTable& table = parts_->particles.set().table;
  return table[table.charge_per_mass];
}
std::span<const std::uint8_t> Simulation::held() const { return parts_->particles.set().held(); }
std::span<const double> Simulation::user_data(std::size_t particle) const {
  return std::as_const(parts_->particles).set().user_data(particle);
}
std::span<double> Simulation::user_data(std::size_t particle) { return parts_->particles.set().user_data(particle); }
std::vector<Vec3> Simulation::unwrapped() const {
  const ParticleSystem& system = parts_->particles;
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < system.set().ids().size(); ++i)
    places.push_back(system.images().unwrapped(system.set().states[i].position, system.set().user_data(i)));
  return places;
}

const Bodies* Simulation::bodies() const {
  const std::optional<Bodies>& bodies = std::as_const(parts_->bodies).bodies();
  return bodies ? &*bodies : nullptr;
}
Bodies* Simulation::bodies() { return parts_->bodies.bodies() ? &*parts_->bodies.bodies() : nullptr; }
const BodiesStep& Simulation::bodies_step() const { return parts_->bodies.last_step(); }
std::size_t Simulation::catheter_count() const { return parts_->catheters.catheters().size(); }
const Catheter& Simulation::catheter(std::size_t i) const { return parts_->catheters.catheters()[i]; }
const CatheterStep& Simulation::catheter_step(std::size_t i) const { return parts_->catheters.last_steps()[i]; }

const SolidSet* Simulation::solids() const {
  const std::optional<SolidSet>& solids = parts_->solids.solids();
  return solids ? &*solids : nullptr;
}
const SolidStep& Simulation::solids_step() const { return parts_->solids.last_step(); }

const SimulationTotals& Simulation::totals() const { return parts_->particles.totals(); }
double Simulation::seconds_solids() const { return parts_->seconds_solids; }
const EventLog& Simulation::event_log() const { return parts_->events.log(); }
std::vector<BodySummary> Simulation::body_summaries() const { return parts_->bodies.summaries(); }
std::vector<CatheterSummary> Simulation::catheter_summaries() const { return parts_->catheters.summaries(); }
std::vector<SolidSummary> Simulation::solid_summaries() const { return parts_->solids.summaries(); }

SimulationView view_of(const Simulation& simulation) {
  const Simulation::Parts& p = simulation.parts();
  return {p.particles, p.solids, p.bodies, p.catheters, p.part.get(), p.part_mesh.get(), p.balanced};
}

}  // namespace dartcast
