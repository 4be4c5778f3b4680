// State hashes of runs that need no files, one a line: the same on every processor (./dev arm64 compares).
#include <cstdio>
#include <utility>

#include "dartcast/deformation.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/simulation.hpp"

namespace {

using namespace dartcast;

SimulationOptions falling() {
  SimulationOptions options;
  options.dt = 0.01;
  options.gravity = {0.0, 0.0, -9.81};
  options.response = Reflect{0.9, 0.1};
  return options;
}

void run(const char* name, MeshData mesh, const SimulationOptions& options, std::vector<DeformationStep> motion,
         double radius = 0.0) {
  Environment environment(std::move(mesh));
  Simulation simulation(environment, options);
  if (!motion.empty()) simulation.set_deformation(Deformation(std::move(motion), environment.positions()));
  const bool is_flat = environment.map().dimension() == 2;
  simulation.add_random(200, is_flat ? Vec3{2.0, 3.0, 0.0} : Vec3{2.0, 3.0, 1.0}, radius);
  for (int step = 0; step < 50; ++step) simulation.step();
  std::printf("%-16s %s\n", name, simulation.state_hash().hex().c_str());
}

DeformationStep twist() {
  DeformationStep step;
  step.kind = DeformationKind::twist;
  step.amplitude = 0.4;
  step.period = 0.7;
  step.centre = {2.5, 2.5, 14.0};
  step.length = 28.0;
  return step;
}

MeshData mixed_box() {
  BoxOptions box;
  box.cells = {5, 5, 5};
  box.size = {5.0, 5.0, 5.0};
  box.mixed = true;
  box.jitter = 0.2;
  box.blocked_share = 0.1;
  return generate_box(box);
}

}  // namespace

int main() {
  run("bar", generate_bar(), falling(), {});
  run("bar twisted", generate_bar(), falling(), {twist()});
  run("mixed box", mixed_box(), falling(), {});
  OctahedraOptions octahedra;
  octahedra.cells = {3, 3, 3};
  octahedra.size = {3.0, 3.0, 3.0};
  run("octahedra", generate_octahedra(octahedra), falling(), {});
  SimulationOptions pouring = falling();
  pouring.collisions = CollisionOptions{};
  run("spheres", mixed_box(), pouring, {}, 0.1);
  SimulationOptions in_plane = falling();
  in_plane.gravity = {0.0, -9.81, 0.0};
  run("maze", generate_maze({.size = std::array{1.0, 1.0}}), in_plane, {});
}
