// Inlets: where particles come into a simulation, step by step. Not installed.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <variant>
#include <vector>

#include "dartcast/scene.hpp"
#include "simulation/aiming.hpp"
#include "simulation/moving_vertices.hpp"
#include "simulation/particle_set.hpp"
#include "simulation/rate_integral.hpp"
#include "simulation/seeding.hpp"
#include "simulation/size_sampler.hpp"

namespace dartcast {

/// A direction of equal likelihood by solid angle between a cone's two cones; in the plane by angle.
Vec3 direction_in(const InletCone& cone, unsigned dimension, KeyedRandom& random);

/// Particles that enter in one step.
struct Injection {
  std::variant<const PatchSampler*, const PointSampler*> sampler;
  std::uint64_t count = 0;
  NewParticle particle;
  const InletCone* cone = nullptr;  ///< that gives each its velocity
  bool with_field = false;          ///< or the field does
};

class Inlets {
 public:
  /// All outlive it.
  Inlets(Environment& environment, Followers& followers, const MovingVertices& motion, Aiming& aiming,
         const SimulationOptions& options)
      : environment_(environment), motion_(motion), aiming_(aiming), options_(options) {
    followers.add([this](const ComplexEditReport& edit, OrphanPolicy /*orphaned*/) {
      for (Inlet& inlet : inlets_) {
        if (inlet.sampler) inlet.sampler->update_after_edit(environment_.complex(), edit);
      }
    });
  }

  /// `patch`: none: the cone's point. Throws as Simulation::add_inlet(), and InvalidArgument if a member of the scene is out of range, or it needs a field
  /// and there is none.
  void add(const ParticlesScene& group, const InletParticles& inlet, std::optional<Patch> patch,
           const std::optional<SampledPart>& part);
  /// Calls `add` for each inlet that injects in the next step.
  void inject(const std::optional<SampledPart>& part, const std::function<void(const Injection&)>& add);
  /// The environment is now this part, at rest.
  void change_part(const std::optional<SampledPart>& part);

 private:
  struct Inlet {
    InletParticles scene;
    Patch patch;
    std::optional<PatchSampler> sampler;  // none: a cone's point; empty while it is closed
    RateIntegral waveform;
    Vec3 velocity;
    double radius;
    std::vector<double> user_data;
    Material material;
    std::optional<SizeSampler> sizes;
    bool interception;
    bool with_field;
  };

  [[nodiscard]] std::uint64_t count_up_to(const Inlet& inlet, std::uint64_t steps) const;
  void inject_at_patch(Inlet& inlet, Injection injection, const std::function<void(const Injection&)>& add);

  Environment& environment_;
  const MovingVertices& motion_;
  Aiming& aiming_;
  const SimulationOptions& options_;
  std::vector<Inlet> inlets_;
};

}  // namespace dartcast
