// Editing the scene while particles are in it: tissue is cut open, the channel is tied, and the particles follow.
#include <cstdio>
#include <vector>

#include "dartcast/cutting.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"

int main() {
  using namespace dartcast;
  Environment environment(generate_bar());  // a channel, 1 <= x, y <= 4 and 1 <= z <= 27, in a layer of blocked cells
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{2.5, 2.5, 14.5}, {2.5, 2.5, 20.25}});

  // A layer of tissue 0.25 thick is opened along a disc in the wall below.
  const Disc disc{{2.5, 0.5, 14.5}, {0.0, 0.0, 1.0}, 1.0};
  const std::vector<Cell> near = cells_near(environment.complex(), thicken(disc, 0.25));
  environment.edit([&](ComplexEdit& edit) { cut(edit, near, disc, 0.25); });
  environment.update_after_edit(particles);

  // Down into the gap, through what was a wall at y = 1.
  environment.advance(particles, std::vector<Vec3>{{2.5, 0.25, 14.5}, {2.5, 2.5, 20.25}});
  std::printf("particle 0 is at y = %.2f, in the cut\n", particles[0].position.y);

  // The channel is tied where particle 1 is: it has to make room.
  const Plane plane = plane_through({2.5, 2.5, 20.5}, {0.0, 0.0, 1.0});
  environment.edit([&](ComplexEdit& edit) { ligature(edit, plane, {2.5, 2.5, 20.5}); });
  const UpdateReport followed = environment.update_after_edit(particles, OrphanPolicy::relocate);
  for (const OrphanedParticle& p : followed.orphaned)
    std::printf("particle %u moved by %.2f to z = %.2f\n", p.particle, p.distance, particles[p.particle].position.z);
}
