// Bodies that come and go, their energy, checkpoints.
#include "bodies/bodies_impl.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/elementary.hpp"
#include "dartcast/error.hpp"
#include "dynamics/sphere_touch.hpp"

namespace dartcast {

namespace {

// The corner of the box around some points where the potential energy is least.
Vec3 lowest_corner(std::span<const Vec3> points, const Vec3& gravity) {
  Vec3 corner = points.empty() ? Vec3{} : points.front();
  const auto lower = [](double a, double b, double g) { return g > 0.0 ? std::max(a, b) : std::min(a, b); };
  for (const Vec3& p : points) {
    corner = {lower(corner.x, p.x, gravity.x), lower(corner.y, p.y, gravity.y), lower(corner.z, p.z, gravity.z)};
  }
  return corner;
}

void check_collisions(const BodyCollisionOptions& o) {
  if (!(o.position_correction >= 0.0 && o.position_correction <= 1.0))
    throw InvalidArgument("bodies: the position_correction of collisions must be between 0 and 1");
  if (!(o.friction >= 0.0) || !std::isfinite(o.friction))
    throw InvalidArgument("bodies: the friction of collisions must be finite and not negative");
  if (o.restitution && !(*o.restitution >= 0.0 && *o.restitution <= 1.0))
    throw InvalidArgument("bodies: the restitution of collisions must be between 0 and 1");
  if (o.iterations == 0) throw InvalidArgument("bodies: collisions need an iteration at least");
}

bool leaves(ParticleStatus fate) { return fate == ParticleStatus::absorbed || fate == ParticleStatus::escaped; }

}  // namespace

Bodies::Impl::Impl(Environment& environment, const BodiesOptions& options, WallResponses responses)
    : environment_(environment),
      options_(options),
      responses_(std::move(responses)),
      lowest_(lowest_corner(environment.positions(), options.gravity)) {
  if (!(options.dt >= 0x1p-100 && options.dt <= 0x1p+100))
    throw InvalidArgument(fmt::format("bodies: dt is {}: it must be between 2^-100 and 2^100 s", options.dt));
  if (!is_finite(options.gravity)) throw InvalidArgument("bodies: gravity must be finite");
  if (!(options.drag >= 0.0) || !std::isfinite(options.drag))
    throw InvalidArgument("bodies: the drag must be finite and not negative");
  dartcast::check(options.step, "bodies");
  if (options.collisions) check_collisions(*options.collisions);
  if (environment.map().dimension() != 3) throw InvalidArgument("bodies: the environment must be of space");
}

void Bodies::Impl::check(const BodyOptions& o) const {
  const auto share = [](double x) { return x >= 0.0 && x <= 1.0; };
  if (!is_mass(o.mass))
    throw InvalidArgument(fmt::format("bodies: a body's mass is {}: it must be between 2^-300 and 2^300", o.mass));
  if (!is_radius(o.radius))
    throw InvalidArgument(fmt::format("bodies: a radius is {}: it must be between 0 and 2^100", o.radius));
  if (!share(o.pull)) throw InvalidArgument("bodies: the pull must be between 0 and 1");
  if (!(o.damping >= 0.0) || !std::isfinite(o.damping))
    throw InvalidArgument("bodies: the damping must be finite and not negative");
  if (!is_finite(o.velocity) || !is_finite(o.angular_velocity))
    throw InvalidArgument("bodies: a body's velocity and angular_velocity must be finite");
  if (!(o.stiffness >= 0.0) || !std::isfinite(o.stiffness))
    throw InvalidArgument("bodies: a stiffness must be finite and not negative");
  if (o.stiffness * (options_.dt * options_.dt) > 1.0 + 0x1p-40)
    throw InvalidArgument(fmt::format(
        "bodies: a stiffness of {} / s^2 needs steps of at most {} s; with steps of {} s it may be {} / s^2 "
        "(0 asks for that), and pull = 1 makes a body stiffer",
        o.stiffness, 1.0 / std::sqrt(o.stiffness), options_.dt, 1.0 / (options_.dt * options_.dt)));
}

AddBodyResult Bodies::Impl::add(std::span<const Vec3> points, const BodyOptions& options) {
  check(options);
  if (next_id_ >> 31U != 0)  // ids of their particles have 31 bits for the body's
    throw Error("bodies: 2^31 bodies have been added to the set: make a new one");
  const std::size_t size = points.size();
  std::vector<double> masses = options.masses;
  if (masses.empty()) masses.assign(size, options.mass / static_cast<double>(std::max<std::size_t>(size, 1)));
  RestShape shape(points, masses, options.match);
  AddBodyResult added;
  const std::vector<Location> locations = environment_.locate(points);
  for (std::uint32_t i = 0; i < size; ++i) {
    if (locations[i].place != Place::free) added.refused.push_back(i);
  }
  if (!added.refused.empty()) return added;
  std::optional<CarriedSurface> carried;
  if (!options.surface.points.empty()) {
    carried.emplace(options.surface.points, points);
    added.surface = add_surface(options.surface);
    if (added.surface.refusal != SolidRefusal::none) return added;
  }
  for (std::size_t i = 0; i < size; ++i) environment_.add(particles_, locations[i].simplex, points[i]);
  added.body = next_id_++;
  const double stiffness = options.stiffness > 0.0 ? options.stiffness : 1.0 / (options_.dt * options_.dt);
  Body body{added.body, positions_.size(), std::move(shape),
            stiffness,  options.pull,      exponential(-options.damping * options_.dt),
            {}};
  body.carried = std::move(carried);
  body.fits.resize(body.shape.cluster_count());
  body.shape.match(points, body.fits);
  positions_.insert(positions_.end(), points.begin(), points.end());
  masses_.insert(masses_.end(), masses.begin(), masses.end());
  resize_arrays(options.radius);
  const Vec3 centre = rigid_motion(masses, points, of(body, velocities_)).centre;
  for (std::size_t i = 0; i < size; ++i)
    velocities_[body.first + i] = options.velocity + cross(options.angular_velocity, points[i] - centre);
  std::fill_n(body_of_.begin() + static_cast<std::ptrdiff_t>(body.first), size,
              static_cast<std::uint32_t>(bodies_.size()));
  bodies_.push_back(std::move(body));
  pass_bodies_.resize(bodies_.size());
  find_pairs();
  return added;
}

// Gives every array an entry per position.
void Bodies::Impl::resize_arrays(double radius) {
  const std::size_t size = positions_.size();
  velocities_.resize(size);
  radii_.resize(size, radius);
  body_of_.resize(size);
  fates_.resize(size, ParticleStatus::alive);
  on_.resize(size);
  next_on_.resize(size);
  sums_.resize(size);
  goals_.resize(size);
  trial_goals_.resize(size);
  targets_.resize(size);
  reached_.resize(size);
  legs_.resize(size);
  ids_.resize(size);
  inverse_masses_.resize(size);
  led_to_.resize(size);
  corrections_.resize(size);
  outer_forces_.assign(size, Vec3{});
  contact_forces_.assign(size, Vec3{});
}

double Bodies::Impl::potential(const Body& body, std::span<const Vec3> positions) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < positions.size(); ++i)
    sum -= masses_[body.first + i] * dot(options_.gravity, positions[i] - lowest_);
  return sum;
}

double Bodies::Impl::kinetic(const Body& body) const {
  double sum = 0.0;
  for (std::size_t p = body.first; p < body.first + body.shape.size(); ++p)
    sum += 0.5 * masses_[p] * dot(velocities_[p], velocities_[p]);
  return sum;
}

BodyEnergy Bodies::Impl::energy(std::size_t body) const {
  const Body& b = bodies_[body];
  const std::span<const Vec3> positions(positions_.data() + b.first, b.shape.size());
  std::vector<Vec3> goals(b.shape.size());
  const double constant = b.shape.goals(b.fits, goals);
  return {kinetic(b), potential(b, positions), b.stiffness * matching_energy(b.shape, positions, goals, constant)};
}

RigidMotion Bodies::Impl::rigid_motion_of(std::size_t body) const {
  const Body& b = bodies_[body];
  return rigid_motion(b.shape.masses(), std::span(positions_).subspan(b.first, b.shape.size()),
                      std::span(velocities_).subspan(b.first, b.shape.size()));
}

StateHash Bodies::Impl::state_hash() const {
  StateHash hash;
  for (const Body& body : bodies_) {
    for (std::size_t i = 0; i < body.shape.size(); ++i) {
      const std::size_t p = body.first + i;
      hash.add((std::uint64_t{body.id} << 32U) | i, particles_[p], velocities_[p],
               static_cast<std::uint64_t>(fates_[p]));
    }
  }
  const std::vector<std::uint32_t> owners = bodies_with_surface();
  for (std::size_t s = 0; s < owners.size(); ++s) {
    const auto first = surfaces_.set->first_vertices();
    const std::uint64_t id = std::uint64_t{bodies_[owners[s]].id} << 32U;
    for (std::uint32_t v = first[s]; v < first[s + 1]; ++v)
      hash.add(id | (1U << 31U) | (v - first[s]), surfaces_.set->particles()[v], {});
  }
  return hash;
}

UpdateReport Bodies::Impl::update_after_edit(OrphanPolicy orphaned) {
  if (surfaces_.set) surfaces_.set->update_after_edit();  // first: it may refuse
  UpdateReport report = environment_.update_after_edit(particles_, orphaned);
  std::vector<std::uint8_t> absorbed(positions_.size(), 0);
  std::vector<std::uint8_t> leaving(bodies_.size(), 0);
  for (const OrphanedParticle& s : report.orphaned) {
    if (s.outcome != OrphanPolicy::absorb) continue;
    absorbed[s.particle] = 1;
    leaving[body_of_[s.particle]] = 1;
  }
  std::vector<std::uint8_t> marks;  // of the particles that remain
  for (std::size_t p = 0; p < absorbed.size(); ++p) {
    if (absorbed[p] == 0) marks.push_back(leaving[body_of_[p]]);
  }
  particles_.remove(marks);
  remove_bodies(leaving);
  for (std::size_t p = 0; p < positions_.size(); ++p) positions_[p] = particles_[p].position;
  for (Body& body : bodies_) body.shape.match(of(body, positions_), body.fits);
  find_pairs();
  return report;
}

void Bodies::Impl::remove_gone() {
  std::vector<std::uint8_t> leaving(bodies_.size(), 0);
  for (std::size_t p = 0; p < fates_.size(); ++p) {
    if (leaves(fates_[p])) leaving[body_of_[p]] = 1;
  }
  if (std::find(leaving.begin(), leaving.end(), 1) == leaving.end()) return;
  std::vector<std::uint8_t> marks(fates_.size());
  for (std::size_t p = 0; p < marks.size(); ++p) marks[p] = leaving[body_of_[p]];
  particles_.remove(marks);
  for (std::size_t b = 0; b < leaving.size(); ++b) {
    if (leaving[b] != 0) last_.gone.push_back(bodies_[b].id);
  }
  remove_bodies(leaving);
}

// Removes the entries of all arrays but `particles_`, whose owner removes its own.
void Bodies::Impl::remove_bodies(std::span<const std::uint8_t> leaving) {
  const std::vector<std::uint32_t> owners = bodies_with_surface();
  for (std::size_t s = owners.size(); s-- > 0;) {
    if (leaving[owners[s]] != 0) surfaces_.set->remove(static_cast<std::uint32_t>(s));
  }
  std::size_t particle = 0;
  std::vector<Body> kept;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    Body& body = bodies_[b];
    if (leaving[b] != 0) continue;
    for (std::size_t i = 0; i < body.shape.size(); ++i) {
      const std::size_t from = body.first + i;
      const std::size_t to = particle + i;
      positions_[to] = positions_[from];
      velocities_[to] = velocities_[from];
      masses_[to] = masses_[from];
      radii_[to] = radii_[from];
      fates_[to] = fates_[from];
      on_[to] = on_[from];
      body_of_[to] = static_cast<std::uint32_t>(kept.size());
    }
    body.first = particle;
    particle += body.shape.size();
    kept.push_back(std::move(body));
  }
  bodies_ = std::move(kept);
  positions_.resize(particle);
  masses_.resize(particle);
  pass_bodies_.resize(bodies_.size());
  resize_arrays(0.0);
}

BodiesCheckpoint Bodies::Impl::checkpoint() const {
  BodiesCheckpoint saved;
  saved.steps = steps_;
  saved.counters = counters_;
  saved.impulses.assign(collisions_.solver().cached_impulses().begin(), collisions_.solver().cached_impulses().end());
  for (const Body& body : bodies_) {
    saved.ids.push_back(body.id);
    saved.fits.insert(saved.fits.end(), body.fits.begin(), body.fits.end());
  }
  for (std::size_t p = 0; p < fates_.size(); ++p)
    saved.particles.push_back({particles_[p], particles_.held_weights(p), velocities_[p], fates_[p], on_[p]});
  if (surfaces_.set) saved.surfaces = surfaces_.set->checkpoint();
  return saved;
}

void Bodies::Impl::restore(const BodiesCheckpoint& saved) {
  std::vector<std::uint8_t> leaving(bodies_.size(), 1);
  std::size_t next = 0;
  std::size_t particles = 0;
  std::size_t fits = 0;
  std::size_t vertices = 0;
  for (std::size_t b = 0; b < bodies_.size() && next < saved.ids.size(); ++b) {
    if (bodies_[b].id != saved.ids[next]) continue;
    leaving[b] = 0;
    particles += bodies_[b].shape.size();
    fits += bodies_[b].fits.size();
    vertices += bodies_[b].carried ? bodies_[b].carried->vertex_count() : 0;
    ++next;
  }
  if (next != saved.ids.size() || particles != saved.particles.size() || fits != saved.fits.size() ||
      vertices != saved.surfaces.states.size())
    throw InvalidArgument("bodies: the checkpoint is of other bodies: add the same bodies in the same order first");
  std::vector<ParticleState> states;
  std::vector<Weights> weights;
  for (const BodiesCheckpoint::Particle& p : saved.particles) {
    states.push_back(p.state);
    weights.push_back(p.held_weights);
  }
  particles_ = environment_.restored(states, weights);
  remove_bodies(leaving);
  if (surfaces_.set) surfaces_.set->restore(saved.surfaces);
  for (std::size_t p = 0; p < saved.particles.size(); ++p) {
    positions_[p] = saved.particles[p].state.position;
    velocities_[p] = saved.particles[p].velocity;
    fates_[p] = saved.particles[p].fate;
    on_[p] = saved.particles[p].on;
  }
  auto fit = saved.fits.begin();
  for (Body& body : bodies_) {
    std::copy_n(fit, body.fits.size(), body.fits.begin());
    fit += static_cast<std::ptrdiff_t>(body.fits.size());
  }
  steps_ = saved.steps;
  counters_ = saved.counters;
  collisions_.solver().set_cached_impulses(saved.impulses);
  find_pairs();
}

}  // namespace dartcast
