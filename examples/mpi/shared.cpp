// A box that processes share by cells: mpirun -n 4 example_shared. Each makes its part, and has the particles in it.
#include <cstdio>

#include "dartcast/dartcast.hpp"
#include "dartcast/mpi_ranks.hpp"

int main() {
  const dartcast::MpiSession session;
  const auto ranks = dartcast::mpi_ranks();
  const dartcast::BoxOptions box{.cells = {40, 40, 40}};
  dartcast::SharedEnvironment environment(dartcast::box_part(box, ranks->size(), ranks->rank()), *ranks);
  dartcast::SharedParticles particles;
  std::vector<dartcast::Vec3> starts;
  for (int i = 0; i < 1000; ++i) starts.push_back({0.04 * i, 20.0, 20.0});
  environment.add(particles, starts);
  std::uint64_t left = 0;
  for (int step = 0; step < 100; ++step) {
    std::vector<dartcast::Vec3> targets;
    for (const auto& p : particles.particles().states()) targets.push_back(p.position + dartcast::Vec3{0.1, 0.05, 0.0});
    left += environment.advance(particles, targets).left;
  }
  std::uint64_t sums[] = {left};
  ranks->sum(sums);
  const std::uint64_t count = environment.count(particles);
  const std::uint64_t failed = environment.audit(particles).failed;
  if (ranks->rank() == 0)
    std::printf("%u ranks: %lu particles, %lu went to another rank, %lu are not where they should be\n", ranks->size(),
                count, sums[0], failed);
}
