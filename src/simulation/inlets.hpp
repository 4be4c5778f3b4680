// Inlets: where particles come into a simulation, step by step. Not installed.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "dartcast/simulation.hpp"
#include "simulation/moving_vertices.hpp"
#include "simulation/particle_set.hpp"
#include "simulation/seeding.hpp"

namespace dartcast {

class Inlets {
 public:
  /// All outlive it.
  Inlets(const Environment& environment, Followers& followers, const MovingVertices& motion,
         const SimulationOptions& options)
      : environment_(environment), motion_(motion), options_(options) {
    followers.add([this](const ComplexEditReport& edit, OrphanPolicy /*orphaned*/) {
      for (Inlet& inlet : inlets_) inlet.sampler.update_after_edit(environment_.complex(), edit);
    });
  }

  /// Throws as Simulation::add_inlet().
  void add(Patch patch, double rate, const NewParticle& particle, const std::optional<SampledPart>& part);
  /// Adds so many particles at random places of the sampler.
  using Add = std::function<void(const PatchSampler& sampler, std::uint64_t count, const NewParticle& particle)>;
  /// Calls `add` for each inlet that injects in the next step.
  void inject(const Add& add);
  /// The environment is now this part, at rest.
  void change_part(const std::optional<SampledPart>& part);

 private:
  struct Inlet {
    Patch patch;
    PatchSampler sampler;  // empty while it is closed
    double rate;
    Vec3 velocity;
    double radius;
    std::vector<double> user_data;
  };

  const Environment& environment_;
  const MovingVertices& motion_;
  const SimulationOptions& options_;
  std::vector<Inlet> inlets_;
};

}  // namespace dartcast
