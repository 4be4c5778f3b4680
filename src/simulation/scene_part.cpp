// Cuts a rank's part out of a scene.
#include "simulation/scene_part.hpp"

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/mesh_check.hpp"

namespace dartcast {

namespace {

void refuse_if(bool has, std::string_view what) {
  if (has)
    throw InvalidArgument(fmt::format(
        "partition: a scene with {} cannot be spread by cells: leave --partition cells out, and the ranks share "
        "its particles",
        what));
}

template <class T>
void select(std::vector<T>& values, std::span<const std::uint32_t> which) {
  if (values.empty()) return;
  std::vector<T> some;
  some.reserve(which.size());
  for (const std::uint32_t i : which) some.push_back(values[i]);
  values = std::move(some);
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
  refuse_if(static_cast<bool>(scene.motion.field.samples.read) || static_cast<bool>(scene.motion.force.samples.read),
            "a field from files");
  for (const ParticlesScene& p : scene.particles) {
    refuse_if(p.radius > 0.0, "spheres");
    const auto* placed = std::get_if<PlacedParticles>(&p.source);
    const auto* seeds = placed != nullptr ? std::get_if<ParticleSeeds>(&placed->positions) : nullptr;
    for (std::size_t i = 0; seeds != nullptr && i < seeds->radii.size(); ++i)
      refuse_if(seeds->radii[i] > 0.0, "spheres");
  }
}

MeshPart scene_part(const MeshData& mesh, const Ranks& ranks) {
  MeshData whole = mesh;
  check_and_repair(whole);                // a part of it must not be repaired in another way
  constexpr double blocked_weight = 0.1;  // they take memory, and no time
  std::vector<double> weights;
  for (const std::uint8_t free : whole.free) weights.push_back(free != 0 ? 1.0 : blocked_weight);
  return mesh_part(whole, bisected(whole, ranks.size(), weights), ranks.rank());
}

std::vector<DeformationStep> steps_of_part(std::vector<DeformationStep> steps, std::span<const std::uint32_t> points) {
  const std::vector<std::uint32_t> which(points.begin(), points.end());
  for (DeformationStep& s : steps) {
    for (std::vector<Vec3>& frame : s.frames) select(frame, which);
    if (!s.reader) continue;
    s.reader = [read = std::move(s.reader), which](std::size_t frame) {
      std::vector<Vec3> positions = read(frame);
      if (!positions.empty() && positions.size() <= which.back())
        throw InvalidMesh(fmt::format("frame {} has {} points: the mesh has more", frame, positions.size()));
      select(positions, which);
      return positions;
    };
  }
  return steps;
}

}  // namespace dartcast
