// Tools that turn far in a step, among walls that rest or move: they pass no wall, and keep their shape and their distance.
// The truth is the tool on its arc, looked at in small angles.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "dartcast/complex_edit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/scene_file.hpp"
#include "dartcast/simulation.hpp"
#include "simulation/rigid_pose.hpp"
#include "support/meshes.hpp"
#include "support/random_vectors.hpp"
#include "support/shared_data.hpp"
#include "support/tier.hpp"

namespace dartcast::turning_tools_test {

constexpr double pi = 3.14159265358979324;

// --- the truth

struct Block {
  Vec3 low, high;
};

// Whether the segment meets the block, made larger by this much on each side.
bool meets(const Vec3& a, const Vec3& b, const Block& block, double more) {
  const Vec3 way = b - a;
  double enter = 0.0;
  double leave = 1.0;
  for (const auto axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
    const double low = block.low.*axis - more - a.*axis;
    const double high = block.high.*axis + more - a.*axis;
    if (way.*axis == 0.0 && (low > 0.0 || high < 0.0)) return false;
    if (way.*axis == 0.0) continue;
    enter = std::max(enter, std::min(low / (way.*axis), high / (way.*axis)));
    leave = std::min(leave, std::max(low / (way.*axis), high / (way.*axis)));
  }
  return enter <= leave;
}

// By Rodrigues' formula.
Vec3 turned_about(const Vec3& x, const Vec3& pivot, const Vec3& axis, double angle) {
  const Vec3 r = x - pivot;
  return pivot + r * std::cos(angle) + cross(axis, r) * std::sin(angle) +
         axis * (dot(axis, r) * (1.0 - std::cos(angle)));
}

// Half of the separation is left to the arc. It is a length, and blocks are made larger along each axis: sqrt(3) of it.
constexpr double left = 0.28;

// A line that turns in a box among blocks.
struct Turning {
  std::vector<Vec3> points;
  Vec3 pivot, axis;
  Block box;
  std::vector<Block> blocks;

  [[nodiscard]] std::vector<Vec3> at(double angle) const {
    std::vector<Vec3> now;
    for (const Vec3& x : points) now.push_back(turned_about(x, pivot, axis, angle));
    return now;
  }
  // Whether it meets a wall where all walls come nearer by this much.
  [[nodiscard]] bool meets_wall(double angle, double more) const {
    const std::vector<Vec3> now = at(angle);
    for (std::size_t i = 0; i < now.size(); ++i) {
      const Vec3 &x = now[i], to_low = x - box.low, to_high = box.high - x;
      if (std::min({to_low.x, to_low.y, to_low.z, to_high.x, to_high.y, to_high.z}) < more) return true;
      if (i == 0) continue;
      if (std::any_of(blocks.begin(), blocks.end(), [&](const Block& b) { return meets(now[i - 1], x, b, more); }))
        return true;
    }
    return false;
  }
  // The first angle at which it does, in steps; `end`: none below that.
  [[nodiscard]] double first_angle(double step, double end, double more) const {
    for (double angle = 0.0; angle < end; angle += step) {
      if (meets_wall(angle, more)) return angle;
    }
    return end;
  }
};

// --- scenes

// Cells between these coordinates, by x first.
MeshData cells_between(const std::array<std::vector<double>, 3>& at) {
  const auto count = [&](std::size_t axis) { return static_cast<std::uint32_t>(at[axis].size() - 1); };
  MeshData mesh = test::unit_box({count(0), count(1), count(2)});
  const auto place = [&](std::size_t axis, double x) { return at[axis][static_cast<std::size_t>(std::lround(x))]; };
  for (Vec3& p : mesh.points) p = {place(0, p.x), place(1, p.y), place(2, p.z)};
  mesh.free.assign(mesh.cell_count(), 1);
  return mesh;
}

Block bounds_of(const MeshData& mesh, std::size_t cell) {
  Block b = {mesh.points[mesh.cell(cell)[0]], mesh.points[mesh.cell(cell)[0]]};
  for (const std::uint32_t v : mesh.cell(cell)) {
    const Vec3& p = mesh.points[v];
    b.low = {std::min(b.low.x, p.x), std::min(b.low.y, p.y), std::min(b.low.z, p.z)};
    b.high = {std::max(b.high.x, p.x), std::max(b.high.y, p.y), std::max(b.high.z, p.z)};
  }
  return b;
}

// The line turns by an angle about an axis in each step of a second.
Scene scene_of(const MeshData& mesh, const Turning& line, double angle) {
  Scene scene;
  scene.environment.mesh = mesh;
  scene.motion.dt = 1.0;
  SolidScene tool;
  tool.name = "tool";
  tool.shape = line.points;
  tool.pivot = line.pivot;
  tool.moves = {{1e6, {}, line.axis * angle}};
  scene.solids = {tool};
  return scene;
}

double longest_side(const std::vector<Vec3>& points) {
  double longest = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) longest = std::max(longest, norm(points[i] - points[i - 1]));
  return longest;
}

// The tool is where its pose at this angle has it, to rounding.
void expect_at(const Simulation& simulation, const Turning& line, double angle) {
  const std::vector<Vec3> pose = line.at(angle);
  const auto now = simulation.solids()->positions();
  for (std::size_t v = 0; v < pose.size(); ++v) EXPECT_LT(norm(now[v] - pose[v]), 1e-12) << v;
  for (std::size_t v = 1; v < pose.size(); ++v)
    EXPECT_NEAR(norm(now[v] - now[v - 1]), norm(line.points[v] - line.points[v - 1]), 1e-14);
}

// A rod of length 1 in the plane z = 0, and a peg that reaches 0.008 into its circle.
struct PegScene {
  Turning line;
  MeshData mesh = cells_between({{{-2.0, 0.992, 1.1, 2.0}, {-2.0, -0.002, 0.002, 2.0}, {-1.0, -0.3, 0.3, 1.0}}});

  explicit PegScene(double start) {
    line.points = {{0.0, 0.0, 0.0}, {std::cos(start), std::sin(start), 0.0}};
    line.axis = {0.0, 0.0, 1.0};
    mesh.free[13] = 0;
    line.blocks = {bounds_of(mesh, 13)};
    line.box = {{-2.0, -2.0, -1.0}, {2.0, 2.0, 1.0}};
  }
};

// The angle at which the rod is as near to an edge of the peg as it may come: 2^-10 of its length.
double stop_angle(double y_of_edge) {
  const double side = y_of_edge < 0.0 ? 1.0 : -1.0;
  return std::atan2(y_of_edge, 0.992) - side * std::asin(0x1p-10 / std::hypot(0.992, y_of_edge));
}

double angle_of(const Simulation& simulation) {
  const Vec3 tip = simulation.solids()->positions()[1];
  return std::atan2(tip.y, tip.x);
}

// --- walls at rest

TEST(TurningTools, ATipStopsAtAPegWithinItsArc) {
  const PegScene scene(-1.05);
  Simulation simulation(scene_of(scene.mesh, scene.line, 0.3), Threads{1});
  double angle = 0.0;
  for (int s = 0; s < 8; ++s) {
    simulation.step();
    angle += 0.3 * simulation.solids_step().made[0];
    expect_at(simulation, scene.line, angle);
    EXPECT_EQ(simulation.audit().failed, 0U) << simulation.audit().first;
  }
  EXPECT_NEAR(angle_of(simulation), stop_angle(-0.002), 1e-6);
}

// Its chord is of length 0.
TEST(TurningTools, AWholeTurnInAStepMeetsThePeg) {
  const PegScene scene(0.1);
  for (const double turns : {1.0, -2.0, 3.7}) {
    Simulation simulation(scene_of(scene.mesh, scene.line, 2.0 * pi * turns), Threads{1});
    const double contact = stop_angle(turns > 0.0 ? -0.002 : 0.002);
    simulation.step();
    ASSERT_EQ(simulation.solids_step().contacts.size(), 1U);
    const SolidContact& c = simulation.solids_step().contacts[0];
    const double way = turns > 0.0 ? 2.0 * pi + contact - 0.1 : contact - 0.1;
    EXPECT_NEAR(c.time_of_impact, way / (2.0 * pi * turns), 0x1p-11 / 0.992 / (2.0 * pi * std::abs(turns)));
    EXPECT_NEAR(c.normal.y, turns > 0.0 ? -1.0 : 1.0, 1e-5);
    EXPECT_NEAR(c.wall_point.x, 0.996, 0.0041);
    for (int s = 0; s < 8; ++s) simulation.step();
    EXPECT_NEAR(angle_of(simulation), contact, 1e-6);
    EXPECT_NEAR(simulation.solids_step().contacts.at(0).gap, 0x1p-10, 1e-6);
    EXPECT_EQ(simulation.audit().failed, 0U);
  }
}

// A rod whose tip is nearer to a wall than that at the start, and again after each turn.
TEST(TurningTools, KeepTheDistanceThatTheyHave) {
  for (const double gap : {1e-5, 1e-8}) {
    Turning line;
    line.points = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
    line.axis = {0.0, 0.0, 1.0};
    const MeshData mesh = cells_between({{{-2.0, 1.0 + gap}, {-2.0, 2.0}, {-1.0, 1.0}}});
    Simulation simulation(scene_of(mesh, line, 2.0 * pi), Threads{1});
    simulation.step();
    EXPECT_EQ(simulation.solids_step().made[0], 1.0) << gap;
    expect_at(simulation, line, 2.0 * pi);
    const MeshData smaller = cells_between({{{-2.0, 1.0 + gap}, {-2.0, 1.0 + 0.5 * gap}, {-1.0, 1.0}}});
    Simulation stops(scene_of(smaller, line, 2.0 * pi), Threads{1});
    stops.step();
    EXPECT_LT(stops.solids_step().made[0], 0.25) << gap;
    EXPECT_EQ(stops.solids_step().contacts.size(), 1U);
  }
}

TEST(TurningTools, TheirWayStaysNearTheArc) {
  Random random(3);
  const int cases = std::max(12, test::scaled(60, 1000));
  int stopped = 0;
  for (int k = 0; k < cases; ++k) {
    MeshData mesh = test::cubes(5);
    mesh.free.assign(mesh.cell_count(), 1);
    Turning line;
    line.box = {{}, {5.0, 5.0, 5.0}};
    line.pivot = Vec3{2.5, 2.5, 2.5} + test::random_vector(random, 0.4);
    line.axis = test::random_vector(random, 1.0);
    line.axis = line.axis * (1.0 / norm(line.axis));
    line.points = {line.pivot + test::random_vector(random, 1.0), line.pivot + test::random_vector(random, 1.5)};
    if (k % 2 == 0) line.points.push_back(line.points.back() + test::random_vector(random, 0.3));
    double arm = 0.0;
    for (const Vec3& x : line.points) arm = std::max(arm, norm(x - line.pivot));
    for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
      if (random.uniform() > 0.12) continue;
      mesh.free[c] = 0;
      const Block block = bounds_of(mesh, c);
      if (norm((block.low + block.high) * 0.5 - line.pivot) < arm + 1.0) line.blocks.push_back(block);
    }
    const double separation = 0x1p-10 * longest_side(line.points);
    if (line.meets_wall(0.0, 3.0 * separation)) continue;
    const double angle = 0.01 * std::pow(400.0 * pi, random.uniform());
    Simulation simulation(scene_of(mesh, line, angle), Threads{1});
    const int steps = static_cast<int>(2.0 * pi / angle) + 14;
    double made = 0.0;
    for (int s = 0; s < steps; ++s) {
      simulation.step();
      made += angle * simulation.solids_step().made[0];
      if (s > 14 && simulation.solids_step().made[0] == 0.0) break;
    }
    expect_at(simulation, line, made);
    EXPECT_EQ(simulation.audit().failed, 0U) << k;
    const double end = std::min(angle * steps, 6.3);  // later turns repeat the first
    constexpr double small = 4e-4;
    EXPECT_GE(line.first_angle(small, std::min(made, end), left * separation), std::min(made, end)) << k;
    const double first = line.first_angle(small, end, 2.0 * separation);
    EXPECT_GE(made, first - 2.0 * small) << k << ": it stops where there is no wall";
    stopped += made < end ? 1 : 0;
  }
  EXPECT_GT(stopped, cases / 6);
}

// --- limits

// It presses on the peg, however far its move has gone on, and goes on from there when the peg is gone.
TEST(TurningTools, CatchUpWithAtMostAHalfTurn) {
  const PegScene scene(-1.05);
  Scene catches_up = scene_of(scene.mesh, scene.line, 0.3);
  catches_up.solids[0].catch_up = true;
  catches_up.solids[0].moves = {{40.0, {}, {0.0, 0.0, 0.3}}, {60.0, {}, {0.0, 0.0, -0.3}}};
  const double contact = stop_angle(-0.002);
  for (const bool opens : {false, true}) {
    Simulation simulation(catches_up, Threads{1});
    for (int s = 0; s < 40; ++s) {
      simulation.step();
      if (s > 10) EXPECT_NEAR(angle_of(simulation), contact, 1e-9) << s;
    }
    if (opens) {
      Cell peg;
      for (const Cell c : simulation.environment().map().cells()) {
        if (simulation.environment().map().source(c) == 13) peg = c;
      }
      simulation.edit([&](ComplexEdit& e) { e.topology().set_free(peg, true); });
      simulation.step();
      EXPECT_NEAR(angle_of(simulation), contact + 3.125 - 0.3, 1e-6);
      continue;
    }
    for (int s = 0; s < 10; ++s) simulation.step();  // takes back 3 of the 3.125
    EXPECT_NEAR(angle_of(simulation), contact, 1e-9);
    for (int s = 0; s < 10; ++s) simulation.step();
    EXPECT_NEAR(angle_of(simulation), contact + 3.125 - 20 * 0.3, 1e-6);
    EXPECT_EQ(simulation.audit().failed, 0U);
  }
}

TEST(TurningTools, TooManySlicesAreRefused) {
  const PegScene scene(-1.05);
  try {
    Simulation simulation(scene_of(scene.mesh, scene.line, 6000.0), Threads{1});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(
        std::string(e.what()),
        "solid \"tool\": its move 1 turns it by 6000 rad in a step, which takes 96000 slices; 65536 is the limit: "
        "make dt smaller, or turn more slowly");
  }
  Scene point = scene_of(scene.mesh, scene.line, 1e9);
  point.solids[0].shape = std::vector<Vec3>{{0.0, 0.0, 0.0}};  // at the pivot: it needs no slices
  Simulation simulation(point, Threads{1});
  simulation.step();
  EXPECT_EQ(simulation.solids_step().made[0], 1.0);
}

// --- walls that move

// Displacements of the planes of a lattice: its cells stay blocks.
std::vector<Vec3> displaced_planes(const MeshData& mesh, Random& random) {
  std::array<std::array<double, 6>, 3> by{};
  for (auto& axis : by) {
    for (double& x : axis) x = random.uniform(-0.35, 0.35);
  }
  std::vector<Vec3> displacement;
  const auto plane = [](double x) { return static_cast<std::size_t>(std::lround(x)); };
  for (const Vec3& p : mesh.points) displacement.push_back({by[0][plane(p.x)], by[1][plane(p.y)], by[2][plane(p.z)]});
  return displacement;
}

struct AmongMovingWalls {
  MeshData mesh = test::cubes(5);
  std::vector<std::size_t> blocked;
  std::vector<Vec3> displacement;
  Turning line;
  double angle = 0.0;

  explicit AmongMovingWalls(Random& random) {
    mesh.free.assign(mesh.cell_count(), 1);
    line.pivot = Vec3{2.5, 2.5, 2.5} + test::random_vector(random, 0.4);
    line.axis = test::random_vector(random, 1.0);
    line.axis = line.axis * (1.0 / norm(line.axis));
    line.points = {line.pivot + test::random_vector(random, 0.5), line.pivot + test::random_vector(random, 1.4)};
    for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
      if (random.uniform() > 0.1) continue;
      mesh.free[c] = 0;
      blocked.push_back(c);
    }
    displacement = displaced_planes(mesh, random);
    angle = 0.02 * std::pow(200.0 * pi, random.uniform());
    set_walls(mesh.points, mesh.points, 0.0);
  }

  // The walls on the way between two places of the vertices.
  void set_walls(std::span<const Vec3> from, std::span<const Vec3> to, double share) {
    for (std::size_t p = 0; p < from.size(); ++p) mesh.points[p] = from[p] + (to[p] - from[p]) * share;
    line.blocks.clear();
    for (const std::size_t c : blocked) line.blocks.push_back(bounds_of(mesh, c));
    line.box = {mesh.points.front(), mesh.points.back()};
  }
};

TEST(TurningTools, TheirWayStaysNearTheArcAmongWallsThatMove) {
  Random random(6);
  int stopped = 0;
  int walls_stopped = 0;
  int turned_far = 0;
  for (int k = 0; k < std::max(12, test::scaled(60, 1000)); ++k) {
    AmongMovingWalls scene(random);
    const double separation = 0x1p-10 * longest_side(scene.line.points);
    if (scene.line.meets_wall(0.0, 2.0 * separation)) continue;
    Scene moving = scene_of(scene.mesh, scene.line, scene.angle);
    moving.solids[0].catch_up = k % 3 == 0;
    ParticlesScene particles;
    particles.source = RandomParticles{20};
    particles.velocity = {0.3, 0.1, -0.2};
    moving.particles = {particles};
    Simulation simulation(moving, Threads{1});
    simulation.pull(scene.displacement, 12.0);
    double made = 0.0;
    for (int s = 0; s < 12; ++s) {
      const std::vector<Vec3> before(simulation.environment().positions().begin(),
                                     simulation.environment().positions().end());
      simulation.step();
      const SolidStep& step = simulation.solids_step();
      const bool whole = step.made[0] == 1.0 && step.walls_made == 1.0;
      for (double t = 0.0; whole && k % 3 != 0 && t <= 1.0; t += 0x1p-6) {
        scene.set_walls(before, simulation.environment().positions(), t);
        EXPECT_FALSE(scene.line.meets_wall(made + scene.angle * t, left * separation)) << k << " " << s << " " << t;
      }
      made += scene.angle * step.made[0];
      if (k % 3 != 0) expect_at(simulation, scene.line, made);
      const auto now = simulation.solids()->positions();
      EXPECT_NEAR(norm(now[1] - now[0]), norm(scene.line.points[1] - scene.line.points[0]), 1e-14);
      ASSERT_EQ(simulation.audit().failed, 0U) << k << " " << s << " " << simulation.audit().first;
      stopped += step.made[0] < 1.0 && step.walls_made == 1.0 ? 1 : 0;
      walls_stopped += step.walls_made < 1.0 ? 1 : 0;
      turned_far += whole && scene.angle > 1.0 ? 1 : 0;
    }
  }
  EXPECT_GT(stopped, test::sanitized() ? 0 : 10);
  EXPECT_GT(walls_stopped, test::sanitized() ? 0 : 10);
  EXPECT_GT(turned_far, test::sanitized() ? 0 : 10);
}

// A point goes around a block: the straight way from place to place is not free.
TEST(TurningTools, GoAroundABlock) {
  Random random(9);
  AmongMovingWalls scene(random);
  std::fill(scene.mesh.free.begin(), scene.mesh.free.end(), std::uint8_t{1});
  scene.mesh.free[62] = 0;  // from 2 to 3 along each axis
  scene.line.pivot = {2.5, 2.5, 2.5};
  scene.line.points = {{3.5, 2.5, 2.5}};
  scene.line.axis = {0.0, 0.0, 1.0};
  for (const bool moves : {false, true}) {
    Simulation simulation(scene_of(scene.mesh, scene.line, 3.0), Threads{1});
    if (moves) simulation.pull(std::vector<Vec3>(scene.mesh.points.size(), {0.3, 0.1, 0.0}), 20.0);
    for (int s = 1; s <= 10; ++s) {
      simulation.step();
      EXPECT_EQ(simulation.solids_step().made[0], 1.0) << s;
      expect_at(simulation, scene.line, 3.0 * s);
      EXPECT_EQ(simulation.audit().failed, 0U) << simulation.audit().first;
    }
  }
}

// A stuck tool is carried along, the other turns; threads do not matter, and the run goes on from a checkpoint.
TEST(TurningTools, GoOnFromACheckpoint) {
  Random random(8);
  AmongMovingWalls scene(random);
  scene.line.points = {{2.5, 2.5, 2.5}, {3.6, 2.5, 2.5}};
  scene.line.pivot = scene.line.points[0];
  scene.line.axis = {0.0, 0.0, 1.0};
  std::fill(scene.mesh.free.begin(), scene.mesh.free.end(), std::uint8_t{1});
  scene.mesh.free[67] = 0;  // from 2 to 3 along x and z, from 3 to 4 along y
  Scene two = scene_of(scene.mesh, scene.line, 3.0);
  two.solids.push_back(two.solids[0]);
  two.solids[1].name = "stuck";
  two.solids[1].shape = std::vector<Vec3>{{0.5, 0.5, 0.5}, {0.5, 1.5, 0.5}};
  ParticlesScene particles;
  particles.source = RandomParticles{50};
  particles.velocity = {0.3, 0.1, -0.2};
  two.particles = {particles};
  const auto start = [&](unsigned threads) {
    auto simulation = std::make_unique<Simulation>(two, Threads{threads});
    simulation->pull(scene.displacement, 10.0);
    simulation->edit([&](ComplexEdit& e) {
      for (const Cell c : simulation->environment().map().cells()) {
        if (simulation->environment().map().source(c) == 5) e.topology().set_free(c, false);
      }
    });
    EXPECT_TRUE(simulation->solid_summaries()[1].stuck);
    return simulation;
  };
  const auto one = start(1);
  const auto three = start(3);
  for (int s = 0; s < 8; ++s) {
    one->step();
    three->step();
    ASSERT_EQ(one->state_hash(), three->state_hash()) << s;
    EXPECT_EQ(one->audit().failed, 0U) << one->audit().first;
    const SimulationCheckpoint saved = one->checkpoint();
    one->step();
    const StateHash next = one->state_hash();
    one->restore(saved);
    one->step();
    EXPECT_EQ(one->state_hash(), next) << s;
    one->restore(saved);
  }
  EXPECT_GT(one->solid_summaries()[0].contacts, 0U);
}

// --- inputs on which an earlier version failed

TEST(TurningTools, StopAsTheirFilesSay) {
  NEED_DATA("tools that turn");
  const auto at_end = [](const char* name, int steps) {
    const auto folder = test::data_folder() / "regressions" / "turn3" / "spinning_rod";
    Simulation simulation(load_scene_files(read_scene(folder / name)).scene, Threads{1});
    const auto length = [&] { return norm(simulation.solids()->positions()[1] - simulation.solids()->positions()[0]); };
    const double at_start = length();
    for (int s = 0; s < steps; ++s) simulation.step();
    EXPECT_NEAR(length(), at_start, 1e-15);
    return angle_of(simulation);
  };
  EXPECT_NEAR(at_end("tip.toml", 8), stop_angle(-0.002), 1e-5);
  const double edge = std::hypot(0.75, 0.05);  // of its peg, below the rod
  EXPECT_NEAR(at_end("full.toml", 60), std::atan2(-0.05, 0.75) - std::asin(0x1p-10 / edge), 1e-5);
}

}  // namespace dartcast::turning_tools_test
