// A scene whose names have been looked up in its mesh: all that a simulation is made of. Not installed.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "dartcast/deformation.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/events.hpp"
#include "dartcast/mesh_part.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "dartcast/vector_field.hpp"
#include "simulation/sampled_fields.hpp"

namespace dartcast {

/// Fields, forces and deformation: all that belongs to the points and cells of a mesh.
struct ResolvedMotion {
  std::optional<VectorField> field;
  std::optional<VectorField> force;
  std::vector<SampledField> sampled;
  std::optional<Deformation> deformation;
};

/// Spans are into the scene, which outlives it.
struct ResolvedScene {
  std::unique_ptr<Environment> environment;
  std::optional<MeshPart> part;  ///< of which the environment is made; none: it is whole
  SimulationOptions options;
  ResolvedMotion motion;
  std::function<ResolvedMotion(const MeshPart&, const CellComplex&)>
      motion_of_part;  ///< of any part; none: it is whole
  std::vector<Event> events;
  RemeshScene remesh;
  AdaptiveSubdivisionScene adaptive_subdivision;
  StatisticsOptions statistics;
  std::vector<ParticlesScene> particles;
  std::span<const BodyScene> bodies;
  std::span<const CatheterScene> catheters;
  std::span<const SolidScene> solids;
  bool gathers_contacts = false;
};

/// Makes the environment of a scene whose files have been read, and looks up all names in it. Throws InvalidArgument if a
/// file has not been read; InvalidMesh if the mesh has not what a name stands for; and as Environment. Collective if
/// ranks share the scene by cells.
ResolvedScene resolve(const Scene& scene, Threads threads, Ranks* ranks, Partition partition);

}  // namespace dartcast
