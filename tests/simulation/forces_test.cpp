// Forces and laws: against closed forms, roots of the laws, and a Runge-Kutta scheme in small steps.
#include "dartcast/forces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <mutex>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "simulation/force_kernel.hpp"
#include "simulation/simulation_state.hpp"
#include "support/expectations.hpp"
#include "support/thread_ranks.hpp"

namespace dartcast::forces_test {

using test::expect_near;

constexpr Vec3 gravity = {0.0, 0.0, -9.81};
constexpr Fluid air = {1.2, 1.8e-5, 0.0};
constexpr double water = 1000.0;

MeshData box_of(double edge, std::uint32_t cells = 2, double jitter = 0.0) {
  BoxOptions box;
  box.cells = {cells, cells, cells};
  box.size = {edge, edge, edge};
  box.jitter = jitter;
  return generate_box(box);
}

SimulationOptions with(std::vector<Force> terms, double dt, const Fluid& fluid = air) {
  SimulationOptions o;
  o.dt = dt;
  o.forces.terms = std::move(terms);
  o.forces.fluid = fluid;
  return o;
}

// The factors of the laws, as physics books have them.
double factor(Force law, double re) {
  if (law == Force::stokes) return 1.0;
  if (law == Force::schiller_naumann) return re <= 1000.0 ? 1.0 + 0.15 * std::pow(re, 0.687) : 0.44 * re / 24.0;
  return re <= 1000.0 ? 1.0 + std::pow(re, 2.0 / 3.0) / 6.0 : 0.424 * re / 24.0;
}

double slip(const Fluid& fluid, double d) {
  if (fluid.mean_free_path == 0.0) return 1.0;
  const double kn = 2.0 * fluid.mean_free_path / d;
  return 1.0 + kn * (1.257 + 0.4 * std::exp(-1.1 / kn));
}

double drag_rate(Force law, const Fluid& f, double d, double density, double speed) {
  const double tau = density * d * d / (18.0 * f.viscosity);
  return factor(law, speed * d * f.density / f.viscosity) / (tau * slip(f, d));
}

// The speed at which drag balances gravity: by bisection.
double terminal_speed(Force law, const Fluid& f, double d, double density) {
  double low = 0.0;
  double high = 1e4;
  for (int i = 0; i < 200; ++i) {
    const double v = 0.5 * (low + high);
    (v * drag_rate(law, f, d, density, v) < 9.81 * (1.0 - f.density / density) ? low : high) = v;
  }
  return low;
}

// The speed of a drop that falls until it does so steadily.
double fall(Force law, const Fluid& fluid, double d) {
  Environment environment(box_of(400.0));
  SimulationOptions o = with({law, Force::buoyancy}, 0.05, fluid);
  o.gravity = gravity;
  Simulation simulation(environment, o);
  simulation.add(std::vector<Vec3>{{190.0, 180.0, 390.0}}, {}, 0.0, {}, {d, water, 0.0});
  for (int i = 0; i < 300; ++i) simulation.step();
  return -simulation.velocities()[0].z;
}

TEST(Forces, DropsFallAsTheirLawSays) {
  const Fluid thin = {1.2, 1.8e-5, 6.6e-8};
  for (const Force law : {Force::stokes, Force::schiller_naumann, Force::putnam}) {
    for (const double d : {5e-7, 1e-5, 1e-4, 5e-4, 4e-3}) {
      if (law == Force::stokes && d > 1e-4) continue;
      for (const Fluid& fluid : {air, thin}) {
        const double truth = terminal_speed(law, fluid, d, water);
        EXPECT_NEAR(fall(law, fluid, d), truth, 1e-6 * truth) << static_cast<int>(law) << " " << d;
      }
    }
  }
}

// OpenFOAM 1912, icoUncoupledKinematicParcelFoam with sphereDrag and gravity.
TEST(Forces, DropsFallAsInOpenFoam) {
  constexpr std::array<std::array<double, 2>, 4> peers = {
      {{50e-6, 0.0711}, {100e-6, 0.2456}, {200e-6, 0.6966}, {500e-6, 2.01}}};
  for (const auto& [d, speed] : peers) EXPECT_NEAR(fall(Force::putnam, air, d), speed, 0.01 * speed);
}

// One step of any length is the closed form.
TEST(Forces, StokesInAStillFluidIsExactForAnyStep) {
  const double d = 1e-4;
  const double tau = water * d * d / (18.0 * air.viscosity);
  for (const double steps_per_tau : {1e-3, 0.1, 0.33, 0.35, 1.0, 30.0, 1e5}) {
    const double dt = steps_per_tau * tau;
    Environment environment(box_of(2e6));
    SimulationOptions o = with({Force::stokes}, dt);
    o.gravity = gravity;
    Simulation simulation(environment, o);
    const Vec3 start = {1.1e6, 0.9e6, 0.7e6};
    const Vec3 v0 = {1.0, -2.0, 0.5};
    simulation.add(std::vector<Vec3>{start}, v0, 0.0, {}, {d, water, 0.0});
    simulation.step();
    const Vec3 w = gravity * tau;
    const double left = std::exp(-dt / tau);
    expect_near(simulation.velocities()[0], w + (v0 - w) * left, 1e-13);
    expect_near(simulation.particles()[0].position, start + w * dt + (v0 - w) * (tau * (1.0 - left)),
                1e-9 + 1e-13 * dt);
  }
}

TEST(Forces, AChargeTurnsOnTheExactRadius) {
  const double charge = 2.0;
  for (const double turns : {0.01, 0.1, 0.7}) {  // radians a step
    Environment environment(box_of(10.0));
    SimulationOptions o = with({Force::lorentz}, turns / (charge * 3.0));
    o.forces.magnetic_field = {0.0, 0.0, 3.0};
    Simulation simulation(environment, o);
    simulation.add(std::vector<Vec3>{{5.1, 5.2, 5.3}}, {3.0, 0.0, 0.1}, 0.0, {}, {0.0, 0.0, charge});
    const double radius = 3.0 / (charge * 3.0);
    const Vec3 centre = {5.1, 5.2 - radius, 5.3};
    std::vector<Vec3> places;
    for (int i = 0; i < 200; ++i) {
      simulation.step();
      const Vec3& v = simulation.velocities()[0];
      EXPECT_NEAR(std::hypot(v.x, v.y), 3.0, 1e-12);
      places.push_back(simulation.particles()[0].position);
    }
    const auto flat = [](const Vec3& a, const Vec3& b) { return std::hypot(a.x - b.x, a.y - b.y); };
    const double a = flat(places[0], places[1]), b = flat(places[1], places[2]), c = flat(places[0], places[2]);
    const double s = 0.5 * (a + b + c);
    EXPECT_NEAR(a * b * c / (4.0 * std::sqrt(s * (s - a) * (s - b) * (s - c))), radius, 1e-7) << turns;
    EXPECT_NEAR(flat(places[199], centre), radius, 1e-11) << turns;
  }
}

TEST(Forces, ChargesDriftAcrossElectricAndMagneticFields) {
  Environment environment(box_of(100.0));
  SimulationOptions o = with({Force::lorentz}, 0.01);
  o.forces.electric_field = {0.0, 2.0, 0.0};
  o.forces.magnetic_field = {0.0, 0.0, 4.0};
  Simulation simulation(environment, o);
  const Vec3 drift = {0.5, 0.0, 0.0};  // E x B / B^2
  simulation.add(std::vector<Vec3>{{50.0, 50.0, 50.0}}, drift, 0.0, {}, {0.0, 0.0, 7.0});
  simulation.add(std::vector<Vec3>{{50.0, 50.0, 50.0}}, {}, 0.0, {}, {0.0, 0.0, -7.0});
  for (int i = 0; i < 1000; ++i) simulation.step();
  expect_near(simulation.velocities()[0], drift, 1e-11);
  expect_near(simulation.particles()[0].position, Vec3{50.0, 50.0, 50.0} + drift * 10.0, 1e-10);
  EXPECT_NEAR(simulation.particles()[1].position.x, 50.0 + 0.5 * 10.0, 2.0 * 0.5 / 28.0);
}

// The equation of motion of dartcast/forces.hpp, with powers of the standard library.
struct Equation {
  std::function<Vec3(const Vec3&, double)> fluid;
  double d, density;
  Fluid medium;
  std::vector<Force> terms;

  [[nodiscard]] bool has(Force f) const { return std::find(terms.begin(), terms.end(), f) != terms.end(); }
  [[nodiscard]] Vec3 acceleration(const Vec3& x, const Vec3& v, double t) const {
    const double h = 1e-5;
    const auto along = [&](const Vec3& e) { return (fluid(x + e * h, t) - fluid(x - e * h, t)) * (0.5 / h); };
    const VelocityGradient g = {along({1, 0, 0}), along({0, 1, 0}), along({0, 0, 1})};
    const Vec3 u = fluid(x, t);
    const Vec3 material = (fluid(x, t + h) - fluid(x, t - h)) * (0.5 / h) + g.along(u);
    const double k = medium.density / density;
    Vec3 a = (u - v) * drag_rate(Force::schiller_naumann, medium, d, density, norm(u - v)) +
             gravity * (has(Force::buoyancy) ? 1.0 - k : 1.0);
    if (has(Force::pressure_gradient)) a += material * k;
    if (has(Force::saffman_mei)) a += lift(u - v, g.curl()) * k;
    return has(Force::virtual_mass) ? (a + material * (0.5 * k)) * (1.0 / (1.0 + 0.5 * k)) : a;
  }
  [[nodiscard]] Vec3 lift(const Vec3& slip, const Vec3& curl) const {
    const double nu = medium.viscosity / medium.density;
    const double re = norm(slip) * d / nu;
    const double shear = norm(curl) * d * d / nu;
    const double b = shear / (2.0 * re);
    const double f = re <= 40.0 ? (1.0 - 0.3314 * std::sqrt(b)) * std::exp(-re / 10.0) + 0.3314 * std::sqrt(b)
                                : 0.0524 * std::sqrt(b * re);
    return cross(slip, curl) * (3.0 * 6.46 * f / (2.0 * std::numbers::pi * std::sqrt(shear)));
  }
  // The place at the end, by many steps of the fourth order.
  [[nodiscard]] Vec3 place(Vec3 x, Vec3 v, double end) const {
    const int steps = 400;
    const double h = end / steps;
    for (int i = 0; i < steps; ++i) {
      const double t = i * h;
      const Vec3 a1 = acceleration(x, v, t);
      const Vec3 v2 = v + a1 * (0.5 * h), a2 = acceleration(x + v * (0.5 * h), v2, t + 0.5 * h);
      const Vec3 v3 = v + a2 * (0.5 * h), a3 = acceleration(x + v2 * (0.5 * h), v3, t + 0.5 * h);
      const Vec3 v4 = v + a3 * h, a4 = acceleration(x + v3 * h, v4, t + h);
      x += (v + v2 * 2.0 + v3 * 2.0 + v4) * (h / 6.0);
      v += (a1 + a2 * 2.0 + a3 * 2.0 + a4) * (h / 6.0);
    }
    return x;
  }
};

// A flow that is linear in space and time, so that a mesh holds it exactly.
Vec3 swirl(const Vec3& p, double t) {
  const Vec3 x = p - Vec3{5.0, 5.0, 5.0};
  return {-x.y + 0.3 * x.z + 0.2 * t, x.x - 0.2 * x.z + 0.1, 0.3 * x.x - 0.5 * t * 1.0};
}

FieldSamples swirl_at(const MeshData& mesh, double end) {
  std::vector<std::vector<Vec3>> values(2);
  for (const Vec3& p : mesh.points) {
    values[0].push_back(swirl(p, 0.0));
    values[1].push_back(swirl(p, end));
  }
  return field_samples({0.0, end}, values);
}

const std::vector<Force> all_terms = {Force::schiller_naumann, Force::buoyancy, Force::pressure_gradient,
                                      Force::virtual_mass, Force::saffman_mei};

// Slope of the error when the step is halved.
void expect_second_order(const std::function<double(double)>& error, const char* what) {
  const double coarse = error(0.02);
  const double middle = error(0.01), fine = error(0.005);
  EXPECT_NEAR(std::log2(coarse / middle), 2.0, 0.3) << what;
  EXPECT_NEAR(std::log2(middle / fine), 2.0, 0.2) << what;
}

TEST(Forces, AStepIsOfSecondOrder) {
  const double end = 0.8;
  const Vec3 start = {5.7, 4.8, 5.9}, velocity = {0.4, -0.3, 0.2};
  const Fluid medium = {1.2, 3e-3, 0.0};
  const Material material = {0.05, 2.0, 0.0};
  const MeshData mesh = box_of(10.0, 3, 0.3);
  for (const std::vector<Force>& terms : {std::vector<Force>{Force::schiller_naumann}, all_terms}) {
    const Equation equation = {swirl, material.diameter, material.density, medium, terms};
    const Vec3 truth = equation.place(start, velocity, end);
    expect_second_order(
        [&](double dt) {
          Environment environment(mesh);
          SimulationOptions o = with(terms, dt, medium);
          o.gravity = gravity;
          Simulation simulation(environment, o);
          simulation.set_field(VelocityField(environment.complex(), swirl_at(mesh, 2.0)));
          simulation.add(std::vector<Vec3>{start}, velocity, 0.0, {}, material);
          for (int i = 0; i < static_cast<int>(std::lround(end / dt)); ++i) simulation.step();
          return norm(simulation.particles()[0].position - truth);
        },
        "all in a mesh at rest");
  }
}

// Values go with the vertices: in a mesh that turns, the flow is that of the place where the mesh was at rest.
TEST(Forces, AStepIsOfSecondOrderInAMeshThatMoves) {
  const double end = 0.8, period = 10.0;
  const Vec3 start = {5.7, 4.8, 5.9};
  const Fluid medium = {1.2, 3e-3, 0.0};
  const Material material = {0.05, 2.0, 0.0};
  const MeshData mesh = box_of(10.0, 3, 0.3);
  const Vec3 centre = {5.0, 5.0, 5.0};
  const auto turned = [&](const Vec3& x, double t) {
    const double a = 2.0 * std::numbers::pi * t / period;
    return Vec3{std::cos(a) * x.x - std::sin(a) * x.y, std::sin(a) * x.x + std::cos(a) * x.y, x.z};
  };
  for (const FieldFrame frame : {FieldFrame::space, FieldFrame::mesh}) {
    const bool in_space = frame == FieldFrame::space;
    const std::vector<Force> terms = in_space ? all_terms : std::vector<Force>{Force::schiller_naumann};
    const auto fluid = [&](const Vec3& x, double t) {
      const Vec3 u = swirl(centre + turned(x - centre, -t), t);
      const double w = 2.0 * std::numbers::pi / period;
      return in_space ? u : turned(u, t) + Vec3{-w * (x.y - centre.y), w * (x.x - centre.x), 0.0};
    };
    const Vec3 truth = Equation{fluid, material.diameter, material.density, medium, terms}.place(start, {}, end);
    expect_second_order(
        [&](double dt) {
          Environment environment(mesh);
          SimulationOptions o = with(terms, dt, medium);
          o.gravity = gravity;
          Simulation simulation(environment, o);
          simulation.set_field(VelocityField(environment.complex(), swirl_at(mesh, 2.0), frame));
          DeformationStep rotate;
          rotate.kind = DeformationKind::rotate;
          rotate.period = period;
          rotate.centre = centre;
          simulation.set_deformation(Deformation({rotate}, mesh.points));
          simulation.add(std::vector<Vec3>{start}, {}, 0.0, {}, material);
          for (int i = 0; i < static_cast<int>(std::lround(end / dt)); ++i) simulation.step();
          return norm(simulation.particles()[0].position - truth);
        },
        in_space ? "space" : "mesh");
  }
}

// Slips across a thin layer do not run away: what a step takes of a gradient is at most the cell's own change.
TEST(Forces, ALongStepStaysWithTheFieldOfItsCell) {
  BoxOptions box;
  box.cells = {100, 1, 1};
  box.size = {1.0, 1.0, 1.0};
  const MeshData mesh = generate_box(box);
  Environment environment(mesh);
  Simulation simulation(environment, with({Force::stokes}, 1.0));
  std::vector<Vec3> values;
  for (const Vec3& p : mesh.points) values.push_back(p.x < 0.5 / 100 ? Vec3{} : Vec3{0.3, 0.0, 0.0});
  simulation.set_field(VelocityField(environment.complex(), values));
  simulation.add(std::vector<Vec3>{{0.005, 0.5, 0.5}}, {}, 0.0, {}, {1e-6, water, 0.0});
  simulation.step();
  EXPECT_LE(simulation.velocities()[0].x, 0.15 + 0.3 + 1e-12);
  EXPECT_GE(simulation.velocities()[0].x, 0.0);
}

struct Stage {
  explicit Stage(std::size_t count) : n(count) {
    Random random(3);
    const auto vec = [&] { return Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}; };
    for (std::size_t i = 0; i < n; ++i) {
      ids.push_back(i);
      velocities.push_back(vec() * std::pow(10.0, random.uniform(-3, 2)));
      fluid.push_back(i % 9 == 0 ? velocities.back() : vec());
      gradients.push_back({vec(), vec(), i % 7 == 0 ? Vec3{} : vec()});
      rates.push_back(vec());
      diameters.push_back(std::pow(10.0, random.uniform(-7, -2)));
      densities.push_back(random.uniform(1, 3000));
      charges.push_back(random.uniform(-1, 1));
    }
    a.resize(n), c.resize(n), r.resize(n), ends.resize(n), ways.resize(n);
  }
  [[nodiscard]] LawParticles particles() const { return {ids, {}, velocities, diameters, densities, charges, {}}; }
  [[nodiscard]] LawSamples samples() const { return {fluid, gradients, rates}; }

  std::size_t n;
  std::vector<std::uint64_t> ids;
  std::vector<Vec3> velocities, fluid, rates, a, r, ends, ways;
  std::vector<VelocityGradient> gradients;
  std::vector<double> diameters, densities, charges, c;
};

TEST(Forces, KernelsGiveTheSameBitsInEveryInstructionSetAndLane) {
  for (const auto drag : {detail::ForceTerms::Drag::none, detail::ForceTerms::Drag::stokes,
                          detail::ForceTerms::Drag::schiller_naumann, detail::ForceTerms::Drag::putnam}) {
    for (const bool more : {false, true}) {
      const detail::ForceTerms terms = {
          drag, more, more, more, more, more, {1.2, 1.8e-5, more ? 6.6e-8 : 0.0}, gravity, {1, 2, 3}, {3, 1, 2}};
      std::optional<Stage> first;
      for (const auto set : {detail::InstructionSet::portable, detail::best_instruction_set()}) {
        for (const std::size_t shift : {0U, 1U, 3U}) {  // other lanes for each particle, and other ends
          Stage s(503);
          const std::size_t m = s.n - shift;
          const LawResult all = {s.a, s.c, more ? std::span(s.r) : std::span<Vec3>()};
          const LawResult result = {all.accelerations.last(m), all.rates.last(m),
                                    more ? all.rotations.last(m) : all.rotations};
          const LawParticles p = s.particles();
          const LawSamples u = s.samples();
          detail::apply_forces(terms,
                               {p.ids.last(m),
                                {},
                                p.velocities.last(m),
                                p.diameters.last(m),
                                p.densities.last(m),
                                p.charges_per_mass.last(m),
                                {}},
                               {u.velocities.last(m), u.gradients.last(m), u.rates.last(m)}, result, set);
          detail::move_held({p.velocities.last(m), u.velocities.last(m), result, 1e-3, std::span(s.ends).last(m),
                             std::span(s.ways).last(m)},
                            set);
          if (!first) first = s;
          for (std::size_t i = shift; i < s.n; ++i) {
            for (const auto list : {&Stage::a, &Stage::r, &Stage::ends, &Stage::ways})
              ASSERT_EQ(std::memcmp(&(s.*list)[i], &((*first).*list)[i], sizeof(Vec3)), 0) << i;
            ASSERT_EQ(s.c[i], first->c[i]) << i;
            ASSERT_TRUE(is_finite(s.ends[i]) && is_finite(s.ways[i])) << i;
          }
        }
      }
    }
  }
}

TEST(Forces, TermsAreThoseOfThePhysicsBooks) {
  Stage s(200);
  const Fluid medium = {1.2, 1.8e-5, 6.6e-8};
  const detail::ForceTerms terms = {
      detail::ForceTerms::Drag::schiller_naumann, true, true, true, true, false, medium, gravity, {}, {}};
  detail::apply_forces(terms, s.particles(), s.samples(), {s.a, s.c, {}});
  for (std::size_t i = 0; i < s.n; ++i) {
    const double k = medium.density / s.densities[i];
    const Vec3 w = s.fluid[i] - s.velocities[i];
    const Vec3 material = s.rates[i] + s.gradients[i].along(s.fluid[i]);
    const Equation equation = {{}, s.diameters[i], s.densities[i], medium, all_terms};
    Vec3 a = gravity * (1.0 - k) + material * (1.5 * k);
    if (norm(w) > 0.0) a += equation.lift(w, s.gradients[i].curl()) * k;
    expect_near(s.a[i], a * (1.0 / (1.0 + 0.5 * k)), 1e-12 * (1.0 + norm(a)));
    const double rate = drag_rate(Force::schiller_naumann, medium, s.diameters[i], s.densities[i], norm(w));
    EXPECT_NEAR(s.c[i], rate / (1.0 + 0.5 * k), 1e-13 * rate) << i;
  }
}

// A scene in which particles of many sizes cross a box, rebound and leave.
Scene windy() {
  Scene scene;
  BoxOptions box;
  box.cells = {8, 4, 4};
  box.size = {2.0, 1.0, 1.0};
  MeshData mesh = generate_box(box);
  DataArray u{"u", 3, {}};
  for (const Vec3& p : mesh.points) {
    for (const double x : {1.0 + p.y, 0.3 * p.z - 0.1, 0.5 * p.x - 0.3}) u.values.push_back(x);
  }
  mesh.point_data.push_back(u);
  scene.environment.mesh = mesh;
  scene.motion.field.array = "u";
  scene.motion.dt = 0.02;
  scene.motion.gravity = gravity;
  scene.motion.forces =
      with({Force::schiller_naumann, Force::buoyancy, Force::virtual_mass, Force::saffman_mei}, 0).forces;
  scene.contact.general = Reflect{0.7};
  scene.contact.by_patch["xmax"] = Escape{};
  for (const double d : {1e-5, 1e-4, 1e-3}) {
    ParticlesScene some;
    some.source = RandomParticles{100};
    some.material = {d, water, 0.0};
    scene.particles.push_back(some);
  }
  ParticlesScene entering;
  entering.source = InletParticles{"xmin", 400.0};
  entering.velocity = {1.0, 0.0, 0.0};
  entering.material = {2e-4, 500.0, 0.0};
  scene.particles.push_back(entering);
  return scene;
}

void expect_same(const SimulationCheckpoint& one, const SimulationCheckpoint& other) {
  const SavedParticles& a = one.state().particles.table;
  const SavedParticles& b = other.state().particles.table;
  ASSERT_EQ(a.rows(), b.rows());
  ASSERT_GT(a.rows(), 100U);
  for (std::size_t i = 0; i < a.rows(); ++i) {
    ASSERT_TRUE(a[a.id][i] == b[b.id][i] && a[a.diameter][i] == b[b.diameter][i] && a[a.density][i] == b[b.density][i]);
    ASSERT_EQ(std::memcmp(&a[a.velocity][i], &b[b.velocity][i], sizeof(Vec3)), 0) << i;
    ASSERT_EQ(std::memcmp(&a[a.state][i].position, &b[b.state][i].position, sizeof(Vec3)), 0) << i;
  }
}

TEST(Forces, BitsAreThoseOfAnyThreadsRanksAndResume) {
  const Scene scene = windy();
  Simulation alone(scene, Threads{1});
  std::optional<SimulationCheckpoint> half;
  for (int i = 0; i < 40; ++i) {
    if (i == 20) half = alone.checkpoint();
    alone.step();
  }
  EXPECT_GT(alone.totals().escaped, 50U);
  const SimulationCheckpoint truth = alone.checkpoint();
  Simulation threaded(scene, Threads{3});
  for (int i = 0; i < 40; ++i) threaded.step();
  expect_same(threaded.checkpoint(), truth);
  Simulation resumed(scene, *half);
  for (int i = 0; i < 20; ++i) resumed.step();
  expect_same(resumed.checkpoint(), truth);
  for (const Partition partition : {Partition::particles, Partition::cells}) {
    std::mutex mutex;
    std::vector<SimulationCheckpoint> parts;
    test::on_ranks(3, [&](Ranks& ranks) {
      Simulation shared(scene, Threads{1}, &ranks, partition);
      for (int i = 0; i < 40; ++i) shared.step();
      const std::lock_guard lock(mutex);
      parts.push_back(shared.checkpoint());
    });
    expect_same(joined(parts), truth);
  }
}

TEST(Forces, RefusesOptionsThatContradictEachOther) {
  Environment environment(box_of(1.0));
  const auto expect = [&](SimulationOptions o, const std::string& part) {
    try {
      Simulation simulation(environment, o);
      FAIL() << part;
    } catch (const InvalidArgument& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
  };
  SimulationOptions o = with({Force::stokes}, 0.1);
  o.drag = 1.0;
  expect(o, "leave drag out");
  expect(with({Force::stokes, Force::putnam}, 0.1), "several laws of drag");
  expect(with({Force::buoyancy, Force::buoyancy}, 0.1), "twice");
  expect(with({Force::stokes}, 0.1, {1.2, 0.0, 0.0}), "viscosity");
  expect(with({Force::buoyancy}, 0.1, {}), "density");
  expect(with({Force::stokes}, 0.1, {1.2, NAN, 0.0}), "viscosity is nan");
  o = with({Force::stokes}, 0.1);
  o.integrator = Integrator::rk4;
  expect(o, "rk4");
  o = with({Force::stokes}, 0.1);
  o.collisions.emplace();
  expect(o, "collide");
}

TEST(Forces, RefusesParticlesWithoutWhatForcesNeed) {
  Environment environment(box_of(1.0));
  Simulation simulation(environment, with({Force::stokes}, 0.1));
  const std::vector<Vec3> at = {{0.3, 0.3, 0.3}, {0.6, 0.6, 0.6}};
  const auto expect = [&](const std::function<void()>& call, const std::string& part) {
    try {
      call();
      FAIL() << part;
    } catch (const InvalidArgument& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
    EXPECT_EQ(simulation.particles().size(), 0U);
  };
  expect([&] { simulation.add(at, {}); }, "diameter is 0");
  expect([&] { simulation.add(at, {}, 0.0, {}, {1e-6, 0.0, 0.0}); }, "density is 0");
  expect([&] { simulation.add(at, {}, 0.0, {}, {-1e-6, 1.0, 0.0}); }, "diameter is -1e-06");
  const std::vector<Vec3> still(2);
  const std::vector<double> radii(2);
  const std::vector<Material> materials = {{1e-6, 1.0, 0.0}, {0.0, 1.0, 0.0}};
  expect([&] { simulation.add(at, still, radii, {}, materials); }, "particle 1's diameter");
  expect([&] { simulation.add(at, still, radii, {}, std::vector<Material>(3)); }, "3 materials");
  expect([&] { simulation.add_inlet(environment.map().patch("xmin"), 1.0, {}); }, "an inlet's diameter");
}

TEST(Forces, RefusesFieldsThatHaveNoGradientForTerms) {
  const MeshData mesh = box_of(1.0);
  Environment environment(mesh);
  Simulation simulation(environment, with({Force::virtual_mass}, 0.1));
  std::vector<std::vector<Vec3>> values = {std::vector<Vec3>(mesh.cell_count())};
  simulation.set_field(VelocityField(environment.complex(), field_samples({0.0}, values, FieldPlace::cells)));
  EXPECT_THROW(simulation.step(), InvalidArgument);
  simulation.set_field(VelocityField(environment.complex(), std::vector<Vec3>(mesh.points.size()), FieldFrame::mesh));
  EXPECT_THROW(simulation.step(), InvalidArgument);
  simulation.set_field(VelocityField(environment.complex(), std::vector<Vec3>(mesh.points.size())));
  simulation.step();
}

// A law of one's own in place of the library's.
TEST(Laws, AnOwnLawOfDragMovesParticlesAsTheLibrarysDoes) {
  const MeshData mesh = box_of(10.0, 3, 0.3);
  const Material material = {0.01, 2.0, 0.0};
  std::vector<Vec3> places;
  for (const bool own : {false, true}) {
    Environment environment(mesh);
    SimulationOptions o = with({}, 0.02);
    if (!own) o.forces.terms = {Force::stokes};
    o.gravity = gravity;
    Simulation simulation(environment, o);
    simulation.set_field(VelocityField(environment.complex(), swirl_at(mesh, 2.0)));
    int calls = 0;
    if (own) {
      simulation.set_law([&](const LawParticles& p, const LawSamples& u, const LawResult& result) {
        EXPECT_EQ(p.ids.size(), 2U);
        expect_near(u.velocities[0], swirl(p.positions[0], p.time), 1e-10);
        EXPECT_NEAR(u.rates[0].z, -0.5, 1e-10);
        expect_near(u.gradients[0].y, {-1.0, 0.0, 0.0}, 1e-10);
        for (std::size_t i = 0; i < result.rates.size(); ++i)
          result.rates[i] = 18.0 * air.viscosity / (p.densities[i] * p.diameters[i] * p.diameters[i]);
        ++calls;
      });
    }
    simulation.add(std::vector<Vec3>{{5.7, 4.8, 5.9}, {4.0, 5.0, 6.0}}, {}, 0.0, {}, material);
    for (int i = 0; i < 20; ++i) simulation.step();
    EXPECT_EQ(calls, own ? 40 : 0);
    for (const ParticleState& s : simulation.particles().states()) places.push_back(s.position);
  }
  expect_near(places[0], places[2], 1e-13);
  expect_near(places[1], places[3], 1e-13);
}

TEST(Laws, RefusesValuesThatCannotBeUsed) {
  Environment environment(box_of(1.0));
  Simulation simulation(environment, with({}, 0.1));
  simulation.add(std::vector<Vec3>{{0.3, 0.3, 0.3}}, {});
  simulation.set_law([](const LawParticles&, const LawSamples&, const LawResult& r) { r.rates[0] = -1.0; });
  EXPECT_THROW(simulation.step(), InvalidArgument);
  simulation.set_law([](const LawParticles&, const LawSamples&, const LawResult& r) { r.accelerations[0].x = NAN; });
  EXPECT_THROW(simulation.step(), InvalidArgument);
  SimulationOptions o = with({}, 0.1);
  o.drag = 1.0;
  Simulation drags(environment, o);
  EXPECT_THROW(drags.set_law([](const LawParticles&, const LawSamples&, const LawResult&) {}), InvalidArgument);
}

}  // namespace dartcast::forces_test
