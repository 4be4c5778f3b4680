// State hashes of runs that need no files, one a line: the same on every processor (./dev arm64 compares).
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/deformation.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/scene.hpp"
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

// Drops of many sizes that swirl in a shaken box: all laws that need elementary functions, one set of them a scene.
Scene drops() {
  MeshData mesh = mixed_box();
  DataArray u{"u", 3, {}};
  DataArray k{"k", 1, {}};
  for (const Vec3& p : mesh.points) {
    for (const double v : {p.y - 2.5, 2.5 - p.x, 0.3 * p.z}) u.values.push_back(v);
    k.values.push_back(0.3 - 0.05 * p.x);
  }
  mesh.point_data = {u, k, {"omega", 1, std::vector<double>(mesh.points.size(), 40.0)}};
  Scene scene;
  scene.environment.mesh = std::move(mesh);
  scene.motion.dt = 0.01;
  scene.motion.gravity = {0.0, 0.0, -9.81};
  scene.motion.field.array = "u";
  scene.motion.sample = {"k", "omega"};
  scene.particles.resize(1);
  scene.particles[0].source = RandomParticles{200};
  scene.contact.general = Reflect{0.9, 0.1};
  return scene;
}

Scene with_forces() {
  Scene scene = drops();
  scene.particles[0].material.density = 1000.0;
  scene.particles[0].sizes = {.law = SizeLaw::rosin_rammler, .size = 2e-5, .spread = 2.5, .min = 1e-6, .max = 1e-4};
  scene.motion.forces.terms = {Force::schiller_naumann, Force::buoyancy, Force::pressure_gradient, Force::virtual_mass,
                               Force::saffman_mei,      Force::lorentz,  Force::brownian};
  scene.motion.forces.fluid = {.density = 1.2, .viscosity = 1.8e-5, .mean_free_path = 6.8e-8, .temperature = 293.0};
  scene.motion.forces.magnetic_field = {0.0, 0.0, 1.0};
  return scene;
}

Scene in_turbulence() {
  Scene scene = drops();
  scene.motion.drag = 20.0;
  scene.motion.turbulence = {.k = "k", .epsilon = {}, .omega = "omega", .lagrangian = 0.15};
  return scene;
}

Scene diffusing() {
  Scene scene = drops();
  scene.motion.gravity = {};
  scene.motion.diffusivity = "k";
  scene.motion.brownian_bridge = true;
  scene.contact.general = Stick{};
  return scene;
}

Scene by_runge_kutta() {
  Scene scene = drops();
  scene.motion.gravity = {};
  scene.motion.integrator = Integrator::rk4;
  return scene;
}

void run(const char* name, const Scene& scene) {
  Simulation simulation(scene);
  for (int step = 0; step < 50; ++step) simulation.step();
  std::printf("%-16s %s\n", name, simulation.state_hash().hex().c_str());
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
  run("forces", with_forces());
  run("turbulence", in_turbulence());
  run("diffusion", diffusing());
  run("rk4", by_runge_kutta());
}
