// Looks up in a mesh what a scene names: arrays, patches and regions.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <variant>

#include "base/are_several.hpp"
#include "dartcast/error.hpp"
#include "dartcast/mesh_selection.hpp"
#include "simulation/eddies.hpp"
#include "simulation/mesh_arrays.hpp"
#include "simulation/parcels.hpp"
#include "simulation/periodic_images.hpp"
#include "simulation/resolved_scene.hpp"
#include "simulation/scene_environment.hpp"

namespace dartcast {

namespace {

SimulationOptions options_of(const Scene& scene, Ranks* ranks) {
  SimulationOptions options;
  options.dt = scene.motion.dt;
  options.gravity = scene.motion.gravity;
  options.drag = scene.motion.drag;
  options.forces = scene.motion.forces;
  options.diffusion = scene.motion.diffusion;
  options.diffusivity = scene.motion.diffusivity;
  options.brownian_bridge = scene.motion.brownian_bridge;
  options.turbulence = scene.motion.turbulence;
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

template <class T>
void select(std::vector<T>& values, std::span<const std::uint32_t> which) {
  if (values.empty()) return;
  std::vector<T> some;
  some.reserve(which.size());
  for (const std::uint32_t i : which) some.push_back(values[i]);
  values = std::move(some);
}

// Samples for a part, of those for the whole mesh. Each rank reads these.
FieldSamples of_part(FieldSamples samples, const MeshPart* part) {
  if (part == nullptr) return samples;
  samples.read = [read = std::move(samples.read), name = samples.name,
                  which = samples.place == FieldPlace::points ? part->points : part->cells](std::size_t k) {
    std::vector<Vec3> values = read(k);
    if (values.size() <= which.back())
      throw InvalidMesh(fmt::format("{} has {} values at its time {}: the mesh has more", name, values.size(), k));
    select(values, which);
    return values;
  };
  return samples;
}

std::optional<VectorField> field_of(const FieldScene& scene, const std::string& name, const MeshData& mesh,
                                    const CellComplex& complex, const MeshPart* part) {
  if (!scene.given()) return {};
  if (!scene.samples.read && !scene.files.empty())
    throw InvalidArgument(name + "'s files have not been read; call load_scene_files() first");
  FieldSamples samples = scene.samples.read ? of_part(scene.samples, part) : field_samples_of(scene, mesh);
  samples.name = name;
  return VectorField(complex, std::move(samples), scene.frame);
}

void add_integral(std::vector<SampledField>& sampled, const std::string& name, const std::string& component) {
  std::string known;
  for (SampledField& f : sampled) {
    const auto found = std::find(f.names.begin(), f.names.end(), component);
    if (found != f.names.end()) {
      f.integrals.push_back({name, static_cast<std::size_t>(found - f.names.begin())});
      return;
    }
    known += fmt::format("{}{}", known.empty() ? "" : ", ", fmt::join(f.names, ", "));
  }
  throw InvalidArgument(fmt::format("the integral {} is of {}, which is not sampled; sampled are: {}", name, component,
                                    known.empty() ? "none" : known));
}

std::vector<SampledField> sampled_of(const MotionScene& scene, const MeshData& mesh, const CellComplex& complex,
                                     const MeshPart* part) {
  if (!scene.sample.empty() && !scene.field.files.empty())
    throw InvalidArgument("the sampled arrays' files have not been read; call load_scene_files() first");
  std::vector<ArraySamples> arrays = scene.sampled;
  for (ArraySamples& array : arrays) {
    for (FieldSamples& samples : array.parts) samples = of_part(std::move(samples), part);
  }
  for (const std::string& name : scene.sample) arrays.push_back(array_samples_of(mesh, name, scene.field.at));
  std::vector<SampledField> sampled;
  for (ArraySamples& array : arrays) {
    for (std::size_t third = 0; third < array.parts.size(); ++third) {
      std::vector<std::string> names;
      for (std::size_t k = 3 * third; k < std::min(3 * third + 3, array.components); ++k)
        names.push_back(component_name(array.name, array.components, k));
      sampled.push_back({VectorField(complex, std::move(array.parts[third])), std::move(names)});
    }
  }
  for (const auto& [name, component] : scene.integrate) add_integral(sampled, name, component);
  return sampled;
}

std::vector<DeformationStep> steps_of(const std::vector<DeformationScene>& scene, const MeshData& mesh) {
  std::vector<DeformationStep> steps;
  for (const DeformationScene& s : scene) {
    if (!s.frames.empty())
      throw InvalidArgument("the deformation's frames have not been read; call load_scene_files() first");
    DeformationStep& step = steps.emplace_back(s.step);
    if (!s.field.empty()) step.field = field_values(mesh, s.field, FieldPlace::points);
    if (!s.path.empty()) step.path = point_values(mesh, s.path, 1);
  }
  return steps;
}

// Steps for the points of a part, of those for the whole mesh.
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

// `part`: the mesh is that of this part; null: the whole.
ResolvedMotion motion_of(const Scene& scene, const MeshData& mesh, const CellComplex& complex, const MeshPart* part) {
  ResolvedMotion motion;
  motion.field = field_of(scene.motion.field, "the velocity field", mesh, complex, part);
  motion.force = field_of(scene.motion.force, "the force", mesh, complex, part);
  motion.sampled = sampled_of(scene.motion, mesh, complex, part);
  if (scene.deformation.empty()) return motion;
  std::vector<DeformationStep> steps = steps_of(scene.deformation, mesh);
  if (part != nullptr) steps = steps_of_part(std::move(steps), part->points);
  motion.deformation.emplace(std::move(steps), mesh.points);
  return motion;
}

std::vector<Event> events_of(const Scene& scene, const MeshData& mesh, const CombinatorialMap& map) {
  std::vector<Event> events;
  for (const EventScene& e : scene.events) {
    events.push_back(e.event);
    std::visit(
        [&]<class What>(What& what) {
          if constexpr (requires { what.cells; }) {
            if (!e.region.empty()) what.cells = cells_of_region(mesh, e.region);
          } else if constexpr (requires { what.patch; }) {
            if (!e.patch.empty()) what.patch = map.patch(e.patch);
          } else if constexpr (requires { what.options.side; }) {
            if (!e.patch.empty()) what.options.side = map.patch(e.patch);
          }
        },
        events.back().what);
  }
  return events;
}

// The mesh of a scene that has been loaded is taken as it is.
bool is_ready(const EnvironmentScene& scene) {
  return std::holds_alternative<MeshData>(scene.mesh) && scene.scale == 1.0 && !scene.skip_bad_cells &&
         scene.walls.empty() && scene.periodic.empty() && std::holds_alternative<std::monostate>(scene.free) &&
         std::holds_alternative<std::monostate>(scene.patches);
}

// For statistics by group: user data that say of which one a particle is.
void number_groups(const Scene& scene, ResolvedScene& resolved) {
  std::vector<double>& bounds = resolved.statistics.class_bounds;
  const bool all = bounds.empty();
  if (std::find(scene.user_data.begin(), scene.user_data.end(), group_number) == scene.user_data.end())
    resolved.options.user_data.emplace_back(group_number);
  for (std::size_t i = 1; i < resolved.particles.size(); ++i) {
    resolved.particles[i].group = i;
    if (all) bounds.push_back(static_cast<double>(i));
  }
}

void resolve_on(const MeshData& mesh, const Scene& scene, Threads threads, ResolvedScene& resolved) {
  resolved.environment = std::make_unique<Environment>(mesh, threads);
  const CellComplex& complex = resolved.environment->complex();
  resolved.motion = motion_of(scene, mesh, complex, resolved.part ? &*resolved.part : nullptr);
  for (const SampledField& f : resolved.motion.sampled)
    resolved.options.user_data.insert(resolved.options.user_data.end(), f.names.begin(), f.names.end());
  if (!scene.motion.turbulence.k.empty())
    resolved.options.user_data.insert(resolved.options.user_data.end(), eddy_numbers.begin(), eddy_numbers.end());
  for (std::string& name : image_numbers(complex)) resolved.options.user_data.push_back(std::move(name));
  for (const auto& [name, component] : scene.motion.integrate) resolved.options.user_data.push_back(name);
  const std::vector<std::string>& names = scene.user_data;
  if (std::find(names.begin(), names.end(), parcel_number) == names.end() &&
      std::any_of(scene.particles.begin(), scene.particles.end(), [](const auto& group) { return group.number != 1; }))
    resolved.options.user_data.emplace_back(parcel_number);
  if (scene.statistics.options.classes_of == group_number) number_groups(scene, resolved);
  resolved.events = events_of(scene, mesh, complex.map());
}

// Without the mesh of the scene, which is the part from now on.
auto motion_in_parts(const Scene& scene) {
  auto rest = std::make_shared<Scene>(scene);
  rest->environment = {};
  return
      [rest](const MeshPart& part, const CellComplex& complex) { return motion_of(*rest, part.mesh, complex, &part); };
}

}  // namespace

ResolvedScene resolve(const Scene& scene, Threads threads, Ranks* ranks, Partition partition) {
  ResolvedScene resolved;
  resolved.options = options_of(scene, ranks);
  resolved.remesh = scene.remesh;
  resolved.adaptive_subdivision = scene.adaptive_subdivision;
  resolved.statistics = scene.statistics.options;
  resolved.particles = scene.particles;
  resolved.bodies = scene.bodies;
  resolved.catheters = scene.catheters;
  resolved.solids = scene.solids;
  const bool reported =
      partition == Partition::particles && scene.output.report && scene.output.every != std::uint64_t{0};
  resolved.gathers_contacts = scene.output.contacts || reported || scene.statistics.options.any();
  if (partition == Partition::cells && are_several(ranks)) {
    check_can_be_spread(scene);
    resolved.part = scene_part(scene.environment, *ranks);
    resolved.motion_of_part = motion_in_parts(scene);
    resolve_on(resolved.part->mesh, scene, threads, resolved);
  } else {
    const bool ready = is_ready(scene.environment);
    const MeshData made = ready ? MeshData() : scene_mesh(scene.environment);
    const MeshData& mesh = ready ? std::get<MeshData>(scene.environment.mesh) : made;
    check_patches(scene, mesh);
    resolve_on(mesh, scene, threads, resolved);
  }
  return resolved;
}

}  // namespace dartcast
