// Random particles of an environment that no simulation has.
#include "base/keyed_random.hpp"
#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "dartcast/simulation.hpp"
#include "environment/addition.hpp"
#include "simulation/seeding.hpp"

namespace dartcast {

// Points are rounded: one that fell out of its simplex is drawn again, with the next numbers of the same particle.
void add_random(Environment& environment, Particles& particles, std::size_t count, std::uint64_t seed) {
  constexpr int max_tries = 1000;
  check_count(count);
  if (count == 0) return;
  const VolumeSampler sampler(environment.complex(), environment.threads());
  Addition addition(particles);
  for (std::size_t i = 0; i < count; ++i) {
    KeyedRandom random(seed, RandomPurpose::place, particles.size());
    for (int tries = 1;; ++tries) {
      const Sample s = *sampler.sample(environment.complex(), random);
      if (environment.add(particles, s.simplex, flushed(s.position))) break;
      if (tries == max_tries && environment.add_at(particles, s.simplex, s.weights)) break;
    }
  }
  addition.keep();
}

}  // namespace dartcast
