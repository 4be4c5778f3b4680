// Tracers by Runge-Kutta: its order, its exact error on a circle, stages at walls.
#include "simulation/runge_kutta.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>
#include <optional>
#include <vector>

#include "base/random.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/simulation.hpp"
#include "support/expectations.hpp"
#include "support/meshes.hpp"
#include "support/patchwork.hpp"
#include "support/periodic_meshes.hpp"

namespace dartcast::runge_kutta_test {

using test::expect_near;
using test::expect_parts;

using Field = std::function<Vec3(const Vec3&, double)>;

SimulationOptions options(double dt, Integrator integrator = Integrator::rk4) {
  SimulationOptions o;
  o.dt = dt;
  o.integrator = integrator;
  return o;
}

FieldSamples samples(const MeshData& mesh, const std::vector<double>& times, const Field& f) {
  std::vector<std::vector<Vec3>> values;
  for (const double t : times) {
    values.emplace_back();
    for (const Vec3& p : mesh.points) values.back().push_back(f(p, t));
  }
  return field_samples(times, values);
}

// x' = t - x: x = t - 1 + (x0 + 1) e^-t. (y, z): a circle about (0, 0). The centre of the cube is (0, 0, 0) here.
double error_after_two_seconds(double dt, Integrator integrator) {
  BoxOptions box;
  box.cells = {5, 5, 5};
  box.size = {10, 10, 10};
  box.origin = {-5, -5, -5};
  box.jitter = 0.6;
  const MeshData mesh = generate_box(box);
  Environment environment(mesh);
  Simulation simulation(environment, options(dt, integrator));
  simulation.set_field(VelocityField(environment.complex(), samples(mesh, {0.0, 2.5}, [](const Vec3& p, double t) {
                                       return Vec3{t - p.x, -p.z, p.y};
                                     })));
  simulation.add({{2, 3, 0}}, {});
  const double end = 2.0;
  while (simulation.time() < end - 1e-9) simulation.step();
  const Vec3 exact = {end - 1 + 3 * std::exp(-end), 3 * std::cos(end), 3 * std::sin(end)};
  return norm(simulation.particles()[0].position - exact);
}

TEST(RungeKutta, IsOfOrderFour) {
  double before = error_after_two_seconds(0.25, Integrator::rk4);
  for (const double dt : {0.125, 0.0625, 0.03125}) {
    const double error = error_after_two_seconds(dt, Integrator::rk4);
    EXPECT_NEAR(before / error, 16.0, 1.6) << dt << ": " << error;
    before = error;
  }
  EXPECT_LT(before, 1e-6);
  EXPECT_NEAR(error_after_two_seconds(0.0625, Integrator::euler) / error_after_two_seconds(0.03125, Integrator::euler),
              2.0, 0.2);
}

double radius_after(int steps, double dt, Integrator integrator, bool plane) {
  RectangleOptions rectangle;
  rectangle.cells = {5, 5};
  rectangle.size = {10, 10};
  const MeshData mesh = plane ? generate_rectangle(rectangle) : test::cube_of(5, 10.0);
  Environment environment(mesh);
  SimulationOptions o = options(dt, integrator);
  o.response = Slide{};
  Simulation simulation(environment, o);
  simulation.set_field(VelocityField(environment.complex(), samples(mesh, {0.0}, [](const Vec3& p, double) {
                                       return Vec3{5 - p.y, p.x - 5, 0};
                                     })));
  const double z = plane ? 0.0 : 5.0;
  simulation.add({{7, 5, z}}, {});
  for (int i = 0; i < steps; ++i) simulation.step();
  EXPECT_EQ(simulation.particles()[0].position.z, z);
  return norm(simulation.particles()[0].position - Vec3{5, 5, z});
}

// On a circle a step of RK4 scales the radius by the root of 1 - h^6 / 72 + h^8 / 576, one of Euler by that of 1 + h^2.
TEST(RungeKutta, InARotatingFlowATracerStaysOnItsCircle) {
  const double h = 2 * std::numbers::pi / 64;
  const int steps = 64 * 50;  // turns
  const double factor = 1 - std::pow(h, 6) / 72 + std::pow(h, 8) / 576;
  const double expected = 2 * std::pow(factor, 0.5 * steps);
  EXPECT_LT(2 - expected, 5e-5);
  for (const bool plane : {false, true}) {
    EXPECT_NEAR(radius_after(steps, h, Integrator::rk4, plane), expected, 1e-10);
    EXPECT_GT(radius_after(steps, h, Integrator::euler, plane), 4.9) << "Euler's spiral ends at the wall";
  }
}

// u = (x, 0, 0) at x = 9.5, the wall at 10: k1 = 9.5, and all other stages are past the wall, where u = 10.
TEST(RungeKutta, PastAWallTheFieldAtTheContactCounts) {
  for (const CellType type : {CellType::hexahedron, CellType::tetrahedron}) {
    BoxOptions box;
    box.cells = {4, 4, 4};
    box.size = {10, 10, 10};
    box.type = type;
    const MeshData mesh = generate_box(box);
    Environment environment(mesh);
    VelocityField field(environment.complex(), samples(mesh, {0.0}, [](const Vec3& p, double) {
                          return Vec3{p.x, 0, 0};
                        }));
    Particles particles;
    environment.add(particles, std::vector<Vec3>{{9.5, 3.3, 4.1}, {10, 3.3, 4.1}, {2, 3.3, 4.1}});
    const RungeKuttaStep step = {environment.complex(), field, 1.0, false};
    expect_near(runge_kutta_velocity(step, particles[0]), {(9.5 + 20 + 20 + 10) / 6, 0, 0}, 1e-12);
    expect_near(runge_kutta_velocity(step, particles[1]), {10, 0, 0}, 1e-12);
    expect_near(runge_kutta_velocity(step, particles[2]), {(2 + 2 * 3 + 2 * 3.5 + 5.5) / 6, 0, 0}, 1e-12);
  }
}

// u = (10, y, 0), aslant to the wall: every stage's contact is at a share of 0.5 / (10 dt) of its way.
TEST(RungeKutta, TheContactIsOnTheWayToTheStage) {
  const MeshData mesh = test::cube_of(3, 10.0);
  Environment environment(mesh);
  const VelocityField field(environment.complex(), samples(mesh, {0.0}, [](const Vec3& p, double) {
                              return Vec3{10, p.y, 0};
                            }));
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{9.5, 4, 5}});
  const Vec3 v = runge_kutta_velocity({environment.complex(), field, 1.0, false}, particles[0]);
  expect_near(v, {10, 4 * (1 + 2 * 1.05 + 2 * 1.0525 + 1.052625) / 6, 0}, 1e-12);
}

// The result is the target of an ordinary step: at the wall the particle responds.
TEST(RungeKutta, AtAWallTheParticleResponds) {
  const MeshData mesh = test::cube_of(4, 10.0);
  Environment environment(mesh);
  SimulationOptions o = options(0.5);
  o.response = Absorb{};
  Simulation simulation(environment, o);
  simulation.set_field(VelocityField(environment.complex(), samples(mesh, {0.0}, [](const Vec3& p, double) {
                                       return Vec3{p.x, 0, 0};
                                     })));
  simulation.add({{2, 5, 5}}, {});
  for (int i = 0; i < 10; ++i) simulation.step();
  EXPECT_EQ(simulation.totals().absorbed, 1U);
  EXPECT_EQ(simulation.particles().size(), 0U);
}

Deformation turning(const MeshData& mesh) {
  DeformationStep step;
  step.kind = DeformationKind::rotate;
  step.period = 1.0;
  step.centre = {5, 5, 5};
  return Deformation({step}, mesh.points);
}

// The distance after a quarter of a turn from where a constant flow has gone in the mesh: straight on.
double error_in_turning_mesh(double speed, double dt) {
  const MeshData mesh = test::cube_of(5, 10.0);
  Environment environment(mesh);
  Simulation simulation(environment, options(dt));
  simulation.set_field(
      VelocityField(environment.complex(), std::vector<Vec3>(mesh.points.size(), Vec3{speed, 0, 0}), FieldFrame::mesh));
  simulation.set_deformation(turning(mesh));
  simulation.add({{2, 2, 5}}, {});
  while (simulation.time() < 0.25 - 1e-9) simulation.step();
  return norm(simulation.particles()[0].position - Vec3{5 - (2 - 5), 5 + (2 + 0.25 * speed - 5), 5});
}

// Vertices move on chords in a step, and stages are in the mesh as it is at their time.
TEST(RungeKutta, InTheMeshsFrameTheMeshCarriesAlong) {
  EXPECT_LT(error_in_turning_mesh(0.0, 0.01), 1e-12);
  const double error = error_in_turning_mesh(1.0, 0.01);
  EXPECT_LT(error, 1e-6);
  EXPECT_NEAR(error / error_in_turning_mesh(1.0, 0.005), 16.0, 1.0);
}

// In the space's frame the values belong to the vertices: a uniform flow goes straight through a mesh that moves.
TEST(RungeKutta, InSpaceAUniformFlowGoesStraightThroughAMeshThatTurns) {
  const MeshData mesh = test::cube_of(5, 10.0);
  Environment environment(mesh);
  Simulation simulation(environment, options(0.01));
  simulation.set_field(VelocityField(environment.complex(), std::vector<Vec3>(mesh.points.size(), Vec3{1, 2, 0})));
  simulation.set_deformation(turning(mesh));
  simulation.add({{4, 4, 5}}, {});
  for (int i = 0; i < 50; ++i) simulation.step();
  expect_near(simulation.particles()[0].position, {4.5, 5, 5}, 1e-12);
}

// Particles of one mesh, half of them and of the field's values on a lattice, and what they do in a step.
class Crowd {
 public:
  Crowd(MeshData mesh, FieldPlace place, FieldFrame frame, Random& random)
      : random_(random), planar_(mesh.dimension() == 2), mesh_(std::move(mesh)), environment_(mesh_) {
    const std::size_t values = place == FieldPlace::points ? mesh_.points.size() : mesh_.cell_count();
    std::vector<std::vector<Vec3>> samples(3);
    for (std::vector<Vec3>& sample : samples) {
      for (std::size_t i = 0; i < values; ++i) sample.push_back(vector(-2, 2));
    }
    field_.emplace(environment_.complex(), field_samples({0.0, 0.5, 1.0}, std::move(samples), place), frame);
    std::vector<Vec3> points;
    for (int i = 0; i < 303; ++i) points.push_back(vector(0, 4));
    environment_.add(particles_, points);
  }

  // `shift`: of vertices, at most; the largest ones invert cells.
  void expect_same_bits(double dt, double shift) {
    if (shift > 0.0) {
      std::vector<Vec3> moved(environment_.positions().begin(), environment_.positions().end());
      for (Vec3& x : moved) x += vector(-1, 1) * shift;
      environment_.move(moved);
    }
    field_->set_times(std::vector<double>{0.0, 0.5, 1.0}, environment_.complex());
    const CellComplex& complex = environment_.complex();
    std::vector<Vec3> halfway;
    for (std::size_t v = 0; v < complex.positions().size(); ++v) {
      const Vec3 from = complex.previous_positions()[v];
      halfway.push_back(from + (complex.positions()[v] - from) * 0.5);
    }
    const RungeKuttaStep step = {complex, *field_, dt, shift > 0.0, halfway};
    std::vector<ParticleStatus> statuses(particles_.size());
    for (ParticleStatus& s : statuses) s = random_.below(10) == 0 ? ParticleStatus::stuck : ParticleStatus::alive;
    const Vec3 untouched = {7, 7, 7};
    std::vector<Vec3> velocities(particles_.size(), untouched);
    runge_kutta_velocities(step, {particles_.states(), particles_.vertex_numbers(), statuses, velocities, {}, {}});
    for (std::size_t i = 0; i < particles_.size(); ++i) {
      const bool follows = !particles_[i].held && statuses[i] == ParticleStatus::alive;
      const Vec3 alone = follows ? runge_kutta_velocity(step, particles_[i]) : untouched;
      ASSERT_EQ(std::memcmp(&velocities[i], &alone, sizeof alone), 0) << i << ", " << dt << ", " << shift;
    }
  }

 private:
  Vec3 vector(double low, double high) {
    const bool lattice = random_.below(2) == 0;
    const auto number = [&] {
      return lattice ? low + 0.5 * random_.below(std::uint32_t(2 * (high - low))) : random_.uniform(low, high);
    };
    const Vec3 v = {number(), number(), number()};
    return planar_ ? Vec3{v.x, v.y, 0.0} : v;
  }

  Random& random_;
  bool planar_;
  MeshData mesh_;
  Environment environment_;
  Particles particles_;
  std::optional<VectorField> field_;
};

TEST(RungeKutta, ManyAtOnceHaveTheBitsOfEach) {
  Random random(4);
  RectangleOptions rectangle;
  rectangle.cells = {4, 4};
  rectangle.size = {4, 4};
  BoxOptions box;
  box.cells = {4, 4, 4};
  box.size = {4, 4, 4};
  const std::vector<MeshData> meshes = {generate_rectangle(rectangle),
                                        test::cubes(4),
                                        test::cubes(4, CellType::tetrahedron, 0.2),
                                        test::cubes(4, CellType::hexahedron, 0.1, 0.6),
                                        test::patchwork({4, 4, 4}, random),
                                        test::periodic_box(box, 3)};
  for (const MeshData& mesh : meshes) {
    for (const FieldPlace place : {FieldPlace::points, FieldPlace::cells}) {
      for (const FieldFrame frame : {FieldFrame::space, FieldFrame::mesh}) {
        for (const double dt : {1e-6, 0.125, 1.0, 100.0}) {
          Crowd(mesh, place, frame, random).expect_same_bits(dt, 0.0);
          if (!mesh.periodic.empty()) continue;
          for (const double shift : {1e-9, 0.1, 0.6}) Crowd(mesh, place, frame, random).expect_same_bits(dt, shift);
        }
      }
    }
  }
}

TEST(RungeKutta, RefusesWhatItCannotFollow) {
  Environment environment(test::cube_of(2, 10.0));
  const auto refused = [&](const std::function<void(SimulationOptions&)>& change) {
    return test::refusal([&] {
      SimulationOptions o = options(0.1);
      change(o);
      Simulation simulation(environment, o);
      simulation.step();
    });
  };
  expect_parts(refused([](SimulationOptions&) {}), {"rk4", "set_field()"});
  expect_parts(refused([](SimulationOptions& o) { o.drag = 1.0; }), {"rk4", "drag must be 0"});
  expect_parts(refused([](SimulationOptions& o) { o.substeps = 2; }), {"rk4", "substeps must be 1"});
  expect_parts(refused([](SimulationOptions& o) { o.collisions.emplace(); }), {"rk4", "collisions"});
}

}  // namespace dartcast::runge_kutta_test
