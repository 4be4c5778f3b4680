// Equal work for ranks that share a simulation by cells. Not installed.
#pragma once

#include <cstdint>
#include <span>

#include "dartcast/mesh_data.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"

namespace dartcast {

/// Sets all that belongs to the points of a scene's mesh: fields, forces and the deformation. `points`: of the rank's part in
/// the whole; empty: the mesh is the whole.
void furnish(Simulation::Parts& parts, const Scene& scene, const MeshData& mesh, std::span<const std::uint32_t> points);

/// Moves cells, and the particles in them, between the ranks where one has far more work than the mean: 1.2 times, where a
/// particle counts as many cells. Nothing happens where that would help little. Every result of the simulation stays the
/// same to the bit. Precondition: parts.part, and the scene is parts.spread_scene. Collective.
void balance(Simulation::Parts& parts);

}  // namespace dartcast
