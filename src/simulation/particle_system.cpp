#include "dartcast/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string_view>
#include <utility>

#include "base/parallel.hpp"
#include "complex/simplex.hpp"
#include "dartcast/error.hpp"
#include "simulation/polyline.hpp"
#include "tracking/carry.hpp"

namespace dartcast {

namespace {

constexpr std::size_t grain = 512;
constexpr double max_injected = 0x1p+31;  // by an inlet in a step

// Adds the time that it lives to a sum of seconds.
class Timer {
 public:
  explicit Timer(double& seconds) : seconds_(seconds) {}
  ~Timer() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

bool leaves_plane(const Environment& environment, const Vec3& v) {
  return environment.map().dimension() == 2 && v.z != 0.0;
}

void check_plane(const Environment& environment, const Vec3& v, std::string_view what) {
  if (leaves_plane(environment, v))
    throw InvalidArgument(fmt::format("flow: {} is ({}, {}, {}): in the plane its z must be 0", what, v.x, v.y, v.z));
}

void check(const SimulationOptions& o) {
  if (!(o.dt >= smallest_dt && o.dt <= largest_dt))
    throw InvalidArgument(fmt::format("flow: dt is {}: it must be between 2^-100 and 2^100 s", o.dt));
  if (!(o.drag >= 0.0) || !std::isfinite(o.drag)) throw InvalidArgument("flow: drag must be finite and not negative");
  if (!is_finite(o.gravity)) throw InvalidArgument("flow: gravity must be finite");
  if (o.substeps == 0) throw InvalidArgument("flow: substeps must be at least 1");
  check(o.step, "flow");
  if (!o.collisions) return;
  const CollisionOptions& c = *o.collisions;
  if (!(c.restitution >= 0.0 && c.restitution <= 1.0))
    throw InvalidArgument("flow: the spheres' restitution must be between 0 and 1");
  if (!(c.friction >= 0.0) || !std::isfinite(c.friction))
    throw InvalidArgument("flow: the spheres' friction must be finite and not negative");
  if (!(c.density >= smallest_density && c.density <= largest_density))
    throw InvalidArgument(
        fmt::format("flow: the spheres' density is {}: it must be between 2^-100 and 2^100", c.density));
  if (c.iterations == 0) throw InvalidArgument("flow: collisions need an iteration at least");
}

template <class T>
void keep_unmarked(std::vector<T>& values, std::span<const std::uint8_t> marks) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (marks[i] == 0) values[kept++] = values[i];
  }
  values.resize(kept);
}

}  // namespace

Simulation::Simulation(Environment& environment, const SimulationOptions& options, WallResponses responses)
    : environment_(environment), options_(options), responses_(std::move(responses)), random_(options.seed) {
  check(options);
  check_plane(environment, options.gravity, "gravity");
  totals_.contacts_by_patch.resize(environment.map().patch_names().size());
}

void Simulation::set_deformation(Deformation deformation) {
  if (deformation.size() != environment_.positions().size()) {
    throw InvalidArgument("flow: the deformation is made for another number of points than the environment has");
  }
  if (environment_.map().dimension() == 2) deformation.check_plane();
  deformation_ = std::move(deformation);
}

void Simulation::check_motion(const Vec3& velocity, double radius, std::string_view whose) const {
  if (!is_finite(velocity)) throw InvalidArgument(fmt::format("flow: {} velocity must be finite", whose));
  check_plane(environment_, velocity, fmt::format("{} velocity", whose));
  if (!is_radius(radius))
    throw InvalidArgument(fmt::format("flow: {} radius is {}: it must be between 0 and 2^100", whose, radius));
}

void Simulation::add_inlet(Patch patch, double rate, const Vec3& velocity, double radius) {
  if (!(rate >= 0.0 && rate * options_.dt <= max_injected))
    throw InvalidArgument(
        fmt::format("flow: an inlet's rate is {}: it must not be negative, and at most {} a second with steps of {} s "
                    "(2^31 particles a step)",
                    rate, max_injected / options_.dt, options_.dt));
  check_motion(velocity, radius, "an inlet's");
  inlets_.push_back({patch, PatchSampler(environment_.complex(), patch), rate, velocity, radius});
}

std::vector<AddResult> Simulation::add(std::span<const Vec3> positions, const Vec3& velocity, double radius) {
  check_motion(velocity, radius, "a particle's");
  std::vector<AddResult> added = environment_.add(particles_, positions);
  complete(velocity, radius);
  totals_.start = next_id_ - totals_.injected;
  return added;
}

std::vector<AddResult> Simulation::add(std::span<const Vec3> positions, std::span<const Vec3> velocities,
                                       std::span<const double> radii) {
  if (velocities.size() != positions.size() || radii.size() != positions.size())
    throw InvalidArgument(fmt::format("flow: {} velocities and {} radii for {} positions", velocities.size(),
                                      radii.size(), positions.size()));
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const bool good = is_finite(velocities[i]) && !leaves_plane(environment_, velocities[i]) && is_radius(radii[i]);
    if (!good) check_motion(velocities[i], radii[i], fmt::format("particle {}'s", i));
  }
  std::vector<AddResult> added = environment_.add(particles_, positions);
  for (std::size_t i = 0; i < added.size(); ++i) {
    if (added[i].location.place == Place::free) complete_next(velocities[i], radii[i]);
  }
  totals_.start = next_id_ - totals_.injected;
  return added;
}

// Gives ids, velocities and radii to the particles added last.
void Simulation::complete(const Vec3& velocity, double radius) {
  while (ids_.size() < particles_.size()) complete_next(velocity, radius);
}

void Simulation::complete_next(const Vec3& velocity, double radius) {
  ids_.push_back(next_id_++);
  velocities_.push_back(velocity);
  fates_.push_back(ParticleStatus::alive);
  contact_counts_.push_back(0);
  radii_.push_back(radius);
  held_.push_back(0);
  if (radius > 0.0) ++spheres_;
}

// Sampled points are rounded: one that fell out of its simplex is drawn again.
template <class Sampler>
void Simulation::add_sampled(const Sampler& sampler, std::size_t count, const Vec3& velocity, double radius) {
  constexpr int max_tries = 1000;
  for (std::size_t i = 0; i < count; ++i) {
    int tries = 0;
    while (true) {
      const Sample s = sampler.sample(environment_.complex(), random_);
      if (environment_.add(particles_, s.simplex, flushed(s.position))) break;
      if (++tries == max_tries) {
        complete(velocity, radius);
        throw InvalidArgument(
            "flow: random points fall outside the free cells again and again: their cells are too thin or not valid");
      }
    }
  }
  complete(velocity, radius);
}

void Simulation::move_vertices_to(std::uint64_t steps) {
  if (!deformation_ || steps == 0) return;
  deformation_->positions(static_cast<double>(steps) * options_.dt, environment_.next_positions(),
                          environment_.threads());
  environment_.move();
}

void Simulation::add_random(std::size_t count, const Vec3& velocity, double radius) {
  check_motion(velocity, radius, "a particle's");
  if (count > 0) add_sampled(VolumeSampler(environment_.complex()), count, velocity, radius);
  totals_.start = next_id_ - totals_.injected;
}

const SimulationStep& Simulation::step() {
  last_ = {};
  last_.duration = options_.dt;
  last_.absorbed = std::exchange(absorbed_between_, 0);
  inject();
  if (!collides()) move_vertices();
  for (unsigned segment = 0; segment < options_.substeps; ++segment) advance_segment(segment);
  const Timer timer(totals_.seconds_respond);
  totals_.counters += last_.report.counters;
  totals_.collisions += last_.collisions;
  count_contacts();
  mark_held();
  remove_gone();
  ++steps_;
  return last_;
}

void Simulation::inject() {
  const Timer timer(totals_.seconds_respond);
  for (Inlet& inlet : inlets_) {
    const auto up_to = [&](std::uint64_t steps) {
      return std::floor(inlet.rate * options_.dt * static_cast<double>(steps));
    };
    const auto count = static_cast<std::uint64_t>(up_to(steps_ + 1) - up_to(steps_));
    if (count == 0 || !inlet.sampler) continue;
    if (deformation_) inlet.sampler->update(environment_.complex());
    add_sampled(*inlet.sampler, count, inlet.velocity, inlet.radius);
    last_.injected += count;
  }
  totals_.injected += last_.injected;
}

void Simulation::move_vertices() {
  if (!deformation_) return;
  const Timer timer(totals_.seconds_deform);
  move_vertices_to(steps_ + 1);
}

void Simulation::advance_segment(unsigned segment) {
  const double dt = options_.dt / options_.substeps;
  const bool moving = deformation_ && segment == 0;
  if (collides()) {
    {
      const Timer timer(totals_.seconds_collide);
      collide(dt, moving);
    }
    if (moving) {
      move_vertices();
      aim_stuck(dt);
    }
  } else {
    const Timer timer(totals_.seconds_respond);
    aim(dt, moving);
  }
  const Timer timer(totals_.seconds_detect);
  const ContactCallback respond = respond_with(responses_, velocities_, fates_, options_.dt, acceleration(dt));
  if (spheres_ == 0) {
    StepReport report = environment_.advance(particles_, targets_, respond, options_.step);
    hold_stopped(report, responses_, velocities_, fates_, options_.dt, acceleration(dt));
    append_segment(last_.report, std::move(report), segment, options_.substeps);
    return;
  }
  const std::span<const double> clearances = collides() ? clearances_ : std::span<const double>();
  SphereReport report =
      stepper_.advance(environment_, particles_, radii_, targets_, respond, options_.step, clearances);
  hold_stopped(report.step, responses_, velocities_, fates_, options_.dt, acceleration(dt));
  append_segment(last_.report, std::move(report.step), segment, options_.substeps);
  for (const SphereOverlap& o : report.overlaps) totals_.deepest_in_wall = std::max(totals_.deepest_in_wall, o.depth);
  totals_.wall_overlaps += report.overlaps.size();
  last_.overlaps.insert(last_.overlaps.end(), report.overlaps.begin(), report.overlaps.end());
}

void Simulation::aim(double dt, bool moving) {
  targets_.resize(particles_.size());
  parallel_for(particles_.size(), grain, environment_.threads(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Aim a = fates_[i] == ParticleStatus::absorbed || fates_[i] == ParticleStatus::escaped
                        ? Aim{velocities_[i], particles_[i].position}
                        : aim_at(i, dt, moving);
      velocities_[i] = a.velocity;
      targets_[i] = flushed(a.target);
    }
  });
}

Vec3 Simulation::accelerated(const Vec3& v, const Vec3& flow, double dt) const {
  if (options_.drag == 0.0) return field_ ? flow : v + options_.gravity * dt;
  const double lost = -std::expm1(-options_.drag * dt);
  return v + (flow + options_.gravity * (1.0 / options_.drag) - v) * lost;
}

// What contacts know of the forces: nothing where a field or other spheres make velocities, too. Drag takes its part.
Acceleration Simulation::acceleration(double dt) const {
  if (field_ || collides()) return {};
  if (options_.drag == 0.0) return {options_.gravity, dt};
  return {options_.gravity * (-std::expm1(-options_.drag * dt) / (options_.drag * dt)), dt};
}

// A particle's velocity after the acceleration, and where it then wants to go: relative to positions before a move. One
// that is held takes no step; one that sticks goes where riding along puts it, to the last bit, so that no contact
// follows.
Simulation::Aim Simulation::aim_at(std::size_t i, double dt, bool moving) const {
  const ParticleState& s = particles_[i];
  if (s.held) return {velocities_[i], s.position};
  const bool stuck = fates_[i] == ParticleStatus::stuck;
  if (!stuck && !field_) {
    const Vec3 v = accelerated(velocities_[i], {}, dt);
    return {v, s.position + v * dt};
  }
  if (stuck && !moving) return {velocities_[i], s.position};
  const CellComplex& complex = environment_.complex();
  const Corners now = complex.corners(s.at());
  const Corners before = deforms() ? complex.previous_corners(s.at()) : now;
  const Weights w = detail::barycentric(moving ? before : now, s.position);
  const Vec3 carried = detail::combine(now, w);
  const Vec3 mesh = (carried - detail::combine(before, w)) * (1.0 / options_.dt);
  if (stuck) {
    const bool positive = volume_sign(now) == Sign::positive;
    return {mesh, positive ? detail::carried(complex, s.at(), w).position : s.position};
  }
  const Vec3 flow = field_->at(complex, s.at(), w, now);
  if (field_->frame() == FieldFrame::space) {
    const Vec3 v = accelerated(velocities_[i], flow, dt);
    return {v, s.position + v * dt};
  }
  const Vec3 v = accelerated(velocities_[i], flow + mesh, dt);
  return {v, (moving ? carried : s.position) + (v - mesh) * dt};
}

void Simulation::count_contacts() {
  const ContactList& list = last_.report.contacts;
  last_.contact_ids.reserve(list.contacts.size());
  for (const Contact& c : list.contacts) {
    last_.contact_ids.push_back(ids_[c.particle]);
    ++contact_counts_[c.particle];
    ++totals_.contacts_by_patch[list.walls_of(c).front().patch.value];
  }
}

void Simulation::mark_held() {
  std::fill(held_.begin(), held_.end(), std::uint8_t{0});
  for (const HeldParticle& h : last_.report.held) held_[h.particle] = 1;
}

void Simulation::remove_gone() {
  std::vector<std::uint8_t> gone(particles_.size(), 0);
  std::uint64_t absorbed = 0;
  for (std::size_t i = 0; i < gone.size(); ++i) {
    const ParticleStatus fate = fates_[i];
    if (fate != ParticleStatus::absorbed && fate != ParticleStatus::escaped) continue;
    gone[i] = 1;
    ++(fate == ParticleStatus::absorbed ? absorbed : last_.escaped);
    gone_.add(ids_[i], particles_[i], velocities_[i], static_cast<std::uint64_t>(fate));
  }
  last_.absorbed += absorbed;
  totals_.absorbed += absorbed;
  totals_.escaped += last_.escaped;
  if (absorbed + last_.escaped == 0) return;
  particles_.remove(gone);
  remove_marked(gone);
}

// What is kept beside the particles themselves.
void Simulation::remove_marked(std::span<const std::uint8_t> marks) {
  keep_unmarked(ids_, marks);
  keep_unmarked(velocities_, marks);
  keep_unmarked(fates_, marks);
  keep_unmarked(contact_counts_, marks);
  keep_unmarked(radii_, marks);
  keep_unmarked(held_, marks);
  clear_.clear();
  count_spheres();
}

void Simulation::count_spheres() {
  spheres_ = static_cast<std::size_t>(std::count_if(radii_.begin(), radii_.end(), [](double r) { return r > 0.0; }));
}

}  // namespace dartcast
