// Spheres that meet each other, and a body without a mesh, in one scene: grains on a floor, and a barrel that falls on
// it.
#include "dartcast/bodies.hpp"

#include <cstdio>
#include <vector>

#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/simulation.hpp"

int main() {
  using namespace dartcast;
  const double dt = 1e-3;
  const Vec3 gravity = {0.0, 0.0, -9.81};
  BoxOptions box;
  box.cells = {8, 8, 8};
  box.size = {1.0, 1.0, 1.0};
  Environment environment(generate_box(box));
  const WallResponses walls(WallResponse{WallResponseKind::reflect, 0.3, 0.4});

  // Grains: particles with a radius. With collisions they meet each other.
  Simulation grains(environment, {.dt = dt, .gravity = gravity, .collisions = CollisionOptions{.friction = 0.4}},
                    walls);
  std::vector<Vec3> places;
  for (int i = 0; i < 100; ++i) places.push_back({0.05 + 0.1 * (i % 10), 0.05 + 0.1 * (i / 10), 0.3});
  grains.add(places, {0.0, 0.0, 0.0}, 0.02);

  // A body: particles sampled from a closed surface, held together by shape matching.
  MeshData surface = generate_barrel({.height = 0.4, .radius = 0.12, .bulge = 0.03, .centre = {0.5, 0.5, 0.6}});
  Bodies bodies(environment, {.dt = dt, .gravity = gravity, .drag = 0.5}, walls);
  bodies.add(sample_solid(surface, {.spacing = 0.05}).points, {.mass = 20.0, .damping = 20.0});

  for (int step = 0; step < 3000; ++step) {
    grains.step();
    bodies.step();
  }
  double fastest = 0.0;
  for (const Vec3& v : grains.velocities()) fastest = fastest > norm(v) ? fastest : norm(v);
  std::printf("100 grains: the fastest has %.1e m/s; the barrel of %zu particles is at %.2f m\n", fastest,
              bodies.particles().size(), bodies.rigid_motion_of(0).centre.z);
}
