// Sums of simulations by cell, beside lengths and times: the loss to drag against balances of momentum and energy,
// ages and user data against closed forms; by class, by interval, on any ranks.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/scene_file.hpp"
#include "dartcast/simulation.hpp"
#include "dartcast/statistics.hpp"
#include "support/expectations.hpp"
#include "support/thread_ranks.hpp"

namespace dartcast::test::tallied_drag_test {

constexpr Vec3 gravity = {0.3, 0.0, -9.81};

MeshData box(double edge) {
  BoxOptions options;
  options.cells = {4, 4, 4};
  options.size = {edge, edge, edge};
  return generate_box(options);
}

StatisticsOptions cells(std::vector<std::string> quantities) {
  StatisticsOptions options;
  options.cells = std::move(quantities);
  return options;
}

double mass_of(const Simulation& s, std::size_t i) {
  const double d = s.diameters()[i];
  return std::numbers::pi / 6.0 * s.densities()[i] * d * d * d;
}

Vec3 momentum_of(const Simulation& s) {
  Vec3 sum;
  for (std::size_t i = 0; i < s.particles().size(); ++i) sum += s.velocities()[i] * mass_of(s, i);
  return sum;
}

double energy_of(const Simulation& s) {  // and that of gravity
  double sum = 0.0;
  for (std::size_t i = 0; i < s.particles().size(); ++i)
    sum += mass_of(s, i) * (0.5 * dot(s.velocities()[i], s.velocities()[i]) - dot(gravity, s.particles()[i].position));
  return sum;
}

const DataArray& array(const std::vector<DataArray>& arrays, const std::string& name) {
  const auto found = std::find_if(arrays.begin(), arrays.end(), [&](const DataArray& a) { return a.name == name; });
  if (found == arrays.end()) throw std::runtime_error("there is no array " + name);
  return *found;
}

std::vector<DataArray> arrays_of(const Simulation& s) { return s.cell_arrays(s.cell_tally().value()); }

double sum_of(const DataArray& a, std::size_t component = 0) {
  double sum = 0.0;
  for (std::size_t i = component; i < a.values.size(); i += a.components) sum += a.values[i];
  return sum;
}

// Far from walls: gravity's momentum and work are what particles gain, and what they lose to drag.
TEST(TalliedDrag, BalancesMomentumAndEnergy) {
  for (const bool constant : {true, false}) {
    Environment environment(box(400.0), Threads{2});
    SimulationOptions o;
    o.dt = 0.05;
    o.gravity = gravity;
    if (constant) {
      o.drag = 2.0;
      o.substeps = 2;
    } else {
      o.forces.terms = {Force::schiller_naumann, Force::lorentz};
      o.forces.fluid = {1.2, 1.8e-5, 0.0};
      o.forces.magnetic_field = {0.0, 2.0, 1.0};
    }
    Simulation s(environment, o);
    s.set_statistics(cells({"momentum", "energy", "visits"}));
    std::vector<Vec3> at;
    for (int i = 0; i < 60; ++i) at.push_back({195.0 + 0.2 * i, 190.0 + 0.31 * i, 200.0 + 0.17 * i});
    s.add(at, {30.0, -20.0, 10.0}, 0.0, {}, {2e-3, 800.0, constant ? 0.0 : 0.5});
    const double mass = 60.0 * mass_of(s, 0);
    const Vec3 momentum = momentum_of(s);
    const double energy = energy_of(s);
    for (int step = 0; step < 20; ++step) s.step();
    const std::vector<DataArray> arrays = arrays_of(s);
    EXPECT_TRUE(s.cell_tally()->adds_up());
    EXPECT_GT(sum_of(array(arrays, "visits")), 30.0);
    const Vec3 gain = momentum_of(s) - momentum;
    const Vec3 lost = {sum_of(array(arrays, "momentum"), 0), sum_of(array(arrays, "momentum"), 1),
                       sum_of(array(arrays, "momentum"), 2)};
    if (constant) {
      const Vec3 expected = gravity * (mass * s.time()) - gain;
      EXPECT_NEAR(norm(lost - expected), 0.0, 1e-12 * norm(gain));
    } else {  // along the magnetic field nothing turns
      const Vec3 along = {0.0, 2.0, 1.0};
      EXPECT_NEAR(dot(lost, along), dot(gravity * (mass * s.time()) - gain, along), 1e-11 * norm(gain));
    }
    EXPECT_NEAR(sum_of(array(arrays, "energy")), energy - energy_of(s), 1e-11 * std::abs(energy));
    EXPECT_GT(sum_of(array(arrays, "energy")), 0.0);
  }
}

// Drops that fall steadily give their weight to the air, in each cell for the time there; some of the air goes along.
TEST(TalliedDrag, OfSteadyFallIsTheWeight) {
  for (const bool added : {false, true}) {
    Environment environment(box(16.0), Threads{1});
    SimulationOptions o;
    o.dt = 0.25;
    o.gravity = {0.0, 0.0, -9.81};
    o.forces.terms = {Force::stokes};
    if (added) o.forces.terms.push_back(Force::virtual_mass);
    o.forces.fluid = {100.0, 1e-3, 0.0};
    o.user_data = {"number"};
    Simulation s(environment, o);
    s.set_field(
        VectorField(environment.complex(),
                    field_samples({0.0}, {std::vector<Vec3>(environment.positions().size())}, FieldPlace::points)));
    s.set_statistics(cells({"momentum", "energy", "residence", "momentum_source", "energy_source"}));
    const double d = 1e-3;
    const double speed = 9.81 * 800.0 * d * d / (18.0 * 1e-3);
    const std::vector<double> number = {7.0};
    s.add(std::vector<Vec3>{{3.0, 3.0, 15.0}, {9.0, 11.0, 14.0}}, {0.0, 0.0, -speed}, 0.0, number, {d, 800.0, 0.0});
    for (int step = 0; step < 40; ++step) s.step();
    const std::vector<DataArray> arrays = arrays_of(s);
    const double weight = 7.0 * mass_of(s, 0) * 9.81;
    const double volume = 4.0 * 4.0 * 4.0;
    std::size_t used = 0;
    for (std::size_t c = 0; c < environment.map().cell_count(); ++c) {
      const double time = array(arrays, "residence").values[c] / 7.0;
      if (time > 0.0) ++used;
      const double momentum = array(arrays, "momentum").values[3 * c + 2];
      EXPECT_NEAR(momentum, -weight * time, 1e-9 * weight);
      EXPECT_NEAR(array(arrays, "energy").values[c], weight * speed * time, 1e-9 * weight * speed);
      EXPECT_NEAR(array(arrays, "momentum_source").values[3 * c + 2], momentum / (volume * 10.0), 1e-12 * weight);
      EXPECT_NEAR(array(arrays, "energy_source").values[c], weight * speed * time / (volume * 10.0),
                  1e-9 * weight * speed);
      EXPECT_NEAR(array(arrays, "momentum").values[3 * c], 0.0, 1e-14 * weight);
    }
    EXPECT_EQ(used, 4U);
  }
}

// A plug flow: the age at x is x / v. The integral of user data that do not change is the time times these.
TEST(TalliedAges, OfAPlugFlow) {
  BoxOptions pipe;
  pipe.cells = {8, 1, 1};
  pipe.size = {8.0, 1.0, 1.0};
  Environment environment(generate_box(pipe), Threads{1});
  SimulationOptions o;
  o.dt = 0.0625;
  o.response = Escape{};
  o.user_data = {"a", "w"};
  Simulation s(environment, o);
  s.set_statistics(cells({"mean_age", "residence", "user:w"}));
  const std::vector<double> data = {0.0, -2.5};
  s.add_inlet(environment.map().patch("xmin"), 100.0, {0.5, 0.0, 0.0}, 0.0, data);
  for (int step = 0; step < 400; ++step) s.step();
  const std::vector<DataArray> arrays = arrays_of(s);
  for (std::size_t c = 0; c < 8; ++c) {
    EXPECT_NEAR(array(arrays, "mean_age").values[c], 2.0 * (double(c) + 0.5), 0.07) << c;
    EXPECT_NEAR(array(arrays, "user:w").values[c], -2.5 * array(arrays, "residence").values[c], 1e-9);
  }
  EXPECT_GT(s.totals().escaped, 500U);
  EXPECT_TRUE(s.cell_tally()->adds_up());
  // The age, the user data: what was taken back from those that left is that of the time.
  EXPECT_NEAR(sum_of(array(arrays, "user:w")), -2.5 * sum_of(array(arrays, "residence")), 1e-9);
}

// Laminar flow in a round pipe, whose particles are drawn by their flux: E(t) = t_mean^2 / (2 t^3) from t_mean / 2 on.
TEST(TalliedAges, AreThoseOfALaminarPipe) {
  BoxOptions pipe;
  pipe.cells = {8, 1, 1};
  pipe.size = {8.0, 1.0, 1.0};
  Environment environment(generate_box(pipe), Threads{2});
  SimulationOptions o;
  o.dt = 0.0625;
  o.response = Escape{};
  Simulation s(environment, o);
  StatisticsOptions options;
  options.residence = true;
  s.set_statistics(options);
  constexpr std::size_t count = 2000;
  constexpr double mean = 7.5;  // of a way of 7.5 m, at 1 m/s on average
  std::vector<Vec3> velocities;
  for (std::size_t i = 0; i < count; ++i)
    velocities.push_back({2.0 * std::sqrt(1.0 - (double(i) + 0.5) / count), 0.0, 0.0});
  s.add(std::vector<Vec3>(count, {0.5, 0.5, 0.5}), velocities, std::vector<double>(count, 0.0));
  while (s.time() < 32.0) s.step();
  const ResidenceTimes& times = s.statistics().left[environment.map().patch("xmax").value].escaped;
  const auto share = [&](double t) { return t <= 0.5 * mean ? 0.0 : 1.0 - mean * mean / (4.0 * t * t); };
  EXPECT_EQ(times.bin, 0.5);
  EXPECT_NEAR(double(times.count), count * share(32.0), 2.0);
  for (std::size_t i = 0; i < ResidenceTimes::bin_count; ++i) {
    const double begin = double(i) * times.bin;
    EXPECT_NEAR(double(times.bins[i]), count * (share(begin + times.bin) - share(begin)), 2.0) << i;
    EXPECT_NEAR(times.washout(i), (share(32.0) - share(begin)) / share(32.0), 2e-3);
  }
  EXPECT_EQ(ResidenceTimes().washout(0), 0.0);
}

// A box that pulses, and is sealed: what is in it stays in it.
TEST(TalliedAges, OfASealedPulsingBoxAreThoseOfAll) {
  Environment environment(box(4.0), Threads{2});
  SimulationOptions o;
  o.dt = 0.05;
  Simulation s(environment, o);
  s.set_statistics(cells({"residence", "concentration", "mean_age"}));
  s.add_random(500, {3.0, 2.0, -1.0});
  const std::vector<Vec3> rest(environment.positions().begin(), environment.positions().end());
  for (int pulse = 0; pulse < 4; ++pulse) {
    std::vector<Vec3> way;
    for (const Vec3& x : rest) way.push_back((x - Vec3{2.0, 2.0, 2.0}) * (pulse % 2 == 0 ? -0.25 : 0.25));
    s.pull(way, 0.5);
    for (int step = 0; step < 10; ++step) s.step();
  }
  EXPECT_EQ(s.particles().size(), 500U);
  const CellTally tally = s.cell_tally().value();
  EXPECT_TRUE(tally.adds_up());
  EXPECT_EQ(tally.age(), 500.0 * 40.0);
  EXPECT_NEAR(tally.whole_amount(0), 500.0 * 40.0 * 1.0, 1e-9);            // the mean age is half the time
  EXPECT_NEAR(sum_of(array(arrays_of(s), "concentration")), 500.0, 1e-9);  // cells of 1 m^3
}

std::string scene_text(const std::string& classes, const std::string& group_2 = "") {
  return R"(
[environment]
generator = "box"
cells = [3, 3, 3]
size = [3.0, 3.0, 3.0]
[motion]
dt = 0.05
steps = 24
drag = 0.5
gravity = [0.0, 0.0, -1.0]
[[particles]]
count = 40
velocity = [1.0, 2.0, 0.5]
diameter = 1e-3
density = 1000
[[particles]]
count = 30
velocity = [-1.0, 1.0, 0.5]
diameter = 2e-3
density = 1000
number = 3
)" + group_2 +
         R"(
[contact.patch.zmin]
response = "absorb"
[statistics]
)" + classes +
         R"(
cells = { quantities = ["track_length", "residence", "visits", "deposition", "momentum", "mean_age"], every = 8 }
)";
}

Scene scene_of(const std::string& text) { return parse_scene(text, "."); }

// Both kinds of classes distinguish the groups, and each has what the tally of the group alone has.
TEST(TalliedClasses, AreThoseOfTheGroupAlone) {
  std::vector<std::vector<std::uint64_t>> words;
  for (const std::string classes : {"classes = { of = 'group' }", "classes = { of = 'diameter', bounds = [1.5e-3] }"}) {
    Simulation s(scene_of(scene_text(classes)), Threads{2});
    while (s.steps() < 24) s.step();
    EXPECT_GT(s.totals().absorbed, 5U);
    words.push_back(s.cell_tally()->words());
    const std::string name = classes.find("group") != std::string::npos ? "group" : "diameter";
    const std::vector<DataArray> arrays = arrays_of(s);
    ASSERT_EQ(arrays.size(), 18U);
    for (const char* quantity : {"track_length", "residence", "visits", "deposition", "momentum"}) {
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(sum_of(array(arrays, quantity), k % array(arrays, quantity).components),
                    sum_of(array(arrays, quantity + ("_" + name + "_0")), k % array(arrays, quantity).components) +
                        sum_of(array(arrays, quantity + ("_" + name + "_1")), k % array(arrays, quantity).components),
                    1e-9);
    }
    EXPECT_GT(sum_of(array(arrays, "residence_" + name + "_0")), 1.0);
  }
  EXPECT_EQ(words[0], words[1]);
  // The first group alone has ids of its own, and so the same places.
  Scene alone = scene_of(scene_text(""));
  alone.particles.pop_back();
  Simulation one(alone);
  while (one.steps() < 24) one.step();
  Simulation both(scene_of(scene_text("classes = { of = 'group' }")));
  while (both.steps() < 24) both.step();
  const CellTally a = one.cell_tally().value();
  const CellTally b = both.cell_tally().value();
  for (const Cell c : one.environment().map().cells()) {
    EXPECT_EQ(a.track_length(c), b.track_length(c, 0));
    EXPECT_EQ(a.residence(c), b.residence(c, 0));
    EXPECT_EQ(a.deposited(c), b.deposited(c, 0));
    EXPECT_EQ(a.amount(c, 2), b.amount(c, 2, 0));
  }
}

// Sums of an interval are those of a run that begins with it. Checkpoints inside it, threads and ranks change no bit.
TEST(TalliedIntervals, BeginAnewAndGoOn) {
  const Scene scene = scene_of(scene_text("classes = { of = 'group' }"));
  Simulation whole(scene);
  Simulation resumed(scene);
  std::vector<std::vector<std::uint64_t>> words;
  while (whole.steps() < 21) {
    whole.step();
    words.push_back(whole.cell_tally()->words());
    EXPECT_EQ(whole.cell_tally()->age() > 131.0, whole.steps() % 8 != 1);
    if (whole.steps() == 12) {
      resumed.restore(whole.checkpoint());
      EXPECT_EQ(resumed.cell_tally()->words(), words.back());
    }
  }
  while (resumed.steps() < 21) resumed.step();
  EXPECT_EQ(resumed.cell_tally()->words(), words.back());
  EXPECT_TRUE(whole.cell_tally()->adds_up());
  on_ranks(3, [&](Ranks& ranks) {
    Simulation shared(scene, Threads{1}, &ranks);
    for (const std::vector<std::uint64_t>& expected : words) {
      shared.step();
      const CellTally all = shared.cell_tally().value();
      EXPECT_EQ(all.words(), expected);
    }
  });
}

TEST(TalliedClasses, AreRefusedWithAReason) {
  Environment environment(box(1.0), Threads{1});
  SimulationOptions o;
  o.user_data = {"width"};
  Simulation s(environment, o);
  const auto refused = [&](const std::function<void(StatisticsOptions&)>& change) {
    StatisticsOptions options = cells({"visits"});
    change(options);
    return refusal([&] { s.set_statistics(options); });
  };
  expect_parts(refused([](auto& x) { x.cells = {"user:widht"}; }), {"no user data \"widht\"", "did you mean"});
  expect_parts(refused([](auto& x) { x.classes_of = "radius"; }), {"no user data \"radius\""});
  expect_parts(refused([](auto& x) { x.class_bounds = {1.0}; }), {"bounds", "which value"});
  expect_parts(refused([](auto& x) { x.classes_of = "width", x.class_bounds = {1.0, 1.0}; }), {"increase"});
  expect_parts(refused([](auto& x) { x.classes_of = "width", x.class_bounds.assign(300, 0.0); }), {"at most 255"});
  expect_parts(refused([](auto& x) { x.cells.clear(), x.cells_every = 3; }), {"cells"});
  EXPECT_FALSE(s.cell_tally().has_value());
  try {
    (void)parse_scene(scene_text("classes = { of = 'diameter' }"), ".");
    ADD_FAILURE() << "it was taken";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("give bounds"), std::string::npos) << e.what();
  }
}

}  // namespace dartcast::test::tallied_drag_test
