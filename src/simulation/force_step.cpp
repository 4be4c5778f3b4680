// Two stages of a segment under forces.
//
// Phases: Sample the fluid at the particles. Compute forces, then the user's law. Move to the middle. Continue the
// samples to there. Compute both again. Move over the whole segment with these. Without a law all of this is done for a
// block of particles, then for the next.
#include "simulation/force_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "base/parallel.hpp"
#include "complex/simplex.hpp"
#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "tracking/carry.hpp"

namespace dartcast {

namespace {

constexpr std::size_t force_grain = 512;  // a multiple of the lanes of a vector

bool has_term(const ForceOptions& forces, Force term) {
  return std::find(forces.terms.begin(), forces.terms.end(), term) != forces.terms.end();
}

bool has_drag(const ForceOptions& forces) {
  return has_term(forces, Force::stokes) || has_term(forces, Force::schiller_naumann) ||
         has_term(forces, Force::putnam);
}

bool needs_fluid_density(Force term) {
  switch (term) {
    case Force::schiller_naumann:
    case Force::putnam:
    case Force::buoyancy:
    case Force::pressure_gradient:
    case Force::virtual_mass:
    case Force::saffman_mei: return true;
    case Force::stokes:
    case Force::lorentz:
    case Force::brownian: break;
  }
  return false;
}

detail::ForceTerms terms_of(const SimulationOptions& options) {
  using Drag = detail::ForceTerms::Drag;
  const ForceOptions& forces = options.forces;
  detail::ForceTerms terms;
  if (has_term(forces, Force::stokes)) terms.drag = Drag::stokes;
  if (has_term(forces, Force::schiller_naumann)) terms.drag = Drag::schiller_naumann;
  if (has_term(forces, Force::putnam)) terms.drag = Drag::putnam;
  terms.buoyancy = has_term(forces, Force::buoyancy);
  terms.pressure_gradient = has_term(forces, Force::pressure_gradient);
  terms.virtual_mass = has_term(forces, Force::virtual_mass);
  terms.saffman_mei = has_term(forces, Force::saffman_mei);
  terms.lorentz = has_term(forces, Force::lorentz);
  terms.brownian = has_term(forces, Force::brownian);
  terms.fluid = forces.fluid;
  terms.gravity = options.gravity;
  terms.electric_field = forces.electric_field;
  terms.magnetic_field = forces.magnetic_field;
  return terms;
}

void check_fluid(const ForceOptions& forces) {
  const Fluid& fluid = forces.fluid;
  const auto check = [](double value, const char* name) {
    if (!(value == 0.0 || (value >= smallest_density && value <= largest_density)))
      throw InvalidArgument(
          fmt::format("simulation: the fluid's {} is {}: it must be 0, or between 2^-100 and 2^100", name, value));
  };
  check(fluid.density, "density");
  check(fluid.viscosity, "viscosity");
  check(fluid.mean_free_path, "mean free path");
  check(fluid.temperature, "temperature");
  check(fluid.surface_tension, "surface tension");
  if (fluid.density == 0.0 && std::any_of(forces.terms.begin(), forces.terms.end(), needs_fluid_density))
    throw InvalidArgument("simulation: the forces need the fluid's density: give it");
  if (fluid.viscosity == 0.0 && (has_drag(forces) || has_term(forces, Force::saffman_mei)))
    throw InvalidArgument("simulation: the forces need the fluid's viscosity: give it");
  if (fluid.temperature == 0.0 && has_term(forces, Force::brownian))
    throw InvalidArgument("simulation: the force brownian needs the fluid's temperature: give it");
}

void check_terms(const ForceOptions& forces) {
  for (auto term = forces.terms.begin(); term != forces.terms.end(); ++term) {
    if (std::find(forces.terms.begin(), term, *term) != term)
      throw InvalidArgument("simulation: a force is given twice: give each once");
  }
  const int drags = (has_term(forces, Force::stokes) ? 1 : 0) + (has_term(forces, Force::schiller_naumann) ? 1 : 0) +
                    (has_term(forces, Force::putnam) ? 1 : 0);
  if (drags > 1) throw InvalidArgument("simulation: there are several laws of drag among the forces: give one of them");
  if (drags == 0 && has_term(forces, Force::brownian))
    throw InvalidArgument("simulation: the force brownian belongs to drag: give one of its laws, too");
}

// Particles that take part in the forces.
bool takes_part(const ParticleState& state, ParticleStatus status) {
  return status == ParticleStatus::alive && !state.held;
}

}  // namespace

void check_forces(const SimulationOptions& options, bool planar) {
  const ForceOptions& forces = options.forces;
  check_fluid(forces);
  check_terms(forces);
  if (!is_finite(forces.electric_field) || !is_finite(forces.magnetic_field))
    throw InvalidArgument("simulation: electric and magnetic fields must be finite");
  if (planar && (forces.electric_field.z != 0.0 || forces.magnetic_field.x != 0.0 || forces.magnetic_field.y != 0.0))
    throw InvalidArgument(
        "simulation: in the plane the electric field's z must be 0, and the magnetic field must be along z");
  if (forces.terms.empty()) return;
  if (options.drag != 0.0)
    throw InvalidArgument(
        "simulation: drag is a law of its own, without size and mass: leave drag out, or leave the forces out");
  if (options.integrator == Integrator::rk4)
    throw InvalidArgument(
        "simulation: the integrator rk4 is for particles without mass: leave the forces out, or take the integrator "
        "euler");
  if (options.collisions)
    throw InvalidArgument("simulation: spheres that collide know of drag alone: leave collisions or forces out");
}

std::string wrong_material(const Material& material, const ForceOptions& forces) {
  const auto is_size = [](double x) { return x == 0.0 || (x >= smallest_density && x <= largest_density); };
  if (!is_size(material.diameter))
    return fmt::format("diameter is {}: it must be 0, or between 2^-100 and 2^100", material.diameter);
  if (!is_size(material.density))
    return fmt::format("density is {}: it must be 0, or between 2^-100 and 2^100", material.density);
  if (!std::isfinite(material.charge_per_mass)) return "charge per mass must be finite";
  const bool drags = has_drag(forces);
  if ((drags || has_term(forces, Force::saffman_mei)) && material.diameter == 0.0)
    return "diameter is 0, and the forces need it: give a diameter";
  if ((drags || std::any_of(forces.terms.begin(), forces.terms.end(), needs_fluid_density)) && material.density == 0.0)
    return "density is 0, and the forces need it: give a density";
  return {};
}

ForceStep::ForceStep(const Environment& environment, const MovingVertices& motion, const SimulationOptions& options,
                     const Eddies& eddies, const SampledFields& sampled)
    : environment_(environment),
      motion_(motion),
      options_(options),
      eddies_(eddies),
      sampled_(sampled),
      terms_(terms_of(options)) {}

void ForceStep::check(const Fields& fields) const {
  const auto needs = [&](bool has_it, const char* what, const char* remedy) {
    if (!has_it) throw InvalidArgument(fmt::format("simulation: the force {}: {}", what, remedy));
  };
  if (fields.velocity == nullptr) return;
  const bool at_points = fields.velocity->place() == FieldPlace::points;
  const bool in_space = fields.velocity->frame() == FieldFrame::space;
  needs(at_points || !terms_.pressure_gradient, "pressure-gradient needs the field's gradient", "give it at points");
  needs(at_points || !terms_.virtual_mass, "virtual-mass needs the field's gradient", "give it at points");
  needs(at_points || !terms_.saffman_mei, "saffman-mei needs the field's gradient", "give it at points");
  needs(in_space || !terms_.pressure_gradient, "pressure-gradient needs rates in space", "take the frame of space");
  needs(in_space || !terms_.virtual_mass, "virtual-mass needs rates in space", "take the frame of space");
}

void ForceStep::Sampled::resize(std::size_t size) {
  values.resize(size);
  gradients.resize(size);
  spreads.resize(size);
}

detail::SamplesOfField ForceStep::Sampled::block(std::size_t begin, std::size_t size) {
  const auto part = [&](auto& all) { return all.empty() ? std::span(all) : std::span(all).subspan(begin, size); };
  return {part(values), part(gradients), part(spreads), part(rates), part(mesh)};
}

LawResult ForceStep::result(std::size_t begin, std::size_t size) {
  const auto rotations = rotations_.empty() ? std::span<Vec3>() : std::span(rotations_).subspan(begin, size);
  return {std::span(accelerations_).subspan(begin, size), std::span(rates_).subspan(begin, size), rotations};
}

LawParticles ForceStep::particles(const ParticleSet& set, std::span<const Vec3> velocities, std::size_t begin,
                                  std::size_t size) const {
  const ParticleTable& t = set.table;
  const std::size_t width = options_.user_data.size();
  return {t[t.id].subspan(begin, size),
          positions_.empty() ? std::span<const Vec3>() : std::span(positions_).subspan(begin, size),
          velocities.subspan(begin, size),
          t[t.diameter].subspan(begin, size),
          t[t.density].subspan(begin, size),
          t[t.charge_per_mass].subspan(begin, size),
          t[t.user_data].subspan(begin * width, size * width)};
}

LawSamples ForceStep::samples(std::size_t begin, std::size_t size) const {
  return {std::span(fluid_.values).subspan(begin, size), std::span(fluid_.gradients).subspan(begin, size),
          std::span(fluid_.rates).subspan(begin, size)};
}

void ForceStep::aim(const Segment& segment, ParticleSet& set, std::span<Vec3> targets) {
  const std::size_t n = set.states.size();
  fluid_.resize(n);
  fluid_.rates.resize(n);
  if (motion_.deforms()) fluid_.mesh.resize(n);
  if (segment.fields.force != nullptr) force_.resize(n);
  if (segment.fields.force != nullptr && motion_.deforms()) force_.mesh.resize(n);
  if (law_) positions_.resize(n);
  if (law_ || terms_.lorentz) rotations_.resize(n);
  accelerations_.resize(n);
  rates_.resize(n);
  velocities_.resize(n);
  ways_.resize(n);
  if (eddies_.act()) eddy_velocities_.resize(n);
  const auto blocks = [&](auto&& make) { parallel_for(n, force_grain, environment_.threads(), make); };
  if (!law_) {
    blocks([&](std::size_t begin, std::size_t end) {
      sample_start(segment, set, begin, end);
      predict_middle(segment, set, begin, end);
      finish(segment, set, targets, begin, end);
    });
    return;
  }
  blocks([&](std::size_t begin, std::size_t end) { sample_start(segment, set, begin, end); });
  call_law(set, set.velocities(), segment.begin);
  blocks([&](std::size_t begin, std::size_t end) { predict_middle(segment, set, begin, end); });
  call_law(set, velocities_, segment.begin + 0.5 * segment.duration);
  blocks([&](std::size_t begin, std::size_t end) { finish(segment, set, targets, begin, end); });
}

void ForceStep::sample_start(const Segment& segment, ParticleSet& set, std::size_t begin, std::size_t end) {
  if (segment.fields.velocity != nullptr) sample(segment, *segment.fields.velocity, set, 0, {}, fluid_, begin, end);
  if (eddies_.act()) draw_eddies(segment, set, begin, end);
  if (segment.fields.force != nullptr) sample(segment, *segment.fields.force, set, 0, {}, force_, begin, end);
  if (law_) {
    for (std::size_t i = begin; i < end; ++i) positions_[i] = set.states[i].position;
  }
  apply(segment, set, set.velocities(), begin, end);
}

// An eddy is crossed with Stokes' relaxation time.
void ForceStep::draw_eddies(const Segment& segment, ParticleSet& set, std::size_t begin, std::size_t end) {
  const RandomMoment moment = eddies_.moment(segment.moment);
  const ParticleTable& t = std::as_const(set).table;
  const SampledFields::Component distance = sampled_.component(options_.turbulence.wall_distance);
  for (std::size_t i = begin; i < end; ++i) {
    eddy_velocities_[i] = {};
    if (!takes_part(set.states[i], set.statuses()[i])) continue;
    const double d = t[t.diameter][i];
    Eddies::Crossing crossing;
    if (terms_.drag != detail::ForceTerms::Drag::none)
      crossing = {norm(fluid_.values[i] - set.velocities()[i]),
                  t[t.density][i] * d * d / (18.0 * terms_.fluid.viscosity)};
    eddy_velocities_[i] = eddies_.velocity(set.user_data(i), moment, set.ids()[i], segment.duration, crossing);
    if (distance.field != nullptr)
      eddy_velocities_[i] =
          eddies_.damped(eddy_velocities_[i], set.user_data(i), sampled_.at(distance, set.states[i], segment.moving));
    fluid_.values[i] += eddy_velocities_[i];
  }
}

void ForceStep::predict_middle(const Segment& segment, const ParticleSet& set, std::size_t begin, std::size_t end) {
  move(set, 0.5 * segment.duration, begin, end);
  const Fields& fields = segment.fields;
  if (fields.velocity != nullptr) continue_samples(segment, *fields.velocity, set, fluid_, begin, end);
  if (fields.force != nullptr) continue_samples(segment, *fields.force, set, force_, begin, end);
  if (law_) {
    for (std::size_t i = begin; i < end; ++i) positions_[i] = set.states[i].position + ways_[i];
  }
  apply(segment, set, velocities_, begin, end);
}

// As Aiming::aim_at(): in the mesh's frame a particle goes along with a mesh that does not move in this segment.
void ForceStep::finish(const Segment& segment, ParticleSet& set, std::span<Vec3> targets, std::size_t begin,
                       std::size_t end) {
  move(set, segment.duration, begin, end);
  if (!segment.losses.empty()) note_losses(segment, set, begin, end);
  if (terms_.brownian) add_thermal_motion(segment, set, begin, end);
  const VectorField* field = segment.fields.velocity;
  const bool relative = field != nullptr && field->frame() == FieldFrame::mesh && motion_.deforms() && !segment.moving;
  const std::span<Vec3> velocities = set.velocities();
  const std::span<const ParticleStatus> statuses = set.statuses();
  for (std::size_t i = begin; i < end; ++i) {
    const ParticleState& state = set.states[i];
    if (!takes_part(state, statuses[i])) continue;
    velocities[i] = velocities_[i];
    const Vec3 way = relative ? ways_[i] - fluid_.mesh[i] * segment.duration : ways_[i];
    targets[i] = flushed(state.position + way);
  }
}

// The loss of the motion that is held: its velocity has the mean way / time. Rates are less by the mass of fluid that moves along. A
// rotation does no work.
void ForceStep::note_losses(const Segment& segment, const ParticleSet& set, std::size_t begin, std::size_t end) const {
  const std::span<const double> densities = set.table[set.table.density];
  for (std::size_t i = begin; i < end; ++i) {
    if (!takes_part(set.states[i], set.statuses()[i])) continue;
    const double mass = terms_.virtual_mass ? 1.0 + 0.5 * terms_.fluid.density / densities[i] : 1.0;
    const Vec3& v = velocities_[i];
    const Vec3& before = set.velocities()[i];
    const Vec3 slip = ways_[i] - fluid_.values[i] * segment.duration;
    const double gain = 0.5 * (dot(v, v) - dot(before, before));
    segment.losses[i] = {slip * (mass * rates_[i]), mass * (dot(accelerations_[i], ways_[i]) - gain)};
  }
}

void ForceStep::sample(const Segment& segment, const VectorField& field, const ParticleSet& set, std::size_t moment,
                       std::span<const Vec3> ways, Sampled& to, std::size_t begin, std::size_t end) const {
  if (field.place() == FieldPlace::cells) {
    for (std::size_t i = begin; i < end; ++i) sample_one(segment, field, set.states[i], moment, to, i);
    return;
  }
  const CellComplex& complex = environment_.complex();
  const bool is_fluid = &to == &fluid_;
  detail::FieldAtPoints scene;
  scene.now = complex.positions().data();
  scene.before = motion_.deforms() ? complex.previous_positions().data() : scene.now;
  scene.values = field.values(moment).data();
  scene.earlier = field.values(0).data();
  scene.later = needs_rates() ? field.values(moment + 1).data() : scene.earlier;
  scene.rest = field.rest().empty() ? nullptr : field.rest().data();
  scene.planar = complex.map().dimension() == 2;
  scene.moving = segment.moving;
  scene.carries = is_fluid;
  scene.per_move = 1.0 / options_.dt;
  scene.per_time = (moment == 0 ? 2.0 : 1.0) / segment.duration;
  const std::size_t size = end - begin;
  std::array<std::uint8_t, force_grain / 4> sampled{};
  detail::SamplesOfField samples = to.block(begin, size);
  if (!needs_rates()) samples.rates = {};
  const Particles& particles = set.states;
  detail::sample_field(scene,
                       {particles.states().subspan(begin, size), particles.vertex_numbers().subspan(begin, size), ways},
                       samples, sampled);
  for (std::size_t i = begin; i < end; ++i) {
    if ((sampled[(i - begin) / 4] >> (i - begin) % 4 & 1U) == 0)
      sample_one(segment, field, particles[i], moment, to, i);
  }
}

// In cells and slivers the field has no gradient.
void ForceStep::sample_one(const Segment& segment, const VectorField& field, const ParticleState& state,
                           std::size_t moment, Sampled& to, std::size_t i) const {
  to.gradients[i] = {};
  to.spreads[i] = 0.0;
  to.values[i] = {};
  const bool is_fluid = &to == &fluid_;
  if (is_fluid) to.rates[i] = {};
  if (!to.mesh.empty()) to.mesh[i] = {};
  if (state.held) return;
  const CellComplex& complex = environment_.complex();
  const Corners now = complex.corners(state.at());
  const Corners before = motion_.deforms() ? complex.previous_corners(state.at()) : now;
  const Weights w = detail::barycentric(segment.moving ? before : now, state.position);
  const Vec3 mesh = (detail::combine(now, w) - detail::combine(before, w)) * (1.0 / options_.dt);
  Corners middle = now;  // of the move
  for (std::size_t k = 0; segment.moving && k < middle.size(); ++k) middle[k] = before[k] + (now[k] - before[k]) * 0.5;
  if (!to.mesh.empty()) to.mesh[i] = mesh;
  const auto at = [&](std::size_t m) { return field.at(complex, state.at(), w, middle, m); };
  to.values[i] = at(moment);
  if (!is_fluid) return;
  if (field.frame() == FieldFrame::mesh) {
    to.values[i] += mesh;
  } else if (needs_rates() && !field.steady()) {
    to.rates[i] = (at(moment + 1) - at(0)) * ((moment == 0 ? 2.0 : 1.0) / segment.duration);
  }
}

// From the particles to their predicted places in the middle, as seen from the mesh.
void ForceStep::continue_samples(const Segment& segment, const VectorField& field, const ParticleSet& set,
                                 Sampled& samples, std::size_t begin, std::size_t end) const {
  const std::size_t size = end - begin;
  const bool goes_along = motion_.deforms() && (segment.moving || field.frame() == FieldFrame::mesh);
  std::array<Vec3, force_grain> relative;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t k = begin + i;
    relative[i] = goes_along ? ways_[k] - samples.mesh[k] * (0.5 * segment.duration) : ways_[k];
  }
  const std::span<const Vec3> ways = std::span(relative).first(size);
  if (!field.steady() || (needs_rates() && segment.moving)) {
    sample(segment, field, set, 1, ways, samples, begin, end);
    for (std::size_t i = begin; &samples == &fluid_ && eddies_.act() && i < end; ++i)
      samples.values[i] += eddy_velocities_[i];
  }
  if (field.place() == FieldPlace::points) detail::shift_samples(samples.block(begin, size), ways);
}

void ForceStep::apply(const Segment& segment, const ParticleSet& set, std::span<const Vec3> velocities,
                      std::size_t begin, std::size_t end) {
  const std::size_t size = end - begin;
  detail::apply_forces(terms_, particles(set, velocities, begin, size), samples(begin, size), result(begin, size));
  if (segment.fields.force != nullptr) {
    for (std::size_t i = begin; i < end; ++i) accelerations_[i] += force_.values[i];
  }
  if (law_ && !terms_.lorentz) std::fill_n(rotations_.begin() + static_cast<std::ptrdiff_t>(begin), size, Vec3{});
}

void ForceStep::call_law(const ParticleSet& set, std::span<const Vec3> velocities, double time) {
  const std::size_t n = set.states.size();
  LawParticles all = particles(set, velocities, 0, n);
  all.time = time;
  law_(all, samples(0, n), result(0, n));
  for (std::size_t i = 0; i < n; ++i) {
    const bool usable = is_finite(accelerations_[i]) && is_finite(rotations_[i]) && rates_[i] >= 0.0 &&
                        rates_[i] <= std::numeric_limits<double>::max();
    if (usable || !takes_part(set.states[i], set.statuses()[i])) continue;
    throw InvalidArgument(fmt::format(
        "simulation: the law gives particle {} an acceleration of ({}, {}, {}) and a rate of {}: all values must be "
        "finite, and rates not negative",
        set.ids()[i], accelerations_[i].x, accelerations_[i].y, accelerations_[i].z, rates_[i]));
  }
}

void ForceStep::move(const ParticleSet& set, double duration, std::size_t begin, std::size_t end) {
  const std::size_t size = end - begin;
  detail::move_held({set.velocities().subspan(begin, size), std::span(fluid_.values).subspan(begin, size),
                     result(begin, size), duration, std::span(velocities_).subspan(begin, size),
                     std::span(ways_).subspan(begin, size)});
}

// With the rates of the middle.
void ForceStep::add_thermal_motion(const Segment& segment, const ParticleSet& set, std::size_t begin, std::size_t end) {
  const std::size_t size = end - begin;
  const ParticleTable& t = set.table;
  detail::add_thermal_motion({{options_.seed, RandomPurpose::brownian, segment.moment},
                              environment_.map().dimension() == 2,
                              segment.duration,
                              boltzmann_constant * terms_.fluid.temperature,
                              terms_.virtual_mass ? 0.5 * terms_.fluid.density : 0.0,
                              t[t.id].subspan(begin, size),
                              t[t.diameter].subspan(begin, size),
                              t[t.density].subspan(begin, size),
                              std::span(rates_).subspan(begin, size),
                              std::span(velocities_).subspan(begin, size),
                              std::span(ways_).subspan(begin, size)});
}

}  // namespace dartcast
