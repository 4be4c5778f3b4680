// The parts of a simulation.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/simulation.hpp"
#include "dartcast/statistics.hpp"
#include "environment/part_environment.hpp"
#include "simulation/bodies_component.hpp"
#include "simulation/catheters_component.hpp"
#include "simulation/event_scheduler.hpp"
#include "simulation/inlets.hpp"
#include "simulation/particle_system.hpp"
#include "simulation/resolved_scene.hpp"
#include "simulation/solids_component.hpp"
#include "simulation/statistics_component.hpp"

namespace dartcast {

struct Simulation::Parts {
  /// `own`: the environment, if the simulation has made it; none if it is another's.
  Parts(std::unique_ptr<Environment> own, Environment& used, const SimulationOptions& options)
      : own_environment(std::move(own)),
        environment(used),
        motion(used, followers, options.dt),
        particles(used, followers, motion, options),
        inlets(used, followers, motion, particles.aiming(), particles.options()),
        solids(used, motion, options.dt),
        bodies(used, particles.options(), particles.responses()),
        catheters(used, options.dt),
        statistics(particles),
        events(used, followers, options.dt) {
    for (SimulationComponent* component : components)
      followers.add([=](auto& edit, OrphanPolicy orphaned) { component->update_after_edit(edit, orphaned); },
                    component == &particles);
    followers.add([this](const ComplexEditReport& /*edit*/, OrphanPolicy /*orphaned*/) {
      if (after_edit) after_edit(environment);
    });
  }

  using MotionOfPart = decltype(ResolvedScene::motion_of_part);

  /// The environment is this part of one.
  void spread(MeshPart mesh, MotionOfPart motion_of) {
    motion_of_part = std::move(motion_of);
    part = std::make_unique<PartEnvironment>(environment, mesh, *particles.options().ranks);
    part_mesh = std::make_unique<MeshPart>(std::move(mesh));
    particles.set_part(*part);
  }

  /// A group with its radius, with one of its diameters, and with zeros for the numbers behind its user's: those sampled, and its eddy.
  [[nodiscard]] ParticlesScene completed(ParticlesScene group) {
    if (group.sizes) group.material.diameter = group.sizes->size;
    if (group.sizes && group.sizes->law == SizeLaw::table && !group.sizes->diameters.empty())
      group.material.diameter = group.sizes->diameters.front();
    if (group.interception) group.radius = 0.5 * group.material.diameter;
    std::vector<double>& data = group.user_data;
    const std::size_t given = data.size();
    const std::vector<std::string>& names = particles.options().user_data;
    const auto set = [&](const char* name, std::uint64_t value, std::uint64_t usual) {
      if (value == usual) return;
      const auto column = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
      if (column == names.size() || column < given)
        throw InvalidArgument(fmt::format(
            "simulation: the {} of a group is a number of user data: name it there, and give its value once", name));
      data.resize(names.size());
      data[column] = static_cast<double>(value);
    };
    if (given > 0) data.resize(names.size());
    set(parcel_number, group.number, 1);
    set(group_number, group.group, 0);
    return group;
  }

  /// Adds the inlet of a completed group. Throws as Inlets::add().
  void add_inlet(const ParticlesScene& group, const InletParticles& inlet) {
    std::optional<Patch> patch;
    if (!inlet.cone) patch = environment.map().patch(inlet.patch);
    inlets.add(group, inlet, patch, particles.sampled_part());
  }

  /// Sets all that belongs to the points of the mesh.
  void set_motion(ResolvedMotion resolved) {
    if (resolved.field) particles.aiming().set_field(std::move(*resolved.field));
    if (resolved.force) particles.aiming().set_force(std::move(*resolved.force));
    particles.sampled().set(std::move(resolved.sampled));
    if (resolved.deformation) motion.set_deformation(std::move(*resolved.deformation));
  }

  std::unique_ptr<Environment> own_environment;
  std::unique_ptr<PartEnvironment> part;  // none: the environment is whole
  std::unique_ptr<MeshPart> part_mesh;
  MotionOfPart motion_of_part;  // as the scene says; none: its user has changed it since
  std::uint64_t balanced = 0;   // how often cells have moved to other ranks
  Environment& environment;
  Followers followers;
  MovingVertices motion;
  ParticleSystem particles;
  Inlets inlets;
  SolidsComponent solids;
  BodiesComponent bodies;
  CathetersComponent catheters;
  StatisticsComponent statistics;
  /// All components, in the order of a step. Particles come first: they move the environment.
  std::vector<SimulationComponent*> components = {&particles, &solids, &bodies, &catheters, &statistics};
  EventScheduler events;
  AfterEdit after_edit;
  bool gathers_contacts = true;  // of all ranks, on the first
  double seconds_solids = 0.0;

  /// From now on walls move together with the solids, bodies and catheters that stop them.
  void move_walls_jointly() {
    motion.set_mover([this](std::span<const Vec3> positions) {
      std::vector<MovePartner*> partners = catheters.partners();
      if (MovePartner* const surfaces = bodies.partner()) partners.push_back(surfaces);
      solids.move_with(motion.time(), positions, std::move(partners));
    });
  }

  /// The clock of a component's steps. Particles have clocks of their own.
  [[nodiscard]] double& clock_of(const SimulationComponent* component) {
    if (component == &particles) return ignored;
    return component == &statistics ? statistics.seconds() : seconds_solids;
  }
  double ignored = 0.0;
};

}  // namespace dartcast
