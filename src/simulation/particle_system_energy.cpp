// The energy of particles.
#include <array>
#include <vector>

#include "base/exact_sum.hpp"
#include "base/parallel.hpp"
#include "base/reduced.hpp"
#include "simulation/particle_system.hpp"

namespace dartcast {

namespace {

constexpr std::size_t energy_grain = 4096;

struct ExactEnergy {
  ExactSum kinetic;
  ExactSum potential;
};

}  // namespace

// Sums are exact: they do not depend on how threads and ranks share the particles.
SimulationEnergy ParticleSystem::energy() const {
  std::vector<ExactEnergy> parts(chunk_count(set_.states.size(), energy_grain));
  parallel_for(set_.states.size(), energy_grain, environment_.threads(), [&](std::size_t begin, std::size_t end) {
    ExactEnergy& part = parts[begin / energy_grain];
    for (std::size_t i = begin; i < end; ++i) {
      const double m = options_.collisions ? contacts_.mass(set_.radii()[i]) : 1.0;
      part.kinetic.add(0.5 * m * dot(set_.velocities()[i], set_.velocities()[i]));
      part.potential.add(-(m * dot(options_.gravity, set_.states[i].position)));
    }
  });
  const auto add = [](ExactEnergy& sum, const ExactEnergy& part) {
    sum.kinetic += part.kinetic;
    sum.potential += part.potential;
  };
  ExactEnergy own;
  for (const ExactEnergy& part : parts) add(own, part);
  std::array<ExactSum::Words, 2> words = {own.kinetic.words(), own.potential.words()};
  for (ExactSum::Words& w : words) sum_over(options_.ranks, w);
  return {ExactSum::of(words[0]).value(), ExactSum::of(words[1]).value()};
}

}  // namespace dartcast
