// Spheres that meet each other, and a body without a mesh, in one simulation: grains on a floor, and a barrel that
// falls on them.
#include "dartcast/bodies.hpp"

#include <cstdio>
#include <vector>

#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/simulation.hpp"

int main() {
  using namespace dartcast;
  BoxOptions box;
  box.cells = {8, 8, 8};
  box.size = {1.0, 1.0, 1.0};
  Environment environment(generate_box(box));
  Simulation simulation(environment, {.dt = 1e-3,
                                      .gravity = {0.0, 0.0, -9.81},
                                      .response = Reflect{0.3, 0.4},
                                      .collisions = CollisionOptions{.friction = 0.4}});

  // Grains: particles with a radius. With collisions they meet each other and the barrel.
  std::vector<Vec3> places;
  for (int i = 0; i < 100; ++i) places.push_back({0.05 + 0.1 * (i % 10), 0.05 + 0.1 * (i / 10), 0.3});
  simulation.add(places, {0.0, 0.0, 0.0}, 0.02);

  // A body: particles sampled from a closed surface, held together by shape matching.
  const MeshData surface = generate_barrel({.height = 0.4, .radius = 0.12, .bulge = 0.03, .centre = {0.5, 0.5, 0.6}});
  simulation.add_body(sample_solid(surface, {.spacing = 0.05}).points,
                      {.mass = 20.0, .radius = 0.025, .damping = 20.0});

  for (int step = 0; step < 3000; ++step) simulation.step();
  double fastest = 0.0;
  for (const Vec3& v : simulation.velocities()) fastest = fastest > norm(v) ? fastest : norm(v);
  const Bodies& bodies = *simulation.bodies();
  std::printf("100 grains: the fastest has %.1e m/s; the barrel of %zu particles is at %.2f m\n", fastest,
              bodies.particles().size(), bodies.rigid_motion_of(0).centre.z);
}
