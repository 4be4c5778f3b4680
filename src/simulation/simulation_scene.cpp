// Makes a simulation from a scene.
#include <fmt/format.h>

#include <optional>
#include <utility>
#include <variant>

#include "base/are_several.hpp"
#include "dartcast/error.hpp"
#include "dartcast/mesh_selection.hpp"
#include "dartcast/scene.hpp"
#include "simulation/balance.hpp"
#include "simulation/scene_environment.hpp"
#include "simulation/scene_part.hpp"
#include "simulation/simulation_parts.hpp"

namespace dartcast {

namespace {

SimulationOptions options_of(const Scene& scene, Ranks* ranks) {
  SimulationOptions options;
  options.dt = scene.motion.dt;
  options.gravity = scene.motion.gravity;
  options.drag = scene.motion.drag;
  options.response = scene.contact.general;
  options.patch_responses = scene.contact.by_patch;
  options.substeps = scene.motion.substeps;
  options.integrator = scene.motion.integrator;
  options.wall_motion = scene.motion.wall_motion;
  options.seed = scene.seed;
  options.collisions = scene.collisions;
  options.body_collisions = scene.body_collisions;
  options.user_data = scene.user_data;
  options.ranks = ranks;
  return options;
}

std::vector<Event> events_of(const Scene& scene, const MeshData& mesh, const CombinatorialMap& map) {
  std::vector<Event> events;
  for (const EventScene& e : scene.events) {
    events.push_back(e.event);
    if (!e.region.empty()) {
      auto* open = std::get_if<OpenCells>(&events.back().what);
      auto* close = std::get_if<CloseCells>(&events.back().what);
      if (open != nullptr) open->cells = cells_of_region(mesh, e.region);
      if (close != nullptr) close->cells = cells_of_region(mesh, e.region);
    }
    auto* reconnect = std::get_if<Reconnect>(&events.back().what);
    if (reconnect != nullptr && !e.patch.empty()) reconnect->options.side = map.patch(e.patch);
  }
  return events;
}

// The mesh of a scene that has been loaded is taken as it is.
bool is_ready(const EnvironmentScene& scene) {
  return std::holds_alternative<MeshData>(scene.mesh) && scene.scale == 1.0 && !scene.skip_bad_cells &&
         std::holds_alternative<std::monostate>(scene.free) && std::holds_alternative<std::monostate>(scene.patches);
}

// Adds the particles of one entry of the scene; inlets add theirs step by step.
class ParticleSource {
 public:
  ParticleSource(Simulation& simulation, const ParticlesScene& scene) : simulation_(simulation), scene_(scene) {}

  void operator()(const InletParticles& /*inlet*/) const {}
  void operator()(const RandomParticles& random) const {
    simulation_.add_random(random.count, scene_.velocity, scene_.radius, scene_.user_data);
  }
  void operator()(const PlacedParticles& placed) const {
    const auto* seeds = std::get_if<ParticleSeeds>(&placed.positions);
    if (seeds == nullptr)
      throw InvalidArgument("the particles' positions have not been read; call load_scene_files() first");
    std::vector<Vec3> velocities = seeds->velocities;
    std::vector<double> radii = seeds->radii;
    if (velocities.empty()) velocities.assign(seeds->points.size(), scene_.velocity);
    if (radii.empty()) radii.assign(seeds->points.size(), scene_.radius);
    const auto added = simulation_.add(seeds->points, velocities, radii, scene_.user_data);
    for (std::size_t i = 0; i < added.size(); ++i) check_place(*seeds, i, added[i].location.place);
  }

 private:
  static void check_place(const ParticleSeeds& seeds, std::size_t i, Place place) {
    if (place == Place::free) return;
    throw Error(fmt::format("{}: position {} (counted from 0) is {}; move or remove it", seeds.name, i,
                            place == Place::blocked ? "in a blocked cell" : "outside the mesh"));
  }

  Simulation& simulation_;
  const ParticlesScene& scene_;
};

void add_inlets(Simulation::Parts& parts, const Scene& scene) {
  for (const ParticlesScene& p : scene.particles) {
    if (const auto* inlet = std::get_if<InletParticles>(&p.source))
      parts.inlets.add(parts.environment.map().patch(inlet->patch), inlet->rate, {p.velocity, p.radius, p.user_data},
                       parts.particles.sampled_part());
  }
}

}  // namespace

// All but the particles.
void Simulation::make(const Scene& scene, Threads threads, Ranks* ranks, Partition partition) {
  std::optional<MeshPart> part;
  if (partition == Partition::cells && are_several(ranks)) {
    check_can_be_spread(scene);
    part = scene_part(scene.environment, *ranks);
  }
  MeshData made;
  if (!part && !is_ready(scene.environment)) made = scene_mesh(scene.environment);
  const MeshData& mesh = part                          ? part->mesh
                         : is_ready(scene.environment) ? std::get<MeshData>(scene.environment.mesh)
                                                       : made;
  if (!part) check_patches(scene, mesh);
  auto own = std::make_unique<Environment>(mesh, threads);
  Environment& environment = *own;
  parts_ = std::make_unique<Parts>(std::move(own), environment, options_of(scene, ranks));
  const bool reported = partition == Partition::particles && scene.output.report && scene.output.every > 0;
  parts_->gathers_contacts = scene.output.contacts || reported || scene.statistics.options.any();
  furnish(*parts_, scene, mesh, part ? part->points : std::vector<std::uint32_t>());
  if (part) parts_->spread(std::move(*part), scene);
  set_events(events_of(scene, mesh, environment.map()));
  set_remeshing(scene.remesh);
  set_adaptive_subdivision(scene.adaptive_subdivision);
  set_statistics(scene.statistics.options);
  for (const BodyScene& body : scene.bodies) add(body);
  for (const CatheterScene& catheter : scene.catheters) add(catheter);
  for (const SolidScene& solid : scene.solids) add(solid);
  add_inlets(*parts_, scene);
}

Simulation::Simulation(const Scene& scene, Threads threads, Ranks* ranks, Partition partition) {
  make(scene, threads, ranks, partition);
  for (const ParticlesScene& p : scene.particles) std::visit(ParticleSource(*this, p), p.source);
}

Simulation::Simulation(const Scene& scene, const SimulationCheckpoint& saved, Threads threads, AfterEdit after_edit,
                       Ranks* ranks, Partition partition) {
  make(scene, threads, ranks, partition);
  set_after_edit(std::move(after_edit));
  restore(saved);
}

}  // namespace dartcast
