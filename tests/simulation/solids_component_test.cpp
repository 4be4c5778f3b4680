// Rigid tools of a scene: they move by their moves, stop at walls, stop walls, and go on from a checkpoint.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "dartcast/cell_complex.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "simulation/rigid_pose.hpp"
#include "simulation/simulation_state.hpp"
#include "solids/joint_move.hpp"
#include "support/meshes.hpp"
#include "support/random_vectors.hpp"
#include "support/solid_scenes.hpp"

namespace dartcast::solids_component_test {

// The boundary of a box as a surface.
MeshData block(const Vec3& size) {
  BoxOptions box;
  box.cells = {1, 1, 1};
  box.size = {size.x, size.y, size.z};
  const SolidMesh solid = solid_of_cells(generate_box(box));
  MeshData surface;
  surface.points = solid.points;
  for (const auto& t : solid.triangles) surface.add_cell(CellType::triangle, t);
  return surface;
}

Scene scene_with(const SolidScene& solid) {
  Scene scene;
  scene.environment.mesh = test::cubes(4);
  scene.motion.dt = 0.01;
  scene.solids = {solid};
  return scene;
}

DeformationScene pulse(double amplitude) {
  DeformationScene deformation;
  deformation.step.kind = DeformationKind::bump;
  deformation.step.amplitude = amplitude;
  deformation.step.period = 0.4;
  deformation.step.axis = {0.0, 0.0, 1.0};
  deformation.step.centre = {2.0, 2.0, 0.0};
  deformation.step.length = 1.5;
  return deformation;
}

TEST(RigidPose, TurnsAndGoesOnArcs) {
  const double quarter = 1.57079632679489662;
  const Quaternion q = rotation_of({0.0, 0.0, quarter});
  EXPECT_NEAR(norm(rotated(q, {1.0, 0.0, 5.0}) - (Vec3{0.0, 1.0, 5.0})), 0.0, 1e-15);
  EXPECT_EQ(rotated(rotation_of({}), {1.0, 2.0, 3.0}), (Vec3{1.0, 2.0, 3.0}));
  const RigidWay way = {{}, {{2.0, 0.0, 0.0}, q}, {0.0, 0.0, quarter}};
  EXPECT_EQ(way.at(0.5).displacement, (Vec3{1.0, 0.0, 0.0}));
  EXPECT_NEAR(norm(rotated(way.at(0.5).rotation, {1.0, 0.0, 0.0}) - Vec3{1.0, 1.0, 0.0} * std::sqrt(0.5)), 0.0, 1e-15);
  EXPECT_EQ(way.at(1.0).rotation.w, q.w);
  const Quaternion start = turned({}, {0.3, -0.2, 0.9});
  const Quaternion end = turned(start, {0.0, 3.0, 0.0});
  for (const Quaternion& same : {end, Quaternion{-end.w, -end.v}})
    EXPECT_NEAR(norm(turn_between(start, same) - Vec3{0.0, 3.0, 0.0}), 0.0, 1e-14);
  EXPECT_EQ(turn_between(start, start), (Vec3{}));
}

// At the same time a chord leaves the way by half of the distance at most.
TEST(RigidPose, SlicesKeepChordsNearTheWay) {
  Random random(8);
  for (int k = 0; k < 200; ++k) {
    RigidWay way = {{}, {}, test::random_vector(random, 8.0)};
    way.to = {test::random_vector(random), turned({}, way.turn)};
    const double arm = random.uniform(0.1, 2.0);
    const Vec3 aside = cross(way.turn, test::random_vector(random));
    const Vec3 x = aside * (arm / norm(aside)) + way.turn;
    const double distance = arm * std::pow(2.0, -random.uniform(2.0, 14.0));
    const double count = slices_of(bend_of(norm(way.turn), arm), distance);
    const auto place = [&](double share) {
      const RigidPose pose = way.at(share);
      return pose.displacement + rotated(pose.rotation, x);
    };
    const double slice = std::floor(random.uniform(0.0, count));
    double farthest = 0.0;
    for (double t = 0.0; t <= 1.0; t += 0.0625) {
      const Vec3 chord = place(slice / count) * (1.0 - t) + place((slice + 1.0) / count) * t;
      farthest = std::max(farthest, norm(chord - place((slice + t) / count)));
    }
    EXPECT_LE(farthest, 0.5 * distance * (1.0 + 1e-9));
    if (count > 20.0) EXPECT_GT(farthest, 0.4 * distance) << "no more slices than that takes";
  }
}

TEST(SolidsComponent, ANeedleStopsAtAWall) {
  SolidScene needle;
  needle.name = "needle";
  needle.shape = std::vector<Vec3>{{0, 0, 0}, {0, 0, 0.5}, {0, 0, 1.0}};
  needle.at = {1.5, 1.5, 0.5};
  needle.pivot = needle.at;
  needle.moves = {{1.0, {0.0, 0.0, 5.0}, {}}, {2.0, {0.0, 0.0, -5.0}, {}}};
  for (const bool catch_up : {false, true}) {
    needle.catch_up = catch_up;
    Simulation simulation(scene_with(needle), Threads{1});
    for (int s = 0; s < 100; ++s) simulation.step();
    const SolidSummary stopped = simulation.solid_summaries()[0];
    EXPECT_NEAR(stopped.pivot.z, 3.0, 1e-6);
    EXPECT_LT(simulation.solids()->positions()[2].z, 4.0);
    EXPECT_GT(stopped.contacts, 40U);
    EXPECT_GT(stopped.stopped, 40U);
    for (int s = 0; s < 50; ++s) simulation.step();
    // Lost motion is lost: it goes back at once. Motion to catch up is first taken back.
    EXPECT_NEAR(simulation.solid_summaries()[0].pivot.z, catch_up ? 3.0 : 0.5, 1e-6);
    EXPECT_EQ(simulation.audit().failed, 0U) << simulation.audit().first;
    EXPECT_EQ(simulation.audit().checked, 3U + 2U);
  }
}

TEST(SolidsComponent, AToolKeepsItsShape) {
  SolidScene tool;
  tool.name = "tool";
  tool.shape = block({2.0, 0.2, 0.2});
  tool.at = {1.0, 1.9, 1.9};
  tool.pivot = {2.0, 2.0, 2.0};
  tool.moves = {{10.0, {0.8, 0.0, 0.4}, {2.0, 1.0, 5.0}}};
  Simulation simulation(scene_with(tool), Threads{1});
  const auto side = [&] { return norm(simulation.solids()->positions()[0] - simulation.solids()->positions()[1]); };
  const double length = side();
  for (int s = 0; s < 300; ++s) {
    simulation.step();
    EXPECT_EQ(simulation.audit().failed, 0U) << simulation.audit().first;
    EXPECT_NEAR(side(), length, 1e-14) << s;
  }
  EXPECT_GT(simulation.solid_summaries()[0].contacts, 10U);
}

// A wall that bulges into a tool that is held stops; particles go on, and the run can be continued at any time.
TEST(SolidsComponent, WallsStopAtAToolAndTheRunGoesOn) {
  SolidScene tool;
  tool.name = "tool";
  tool.shape = block({1.0, 1.0, 0.5});
  tool.at = {1.5, 1.5, 0.3};
  Scene scene = scene_with(tool);
  scene.deformation = {pulse(0.6)};
  ParticlesScene particles;
  particles.source = RandomParticles{50};
  particles.velocity = {1.0, 0.5, -0.7};
  scene.particles = {particles};
  Simulation whole(scene, Threads{1});
  double least = 1.0;
  for (int s = 0; s < 60; ++s) {
    whole.step();
    least = std::min(least, whole.solids_step().walls_made);
    ASSERT_EQ(whole.audit().failed, 0U) << whole.audit().first;
    if (s % 7 != 3) continue;
    Simulation resumed(scene, whole.checkpoint(), Threads{1});
    ASSERT_EQ(resumed.state_hash(), whole.state_hash()) << s;
    Simulation restored(scene, Threads{1});
    restored.restore(whole.checkpoint());
    for (int k = 0; k < 3; ++k) {
      resumed.step();
      restored.step();
    }
    const SimulationCheckpoint back = whole.checkpoint();
    for (int k = 0; k < 3; ++k) whole.step();
    EXPECT_EQ(resumed.state_hash(), whole.state_hash()) << s;
    EXPECT_EQ(restored.state_hash(), whole.state_hash()) << s;
    whole.restore(back);
  }
  EXPECT_LT(least, 0.5);
}

// An edit is made again where the vertices stood, not where the deformation alone would have put them.
TEST(SolidsComponent, EditsAtStoppedWallsAreMadeAgain) {
  SolidScene tool;
  tool.name = "tool";
  tool.shape = block({1.0, 1.0, 0.5});
  tool.at = {1.5, 1.5, 0.3};
  Scene scene = scene_with(tool);
  auto& mesh = std::get<MeshData>(scene.environment.mesh);
  mesh.free.assign(mesh.cell_count(), 1);
  std::fill(mesh.free.end() - 16, mesh.free.end(), std::uint8_t{0});  // the highest layer, to be cut
  scene.deformation = {pulse(0.6)};
  scene.deformation[0].step.length = 8.0;
  ParticlesScene particles;
  particles.source = RandomParticles{50};
  particles.velocity = {1.0, 0.5, -0.7};
  scene.particles = {particles};
  for (const double at : {0.07, 0.14, 0.3}) {
    Cut cut;
    cut.surface = Plane{{0.6, 0.0, 0.8}, 3.0 + 5.0 * at};
    cut.width = 0.02;
    scene.events.push_back({{at, cut}});
  }
  Simulation whole(scene, Threads{1});
  bool stopped_at_edit = false;
  for (int s = 0; s < 40; ++s) {
    const bool before = whole.solids_step().walls_made < 1.0;
    const std::size_t edits = whole.event_log().changes.size();
    whole.step();
    stopped_at_edit = stopped_at_edit || (before && whole.event_log().changes.size() > edits);
    ASSERT_EQ(whole.audit().failed, 0U) << whole.audit().first;
    if (s % 6 != 5) continue;
    Simulation restored(scene, whole.checkpoint(), Threads{1});
    ASSERT_EQ(restored.state_hash(), whole.state_hash()) << s;
    ASSERT_EQ(to_mesh(restored.environment().complex()).points, to_mesh(whole.environment().complex()).points) << s;
    const SimulationCheckpoint back = whole.checkpoint();
    for (int k = 0; k < 3; ++k) {
      restored.step();
      whole.step();
    }
    EXPECT_EQ(restored.state_hash(), whole.state_hash()) << s;
    if (whole.event_log().changes.size() == back.state().events.changes.size()) whole.restore(back);
  }
  EXPECT_TRUE(stopped_at_edit);
  for (const EventReport& e : whole.event_log().events) EXPECT_GT(e.cells_added, 0U) << e.time;
}

TEST(SolidsComponent, FollowsEdits) {
  SolidScene line;
  line.name = "line";
  line.shape = std::vector<Vec3>{{0.5, 1.5, 1.5}, {2.5, 1.5, 1.5}};
  Simulation simulation(scene_with(line), Threads{1});
  Cell middle;
  for (const Cell c : simulation.environment().map().cells()) {
    if (simulation.environment().map().source(c) == 21) middle = c;  // from 1 to 2 along each axis
  }
  simulation.edit([&](ComplexEdit& e) { e.topology().set_free(middle, false); });
  EXPECT_TRUE(simulation.solid_summaries()[0].stuck);
  simulation.step();
  simulation.edit([&](ComplexEdit& e) { e.topology().set_free(middle, true); });
  EXPECT_FALSE(simulation.solid_summaries()[0].stuck);
}

TEST(SolidsComponent, NamesTheSolidThatDoesNotFitIn) {
  SolidScene line;
  line.name = "line";
  line.shape = std::vector<Vec3>{{0.5, 1.5, 1.5}, {5.5, 1.5, 1.5}};
  const auto message = [&] {
    try {
      Simulation simulation(scene_with(line), Threads{1});
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(message(),
            "solid \"line\": its part with the vertices 1 at (5.5, 1.5, 1.5) is in a blocked cell or outside; "
            "move or turn it");
  line.shape = std::filesystem::path("a.stl");
  EXPECT_EQ(message(), "solid \"line\": its surface is a file that has not been read; call load_scene_files() first");
}

}  // namespace dartcast::solids_component_test
