// Makes a simulation from a scene: looks up what it names, then builds from that alone.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/error.hpp"
#include "simulation/balance.hpp"
#include "simulation/resolved_scene.hpp"
#include "simulation/simulation_parts.hpp"
#include "simulation/size_sampler.hpp"

namespace dartcast {

namespace {

void check_place(const ParticleSeeds& seeds, std::size_t i, Place place) {
  if (place == Place::free) return;
  throw Error(fmt::format("{}: position {} (counted from 0) is {}; move or remove it", seeds.name, i,
                          place == Place::blocked ? "in a blocked cell" : "outside the mesh"));
}

void add_placed(Simulation& simulation, const ParticlesScene& group, const PlacedParticles& placed) {
  const auto* seeds = std::get_if<ParticleSeeds>(&placed.positions);
  if (seeds == nullptr)
    throw InvalidArgument("the particles' positions have not been read; call load_scene_files() first");
  std::vector<Vec3> velocities = seeds->velocities;
  std::vector<double> radii = seeds->radii;
  if (velocities.empty()) velocities.assign(seeds->points.size(), group.velocity);
  if (radii.empty()) radii.assign(seeds->points.size(), group.radius);
  std::vector<Material> materials(seeds->points.size(), group.material);
  for (std::size_t i = 0; i < materials.size(); ++i) {
    if (!seeds->diameters.empty()) materials[i].diameter = seeds->diameters[i];
    if (!seeds->densities.empty()) materials[i].density = seeds->densities[i];
    if (!seeds->charges_per_mass.empty()) materials[i].charge_per_mass = seeds->charges_per_mass[i];
    if (group.interception) radii[i] = 0.5 * materials[i].diameter;
  }
  const auto added = simulation.add(seeds->points, velocities, radii, group.user_data, materials);
  for (std::size_t i = 0; i < added.size(); ++i) check_place(*seeds, i, added[i].location.place);
}

// Throws InvalidArgument that names the solid if it meets one that is not there.
void check_names_of_met(std::span<const SolidScene> solids) {
  for (const SolidScene& solid : solids) {
    for (const std::string& met : solid.meets.value_or(std::vector<std::string>{})) {
      if (std::any_of(solids.begin(), solids.end(), [&](const SolidScene& s) { return s.name == met; })) continue;
      throw InvalidArgument(fmt::format(
          "solid \"{}\": no solid has the name \"{}\", which its meets has: give names of the scene's solids",
          solid.name, met));
    }
  }
}

}  // namespace

// All but the particles.
void Simulation::build(ResolvedScene& scene) {
  Environment& environment = *scene.environment;
  parts_ = std::make_unique<Parts>(std::move(scene.environment), environment, scene.options);
  parts_->gathers_contacts = scene.gathers_contacts;
  parts_->set_motion(std::move(scene.motion));
  if (scene.part) parts_->spread(std::move(*scene.part), std::move(scene.motion_of_part));
  set_events(std::move(scene.events));
  set_remeshing(scene.remesh);
  set_adaptive_subdivision(scene.adaptive_subdivision);
  set_statistics(scene.statistics);
  for (const BodyScene& body : scene.bodies) add(body);
  for (const CatheterScene& catheter : scene.catheters) add(catheter);
  check_names_of_met(scene.solids);
  for (const SolidScene& solid : scene.solids) add(solid);
  for (const ParticlesScene& group : scene.particles) {
    if (const auto* inlet = std::get_if<InletParticles>(&group.source))
      parts_->add_inlet(parts_->completed(group), *inlet);
  }
}

void Simulation::add(const ParticlesScene& group) {
  const ParticlesScene whole = parts_->completed(group);
  ParticleSystem& particles = parts_->particles;
  if (const auto* inlet = std::get_if<InletParticles>(&whole.source)) {
    parts_->add_inlet(whole, *inlet);
    parts_->motion_of_part = {};
    return;
  }
  if (whole.with_field) particles.aiming().check_field("particles with the field's velocity");
  const std::size_t first = particles.set().states.size();
  if (const auto* placed = std::get_if<PlacedParticles>(&whole.source)) {
    if (whole.sizes)
      throw InvalidArgument("simulation: sizes are drawn for random particles and inlets: give each seed its diameter");
    add_placed(*this, whole, *placed);
  } else {
    std::optional<SizeSampler> sizes;
    if (whole.sizes) sizes.emplace(*whole.sizes, options().seed);
    particles.add_random(
        std::get<RandomParticles>(whole.source).count,
        {whole.velocity, whole.radius, whole.user_data, whole.material, sizes ? &*sizes : nullptr, whole.interception});
  }
  if (whole.with_field) particles.aiming().start_with_field(particles.set(), first, time());
}

Simulation::Simulation(const Scene& scene, Threads threads, Ranks* ranks, Partition partition) {
  ResolvedScene resolved = resolve(scene, threads, ranks, partition);
  build(resolved);
  for (const ParticlesScene& group : resolved.particles) {
    if (!std::holds_alternative<InletParticles>(group.source)) add(group);
  }
  parts_->particles.take_samples();
}

Simulation::Simulation(const Scene& scene, const SimulationCheckpoint& saved, Threads threads, AfterEdit after_edit,
                       Ranks* ranks, Partition partition) {
  ResolvedScene resolved = resolve(scene, threads, ranks, partition);
  build(resolved);
  set_after_edit(std::move(after_edit));
  restore(saved);
}

}  // namespace dartcast
