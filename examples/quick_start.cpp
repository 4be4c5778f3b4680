// A box of cells, particles in it, one step with contacts, one move of all vertices.
#include <cstdio>
#include <vector>

#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/response.hpp"

int main() {
  using namespace dartcast;
  Environment environment(generate_bar());  // 5 x 5 x 28 unit cubes, the outer layer blocked
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{2.5, 2.5, 14.0}, {1.5, 3.2, 7.0}});

  const double dt = 0.1;
  std::vector<Vec3> velocity = {{30.0, 0.0, 1.0}, {0.0, 0.5, -1.0}};
  std::vector<ParticleStatus> fate(particles.size());
  const WallResponses walls(WallResponse{WallResponseKind::reflect, 0.5, 0.0});
  std::vector<Vec3> target;
  for (std::size_t i = 0; i < particles.size(); ++i) target.push_back(particles[i].position + velocity[i] * dt);
  const StepReport report = environment.advance(particles, target, respond_with(walls, velocity, fate, dt));
  for (const Contact& c : report.contacts.contacts)
    std::printf("particle %u met a wall at t = %.3f, x = %.3f\n", c.particle, c.time_of_impact, c.point.x);

  std::vector<Vec3> moved(environment.positions().begin(), environment.positions().end());
  for (Vec3& p : moved) p.z *= 1.01;
  environment.move(moved);  // no work per cell; the particles follow in the next step
  environment.advance(particles, target, respond_with(walls, velocity, fate, dt));
  std::printf("particle 0 is at %.3f %.3f %.3f\n", particles[0].position.x, particles[0].position.y,
              particles[0].position.z);
}
