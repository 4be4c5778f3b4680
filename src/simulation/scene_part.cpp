// Cuts a rank's part out of a scene.
#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/mesh_check.hpp"
#include "simulation/scene_environment.hpp"

namespace dartcast {

namespace {

void refuse_if(bool has, std::string_view what) {
  if (has)
    throw InvalidArgument(fmt::format(
        "partition: a scene with {} cannot be spread by cells: leave --partition cells out, and the ranks share "
        "its particles",
        what));
}

}  // namespace

void check_can_be_spread(const Scene& scene) {
  refuse_if(scene.collisions.has_value(), "spheres that collide");
  refuse_if(!scene.bodies.empty(), "bodies");
  refuse_if(!scene.catheters.empty(), "catheters");
  refuse_if(!scene.solids.empty(), "solids");
  refuse_if(!scene.events.empty() || scene.remesh.every > 0 || scene.adaptive_subdivision.every > 0, "edits");
  refuse_if(scene.statistics.options.any(), "statistics");
  refuse_if(scene.motion.substeps > 1, "substeps");
  refuse_if(scene.motion.integrator != Integrator::euler, "the integrator rk4");
  refuse_if(scene.motion.wall_motion != WallMotion::carried, "points that move at the same time as the walls");
  for (const FieldScene* field : {&scene.motion.field, &scene.motion.force})
    refuse_if(!field->files.empty() || static_cast<bool>(field->samples.read), "a field from files");
  for (const ParticlesScene& p : scene.particles) {
    refuse_if(p.radius > 0.0, "spheres");
    const auto* placed = std::get_if<PlacedParticles>(&p.source);
    const auto* seeds = placed != nullptr ? std::get_if<ParticleSeeds>(&placed->positions) : nullptr;
    for (std::size_t i = 0; seeds != nullptr && i < seeds->radii.size(); ++i)
      refuse_if(seeds->radii[i] > 0.0, "spheres");
  }
}

MeshPart scene_part(const EnvironmentScene& scene, const Ranks& ranks) {
  if (const auto* part = std::get_if<MeshPart>(&scene.mesh)) {
    if (part->parts != ranks.size() || part->part != ranks.rank())
      throw InvalidArgument(fmt::format("the scene's mesh is part {} of {}, and this is rank {} of {}", part->part,
                                        part->parts, ranks.rank(), ranks.size()));
    return *part;
  }
  MeshData whole = std::holds_alternative<MeshData>(scene.mesh) ? std::get<MeshData>(scene.mesh) : scene_mesh(scene);
  check_and_repair(whole);  // a part of it must not be repaired in another way
  return mesh_part(whole, partition(whole, ranks.size()), ranks.size(), ranks.rank());
}

}  // namespace dartcast
