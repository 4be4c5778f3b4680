// One rank's part of a scene that ranks share by cells. Not installed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/deformation.hpp"
#include "dartcast/ranks.hpp"
#include "dartcast/scene.hpp"
#include "parts/part_of_rank.hpp"

namespace dartcast {

/// Throws InvalidArgument, which names it, if a scene has something that needs the whole environment on one rank.
void check_can_be_spread(const Scene& scene);

/// The rank's part of the scene's mesh, which may be given as such. Throws as partition(), and InvalidArgument if the part
/// is of another rank.
MeshPart scene_part(const EnvironmentScene& scene, const Ranks& ranks);

/// Steps for the points of a part, of those for the whole mesh.
std::vector<DeformationStep> steps_of_part(std::vector<DeformationStep> steps, std::span<const std::uint32_t> points);

}  // namespace dartcast
