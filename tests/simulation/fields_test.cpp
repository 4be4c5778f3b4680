// Fields at points and cells, at several times, and forces: against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/remeshing.hpp"
#include "dartcast/simulation.hpp"
#include "support/expectations.hpp"
#include "support/meshes.hpp"
#include "support/tier.hpp"

namespace dartcast::fields_test {

using test::expect_near;
using test::expect_parts;

using Field = std::function<Vec3(const Vec3&, double)>;

SimulationOptions options(double dt) {
  SimulationOptions o;
  o.dt = dt;
  return o;
}

// Jitter brings Steiner points.
MeshData jittered() {
  BoxOptions box;
  box.cells = {6, 6, 6};
  box.size = {10, 10, 10};
  box.jitter = 0.7;
  return generate_box(box);
}

FieldSamples samples(const MeshData& mesh, const std::vector<double>& times, const Field& f, double period = 0.0) {
  std::vector<std::vector<Vec3>> values;
  for (const double t : times) {
    values.emplace_back();
    for (const Vec3& p : mesh.points) values.back().push_back(f(p, t));
  }
  return field_samples(times, values, FieldPlace::points, period);
}

Vec3 linear(const Vec3& p, double t) {
  return {0.1 * p.y + 0.5 - t, 0.2 * p.z - 0.1 * p.x + 0.25 * t, 0.3 - 0.1 * p.y};
}

std::vector<Vec3> places(const Simulation& simulation) {
  std::vector<Vec3> all;
  for (const ParticleState& s : simulation.particles().states()) all.push_back(s.position);
  return all;
}

void expect_velocities(const Simulation& simulation, const std::vector<Vec3>& places, double t) {
  ASSERT_EQ(simulation.particles().size(), places.size());
  for (std::size_t i = 0; i < places.size(); ++i) expect_near(simulation.velocities()[i], linear(places[i], t), 1e-11);
}

Vec3 value_at(const VectorField& field, Environment& environment, const Vec3& x) {
  const SimplexId at = environment.locate(x).simplex;
  const Corners v = environment.complex().corners(at);
  const double volume = dot(v[1] - v[0], cross(v[2] - v[0], v[3] - v[0]));
  std::array<double, 4> w{};
  w[1] = dot(x - v[0], cross(v[2] - v[0], v[3] - v[0])) / volume;
  w[2] = dot(v[1] - v[0], cross(x - v[0], v[3] - v[0])) / volume;
  w[3] = dot(v[1] - v[0], cross(v[2] - v[0], x - v[0])) / volume;
  w[0] = 1.0 - w[1] - w[2] - w[3];
  return field.at(environment.complex(), at, w, v);
}

// Also outside the samples' times, where the first and last stay.
TEST(Fields, LinearInSpaceAndTimeIsExactAtPoints) {
  const MeshData mesh = jittered();
  Environment environment(mesh);
  ASSERT_GT(environment.complex().steiner_point_count(), 0U);
  VelocityField field(environment.complex(), samples(mesh, {0.0, 1.0, 3.0}, linear));
  EXPECT_FALSE(field.steady());
  for (const double t : {0.0, 0.3, 1.0, 2.5, 3.0, -1.0, 4.0}) {
    field.hold(t, t);
    field.set_times(std::vector<double>{t}, environment.complex());
    for (const Vec3& x : {Vec3{5.1, 5.2, 5.3}, Vec3{1.1, 9.2, 3.3}, Vec3{0.0, 0.0, 0.0}})
      expect_near(value_at(field, environment, x), linear(x, std::min(std::max(t, 0.0), 3.0)), 1e-12);
  }
}

TEST(Fields, AnEditAtTheTimeThatIsSetCounts) {
  const MeshData mesh = jittered();
  Environment environment(mesh);
  VelocityField field(environment.complex(), samples(mesh, {0.0, 1.0}, linear));
  field.set_times(std::vector<double>{0.5}, environment.complex());
  const Vec3 x = {5.1, 5.2, 5.3};
  const Cell cell = environment.locate(x).simplex.cell;
  field.update_after_edit(environment.edit([&](ComplexEdit& e) { subdivide(e, cell); }), environment.complex());
  field.set_times(std::vector<double>{0.5}, environment.complex());
  expect_near(value_at(field, environment, x), linear(x, 0.5), 1e-12);
}

// The step uses the field at its start; each of its segments that at the segment's start.
TEST(Fields, AStepUsesTheFieldAtItsStart) {
  const MeshData mesh = jittered();
  Environment environment(mesh);
  Simulation simulation(environment, options(0.125));
  simulation.set_field(VelocityField(environment.complex(), samples(mesh, {0.0, 0.5, 2.0}, linear)));
  simulation.add({{5, 5, 5}, {4, 6, 5}}, {});
  for (int i = 0; i < 12; ++i) {
    const std::vector<Vec3> before = places(simulation);
    simulation.step();
    expect_velocities(simulation, before, 0.125 * i);
  }
  Environment other(mesh);
  SimulationOptions o = options(0.5);
  o.substeps = 4;
  Simulation segments(other, o);
  segments.set_field(VelocityField(other.complex(), samples(mesh, {0.0, 2.0}, [](const Vec3&, double t) {
                                     return Vec3{t, 0, 0};
                                   })));
  segments.add({{5, 5, 5}}, {});
  segments.step();
  EXPECT_DOUBLE_EQ(segments.velocities()[0].x, 0.375);
  EXPECT_DOUBLE_EQ(segments.particles()[0].position.x, 5 + 0.125 * (0.125 + 0.25 + 0.375));
}

TEST(Fields, EditsKeepALinearFieldExact) {
  const MeshData mesh = jittered();
  Environment environment(mesh);
  Simulation simulation(environment, options(0.0625));
  simulation.set_field(VelocityField(environment.complex(), samples(mesh, {0.0, 1.0, 2.0}, linear)));
  simulation.add({{5, 5, 5}, {5.5, 4.5, 5}, {3, 5, 6}}, {});
  for (int i = 0; i < 24; ++i) {
    if (i % 4 == 2) {
      const Cell c = simulation.particles()[0].cell;
      simulation.edit([&](ComplexEdit& e) { subdivide(e, c); });
    }
    const std::vector<Vec3> before = places(simulation);
    simulation.step();
    expect_velocities(simulation, before, 0.0625 * i);
  }
}

// At 0, 1/4, 1/2, 3/4; the period is 1.
TEST(Fields, ACyclicFieldWraps) {
  const MeshData mesh = test::cube_of(2, 10.0);
  Environment environment(mesh);
  const std::vector<double> heights = {1.0, 3.0, -1.0, 2.0};
  std::vector<std::size_t> reads;
  FieldSamples s;
  s.times = {0.0, 0.25, 0.5, 0.75};
  s.period = 1.0;
  s.read = [&](std::size_t k) {
    reads.push_back(k);
    return std::vector<Vec3>(mesh.points.size(), Vec3{heights[k], 0, 0});
  };
  Simulation simulation(environment, options(0.0625));
  simulation.set_field(VelocityField(environment.complex(), s));
  simulation.add({{1, 5, 5}}, {});
  for (int i = 0; i < 64; ++i) {
    simulation.step();
    const double phase = std::fmod(0.0625 * i, 1.0) * 4.0;
    const auto k = static_cast<std::size_t>(phase);
    const double share = phase - static_cast<double>(k);
    EXPECT_DOUBLE_EQ(simulation.velocities()[0].x, heights[k] * (1 - share) + heights[(k + 1) % 4] * share) << i;
  }
  EXPECT_EQ(reads.size(), 4U * 4U + 2U) << "each once in a cycle, and those of the time 4";
}

// Values that are quadratic in time, at unequal distances; each sample is held as long as four need it.
TEST(Fields, ACubicInTimeIsExactForQuadratics) {
  const MeshData mesh = test::cube_of(2, 10.0);
  Environment environment(mesh);
  const auto value = [](double t) { return Vec3{0.3 - 0.2 * t + 0.15 * t * t, 0.01 * t * t, 0.02 * t}; };
  std::vector<std::size_t> reads;
  FieldSamples s;
  s.times = {-1.0, -0.25, 0.5, 0.75, 1.5, 2.0, 3.0};
  s.interpolation = Interpolation::cubic;
  s.read = [&](std::size_t k) {
    reads.push_back(k);
    return std::vector<Vec3>(mesh.points.size(), value(s.times[k]));
  };
  Simulation simulation(environment, options(0.0625));
  simulation.set_field(VelocityField(environment.complex(), s));
  simulation.add({{1, 5, 5}}, {});
  for (int i = 0; i < 30; ++i) {  // up to 1.875
    simulation.step();
    expect_near(simulation.velocities()[0], value(0.0625 * i), 1e-14);
  }
  EXPECT_EQ(reads, (std::vector<std::size_t>{0, 1, 2, 3, 4, 5, 6}));
}

TEST(Fields, ACubicFieldMayRepeat) {
  const MeshData mesh = test::cube_of(2, 10.0);
  for (const double period : {1.0, 1.25}) {
    Environment environment(mesh);
    FieldSamples s;
    s.times = {0.0, 0.25, 0.5, 1.0};
    s.interpolation = Interpolation::cubic;
    s.period = period;
    const std::array heights = {0.0, 2.0, -1.0, 0.0};
    s.read = [&](std::size_t k) { return std::vector<Vec3>(mesh.points.size(), Vec3{heights[k], 0, 0}); };
    VelocityField field(environment.complex(), s);
    const auto at = [&](double t) {
      field.set_times({{t}}, environment.complex());
      return field.values()[0].x;
    };
    for (const double t : {0.0, 0.1, 0.25, 0.3, 0.9}) EXPECT_NEAR(at(t), at(t + 2.0 * period), 1e-14) << t;
    for (std::size_t k = 0; k < 4; ++k) EXPECT_DOUBLE_EQ(at(s.times[k]), heights[k]);
    constexpr double h = 1e-6;
    for (const double t : {0.25, 0.5, 1.0, period})
      EXPECT_NEAR((at(t) - at(t - h)) / h, (at(t + h) - at(t)) / h, 1e-3) << period << " at " << t;
  }
}

TEST(Fields, WithoutAPeriodTheLastSampleStays) {
  const MeshData mesh = test::cube_of(2, 10.0);
  Environment environment(mesh);
  Simulation simulation(environment, options(0.25));
  simulation.set_field(VelocityField(environment.complex(), samples(mesh, {0.5, 1.0}, [](const Vec3&, double t) {
                                       return Vec3{t, 0, 0};
                                     })));
  simulation.add({{1, 5, 5}}, {});
  for (const double expected : {0.5, 0.5, 0.5, 0.75, 1.0, 1.0, 1.0}) {
    simulation.step();
    EXPECT_DOUBLE_EQ(simulation.velocities()[0].x, expected);
  }
}

// One step over many samples, and over more than a period.
TEST(Fields, LongStepsSkipSamples) {
  const MeshData mesh = test::cube_of(2, 10.0);
  for (const double period : {0.0, 1.0}) {
    Environment environment(mesh);
    Simulation simulation(environment, options(0.875));
    const std::vector<double> times = {0.0, 0.125, 0.25, 0.5, 0.875};
    simulation.set_field(VelocityField(environment.complex(), samples(
                                                                  mesh, times,
                                                                  [](const Vec3&, double t) {
                                                                    return Vec3{0, t, 0};
                                                                  },
                                                                  period)));
    simulation.add({{1, 1, 5}}, {});
    for (int i = 0; i < 9; ++i) {
      simulation.step();
      const double t = period > 0.0 ? std::fmod(0.875 * i, 1.0) : std::min(0.875 * i, 0.875);
      EXPECT_DOUBLE_EQ(simulation.velocities()[0].y, t) << i;
    }
  }
}

// By source; parts of a cell keep its value.
TEST(Fields, AtCellsAFieldIsConstantInEachCell) {
  MeshData mesh = test::cubes(3);
  for (const CellType type : {CellType::hexahedron, CellType::tetrahedron}) {
    mesh = test::cubes(3, type);
    Environment environment(mesh);
    std::vector<std::vector<Vec3>> values(2);
    for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
      values[0].push_back({0.001 * static_cast<double>(c), 0, 0});
      values[1].push_back({0.001 * static_cast<double>(c), 0.25, 0});
    }
    Simulation simulation(environment, options(0.0625));
    simulation.set_field(VelocityField(environment.complex(), field_samples({0.0, 1.0}, values, FieldPlace::cells)));
    simulation.add({{1.5, 1.3, 1.4}, {0.2, 0.3, 0.4}, {2.3, 2.1, 2.8}}, {});
    for (int i = 0; i < 8; ++i) {
      if (i == 3) {
        const Cell c = simulation.particles()[0].cell;
        simulation.edit([&](ComplexEdit& e) { subdivide(e, c); });
      }
      std::vector<double> expected;
      for (const ParticleState& s : simulation.particles().states())
        expected.push_back(0.001 * environment.map().source(s.cell));
      simulation.step();
      for (std::size_t k = 0; k < expected.size(); ++k)
        expect_near(simulation.velocities()[k], {expected[k], 0.25 * 0.0625 * i, 0}, 1e-15);
    }
  }
}

// dv/dt = g + f: v = (g + f0) t + f1 t^2 / 2 at the steps' starts.
TEST(Fields, AForceAddsToGravity) {
  const MeshData mesh = test::cube_of(3, 10.0);
  for (const double drag : {0.0, 2.0}) {
    Environment environment(mesh);
    SimulationOptions o = options(0.01);
    o.gravity = {0, 0, -0.5};
    o.drag = drag;
    Simulation simulation(environment, o);
    simulation.set_force(VectorField(environment.complex(), samples(mesh, {0.0, 10.0}, [](const Vec3&, double t) {
                                       return Vec3{0.25, 0.5 * t, 0.5};
                                     })));
    simulation.add({{5, 5, 5}}, {});
    Vec3 v;
    for (int i = 0; i < 100; ++i) {
      simulation.step();
      const Vec3 a = {0.25, 0.5 * 0.01 * i, 0.0};
      v = drag == 0.0 ? v + a * 0.01 : a * (1.0 / drag) + (v - a * (1.0 / drag)) * std::exp(-drag * 0.01);
      expect_near(simulation.velocities()[0], v, 1e-13);
    }
  }
}

// A force in the mesh's frame turns with the mesh.
TEST(Fields, AForceMayTurnWithTheMesh) {
  const MeshData mesh = test::cube_of(3, 10.0);
  Environment environment(mesh);
  Simulation simulation(environment, options(0.01));
  const std::vector<Vec3> along(mesh.points.size(), Vec3{1, 0, 0});
  simulation.set_force(VectorField(environment.complex(), along, FieldFrame::mesh));
  DeformationStep turn;
  turn.period = 1.0;
  turn.centre = {5, 5, 5};
  simulation.set_deformation(Deformation({turn}, mesh.points));
  simulation.add({{5, 5, 5}}, {});
  Vec3 v;
  for (int i = 0; i < 50; ++i) {
    simulation.step();
    const double angle = 2 * std::numbers::pi * 0.01 * (i + 1);
    v += Vec3{std::cos(angle), std::sin(angle), 0} * 0.01;
    expect_near(simulation.velocities()[0], v, 1e-12);
  }
}

// A sample that cannot be read: the step is refused as a whole, and can be repeated.
TEST(Fields, AStepWhoseSampleCannotBeReadChangesNothing) {
  const MeshData mesh = test::cube_of(3, 10.0);
  Environment environment(mesh);
  bool readable = false;
  FieldSamples s;
  s.times = {0.0, 0.25, 0.5};
  s.read = [&](std::size_t k) {
    if (k == 2 && !readable) throw Error("U_2.vtu: the disk is gone");
    return std::vector<Vec3>(mesh.points.size(), Vec3{1, 0, 0});
  };
  Simulation simulation(environment, options(0.125));
  simulation.set_field(VelocityField(environment.complex(), s));
  simulation.add_inlet(environment.map().patch("xmin"), 100.0, {});
  simulation.step();
  const std::string hash = simulation.state_hash().hex();
  EXPECT_THROW(simulation.step(), Error);
  EXPECT_THROW(simulation.step(), Error);
  EXPECT_EQ(simulation.steps(), 1U);
  EXPECT_EQ(simulation.state_hash().hex(), hash);
  readable = true;
  simulation.step();
  EXPECT_EQ(simulation.steps(), 2U);
}

std::string run(unsigned threads, Integrator integrator, int steps, int restart) {
  const MeshData mesh = jittered();
  const auto swirl = [](const Vec3& p, double t) {
    return Vec3{5 - p.y + t, p.x - 5, 0.3 * (5 - p.z)} * (1.0 + 0.5 * t);
  };
  const auto make = [&](Environment& environment) {
    SimulationOptions o = options(0.05);
    o.integrator = integrator;
    o.response = Reflect{0.5, 0.1};
    auto simulation = std::make_unique<Simulation>(environment, o);
    simulation->set_field(VelocityField(environment.complex(), samples(mesh, {0.0, 0.3, 0.4, 0.9}, swirl, 1.0)));
    DeformationStep bend;
    bend.kind = DeformationKind::bump;
    bend.amplitude = 0.5;
    bend.period = 0.7;
    bend.centre = {5, 5, 0};
    bend.length = 6.0;
    simulation->set_deformation(Deformation({bend}, mesh.points));
    return simulation;
  };
  Environment environment(mesh, {threads});
  auto simulation = make(environment);
  simulation->add_random(600, {});
  for (int i = 0; i < (restart > 0 ? restart : steps); ++i) simulation->step();
  EXPECT_GT(simulation->totals().counters.contacts[2], 0U);
  if (restart == 0) return simulation->state_hash().hex();
  Environment again(mesh, {threads});
  auto resumed = make(again);
  resumed->restore(simulation->checkpoint());
  for (int i = restart; i < steps; ++i) resumed->step();
  test::expect_audited(again.complex(), resumed->particles());
  return resumed->state_hash().hex();
}

TEST(Fields, TheSameBitsForAnyThreadsAndAfterARestart) {
  for (const Integrator integrator : test::all_or_first({Integrator::rk4, Integrator::euler})) {
    const std::string one = run(1, integrator, 60, 0);
    EXPECT_EQ(run(3, integrator, 60, 0), one);
    EXPECT_EQ(run(2, integrator, 60, 33), one);
  }
}

std::string refused(const test::Call& make) { return test::refusal(make); }

TEST(Fields, RefusesSamplesThatDoNotFit) {
  const MeshData mesh = test::cube_of(1, 1.0);
  Environment environment(mesh);
  const CellComplex& complex = environment.complex();
  const std::vector<Vec3> good(8, Vec3{1, 0, 0});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Vec3> bad = good;
  bad[5].y = nan;
  const auto at_points = [&](std::vector<double> times, std::vector<std::vector<Vec3>> values, double period = 0.0) {
    return refused(
        [&] { VectorField(complex, field_samples(std::move(times), std::move(values), FieldPlace::points, period)); });
  };
  EXPECT_EQ(at_points({0, 1}, {good, good}, 1.0), "done");
  expect_parts(at_points({0, 1}, {good}), {"2 times for 1 lists"});
  expect_parts(at_points({}, {}), {"no sample"});
  expect_parts(at_points({0, 0}, {good, good}), {"must increase", "time 1", "0 s"});
  expect_parts(at_points({0, nan}, {good, good}), {"time 1", "not finite"});
  expect_parts(at_points({0, 2}, {good, good}, 1.0), {"period is 1 s", "2 s"});
  expect_parts(at_points({0, 2}, {good, good}, -1.0), {"period is -1 s"});
  expect_parts(at_points({0}, {good}, 1.0), {"period", "single sample"});
  expect_parts(at_points({0, 1}, {bad, good}), {"sample 0", "point 5", "not finite"});
  expect_parts(at_points({0, 1}, {std::vector<Vec3>(3), good}), {"sample 0", "3 values for 8 points"});
  expect_parts(refused([&] { VectorField(complex, field_samples({0}, {good}, FieldPlace::cells)); }),
               {"8 values for 1 cells"});
  expect_parts(refused([&] { VectorField(complex, FieldSamples{}); }), {"nothing to read"});
  VectorField late(complex, field_samples({0, 1}, {good, bad}));
  expect_parts(refused([&] { late.hold(0.0, 0.5); }), {"sample 1", "1 s", "point 5", "not finite"});
  late.set_times(std::vector<double>{0.0}, complex);
  MeshData twice = test::cubes(2);
  twice.source.assign(8, 3);
  Environment same(twice);
  expect_parts(refused([&] { VectorField(same.complex(), field_samples({0}, {good}, FieldPlace::cells)); }),
               {"same source"});
  Environment plane(generate_rectangle({}));
  expect_parts(refused([&] {
                 VectorField(plane.complex(), std::vector<Vec3>(4, Vec3{0, 0, 1}));
               }),
               {"point 0", "in the plane its z must be 0"});
}

}  // namespace dartcast::fields_test
