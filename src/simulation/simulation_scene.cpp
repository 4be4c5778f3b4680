// Makes a simulation from a scene: looks up what it names, then builds from that alone.
#include <fmt/format.h>

#include <utility>

#include "dartcast/error.hpp"
#include "simulation/balance.hpp"
#include "simulation/resolved_scene.hpp"
#include "simulation/simulation_parts.hpp"

namespace dartcast {

namespace {

void check_place(const ParticleSeeds& seeds, std::size_t i, Place place) {
  if (place == Place::free) return;
  throw Error(fmt::format("{}: position {} (counted from 0) is {}; move or remove it", seeds.name, i,
                          place == Place::blocked ? "in a blocked cell" : "outside the mesh"));
}

void add_particles(Simulation& simulation, const ResolvedParticles& particles) {
  const auto& [velocity, radius, user_data] = particles.particle;
  if (particles.seeds == nullptr) return simulation.add_random(particles.random, velocity, radius, user_data);
  const ParticleSeeds& seeds = *particles.seeds;
  std::vector<Vec3> velocities = seeds.velocities;
  std::vector<double> radii = seeds.radii;
  if (velocities.empty()) velocities.assign(seeds.points.size(), velocity);
  if (radii.empty()) radii.assign(seeds.points.size(), radius);
  const auto added = simulation.add(seeds.points, velocities, radii, user_data);
  for (std::size_t i = 0; i < added.size(); ++i) check_place(seeds, i, added[i].location.place);
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
  for (const SolidScene& solid : scene.solids) add(solid);
  for (const ResolvedInlet& inlet : scene.inlets)
    parts_->inlets.add(inlet.patch, inlet.rate, inlet.particle, parts_->particles.sampled_part());
}

Simulation::Simulation(const Scene& scene, Threads threads, Ranks* ranks, Partition partition) {
  ResolvedScene resolved = resolve(scene, threads, ranks, partition);
  build(resolved);
  for (const ResolvedParticles& p : resolved.particles) add_particles(*this, p);
}

Simulation::Simulation(const Scene& scene, const SimulationCheckpoint& saved, Threads threads, AfterEdit after_edit,
                       Ranks* ranks, Partition partition) {
  ResolvedScene resolved = resolve(scene, threads, ranks, partition);
  build(resolved);
  set_after_edit(std::move(after_edit));
  restore(saved);
}

}  // namespace dartcast
