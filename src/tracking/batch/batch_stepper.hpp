// Advances many particles: in chunks over threads, the usual steps in vectors, the others one by one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/contact.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/step.hpp"
#include "dartcast/threads.hpp"
#include "tracking/batch/batch.hpp"
#include "tracking/batch/particle_cache.hpp"
#include "tracking/step.hpp"

namespace dartcast::detail {

/// A set of particles: one entry per particle in each.
struct BatchParticles {
  std::span<ParticleState> states;
  std::span<Weights> weights;
  ParticleCache& cache;
};

/// Carries any number of particles through one step of a complex, with the results that Stepper (tracking/step.hpp)
/// gives one by one, to the same bits.
class BatchStepper {
 public:
  /// `moved`: as for Stepper. `may_throw`: whether `respond` may. The references must outlive the stepper.
  BatchStepper(const CellComplex& complex, bool moved, Threads threads, const StepOptions& options,
               const ContactCallback& respond, bool may_throw)
      : complex_(complex),
        moved_(moved),
        threads_(threads),
        options_(options),
        may_throw_(may_throw),
        stepper_(complex, moved, options, respond) {}

  /// Advances each particle to its target. Throws InvalidArgument where the numbers differ, or a target is not finite,
  /// out of the exact range or not in the plane; throws what a response throws. Nothing is changed then. Cost: some
  /// 20 ns a particle, and 1 us for each that meets a wall.
  StepReport advance(const BatchParticles& particles, std::span<const Vec3> targets) const;

 private:
  [[nodiscard]] std::vector<Vec3> decided_targets(std::span<const Vec3> targets) const;
  [[nodiscard]] CacheKind cache_kind(const ParticleCache& cache) const;
  [[nodiscard]] StepReport step_all(const BatchParticles& particles, std::span<const Vec3> targets) const;
  void step_chunk(const BatchScene& scene, const BatchParticles& particles, std::span<const Vec3> targets,
                  std::size_t begin, std::size_t end, StepReport& report) const;

  const CellComplex& complex_;
  bool moved_;
  Threads threads_;
  const StepOptions& options_;
  bool may_throw_;
  Stepper stepper_;
};

}  // namespace dartcast::detail
