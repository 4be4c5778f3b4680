// Events while a simulation runs: what leaks, what is stopped, and that nobody is lost.
#include "dartcast/events.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "base/random.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/mesh_selection.hpp"
#include "dartcast/simulation.hpp"
#include "dartcast/validity.hpp"
#include "mesh/cell_types.hpp"
#include "support/expectations.hpp"
#include "support/particle_checks.hpp"
#include "support/tier.hpp"
#include "support/with_response.hpp"

namespace dartcast::event_test {

// A channel along x, 1 <= y, z <= 5, in a layer of blocked cells.
MeshData channel() {
  BoxOptions o;
  o.cells = {12, 6, 6};
  o.size = {12.0, 6.0, 6.0};
  o.blocked_layer = true;
  return generate_box(o);
}

SimulationOptions falling(double dt) {
  SimulationOptions o;
  o.dt = dt;
  o.gravity = {0.0, 0.0, -1.0};
  return o;
}

std::size_t count_if(const Simulation& simulation, const std::function<bool(const Vec3&)>& where) {
  std::size_t count = 0;
  for (const ParticleState& s : simulation.particles().states()) count += where(s.position) ? 1 : 0;
  return count;
}

Deformation sway(const Environment& environment) {
  DeformationStep twist;
  twist.kind = DeformationKind::twist;
  twist.axis = {1.0, 0.0, 0.0};
  twist.centre = {6.0, 3.0, 3.0};
  twist.amplitude = 0.4;
  twist.length = 12.0;
  return Deformation({twist}, environment.positions());
}

const Event cut_below = {0.0, Cut{Disc{{6.0, 3.0, 0.5}, {1.0, 0.0, 0.0}, 1.0}, 0.5}, OrphanPolicy::relocate};

// Particles that fall reach the bottom of the gap, and nothing else below the channel.
TEST(Events, ParticlesLeakIntoACut) {
  Environment environment(channel());
  Simulation simulation(environment, test::with_response(falling(0.02), Slide{}));
  std::vector<Vec3> places;
  for (int i = 0; i < 100; ++i) places.push_back({5.76 + 0.005 * i, 3.0, 2.0});
  simulation.add(places, {});
  const EventReport report = apply(simulation, cut_below);
  EXPECT_EQ(name_of(report.kind), "cut");
  EXPECT_GT(report.cells_opened, 0U);
  EXPECT_EQ(report.boundary_shift, 0.0);
  for (int i = 0; i < 200; ++i) {
    simulation.step();
    ASSERT_NO_FATAL_FAILURE(test::expect_audited(simulation.environment().complex(), simulation.particles()));
  }
  EXPECT_EQ(count_if(simulation, [](const Vec3& x) { return x.z < 0.9; }), 99U);  // all but the first, beside the gap
  EXPECT_EQ(count_if(simulation, [](const Vec3& x) { return x.z < 0.9 && std::abs(x.x - 6.0) > 0.25; }), 0U);
}

TEST(Events, ALigatureSealsAndItsWallsAreDrawnTogether) {
  Environment environment(channel());
  Simulation simulation(environment, test::with_response(SimulationOptions{.dt = 0.02}, Reflect{1.0, 0.0}));
  std::vector<Vec3> places;
  for (int i = 0; i < 300; ++i) places.push_back({1.5 + 0.008 * i, 1.5 + 0.01 * i, 3.0 + 0.003 * (i % 7)});
  simulation.add(places, {2.0, 0.3, 0.7});
  Ligature tie{plane_through({6.5, 3.0, 3.0}, {1.0, 0.0, 0.0}), {6.5, 3.0, 3.0}, {0.8, 2.0}, 0.5};
  const EventReport report = apply(simulation, {0.0, tie, OrphanPolicy::relocate});
  EXPECT_EQ(report.cells_blocked, 16U);
  const Vec3 corner = environment.positions()[7 + 13 * (1 + 7 * 1)];  // (7, 1, 1)
  for (int i = 0; i < 400; ++i) {
    simulation.step();
    if (i % 20 == 0)
      ASSERT_NO_FATAL_FAILURE(test::expect_audited(simulation.environment().complex(), simulation.particles()));
    ASSERT_EQ(count_if(simulation, [](const Vec3& x) { return x.x > 6.5; }), 0U);
  }
  EXPECT_TRUE(environment.validity().valid());
  const Vec3 drawn = environment.positions()[7 + 13 * (1 + 7 * 1)];
  EXPECT_EQ(corner, (Vec3{7.0, 1.0, 1.0}));
  EXPECT_GT(drawn.y, 1.3);
  EXPECT_GT(drawn.z, 1.3);
  EXPECT_EQ(simulation.particles().size(), 300U);
}

// While the whole twists: vertices of cuts go with the others, and cells stay valid.
TEST(Events, SurgeryOnWhatDeforms) {
  std::vector<std::string> hashes;
  for (const unsigned threads : {1U, 3U}) {
    Environment environment(channel(), {threads});
    Simulation simulation(environment, test::with_response(falling(0.02), Reflect{0.5, 0.0}));
    simulation.set_deformation(sway(environment));
    simulation.set_field(
        VelocityField(environment.complex(), std::vector<Vec3>(environment.positions().size(), Vec3{0.5, 0.0, -1.0})));
    simulation.add_random(300, {});
    for (int i = 0; i < 200; ++i) {
      if (i == 20) apply(simulation, cut_below);
      if (i == 60)
        apply(simulation, {0.0, Carve{capsule_tool({9.0, 3.0, 0.3}, {9.0, 3.0, 1.5}, 0.4)}, OrphanPolicy::relocate});
      if (i == 100)
        apply(simulation,
              {0.0, Ligature{plane_through({3.5, 3.0, 3.0}, {1.0, 0.0, 0.0}), {3.5, 3.0, 3.0}, {0.5, 1.5}, 0.4},
               OrphanPolicy::hold});
      simulation.step();
      if (i % 10 == 0)
        ASSERT_NO_FATAL_FAILURE(test::expect_audited(simulation.environment().complex(), simulation.particles()));
      const Validity validity = environment.validity();
      ASSERT_TRUE(validity.valid()) << "step " << i << ": " << validity.first.front().message;
    }
    EXPECT_GT(count_if(simulation, [](const Vec3& x) { return x.z < 0.9; }), 0U);
    EXPECT_EQ(simulation.particles().size(), 300U);
    hashes.push_back(simulation.state_hash().hex());
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(Events, ASliceIsTakenOutAndFilledAgain) {
  Environment environment(channel());
  Simulation simulation(environment, test::with_response(falling(0.02), Reflect{0.5, 0.0}));
  simulation.add_random(500, {1.0, 0.0, 0.0});
  const std::size_t in_slice = count_if(simulation, [](const Vec3& x) { return x.x > 5.5 && x.x < 7.5; });
  Event remove{0.0, Carve{box_tool({5.5, -1.0, -1.0}, {7.5, 7.0, 7.0}), Carving::remove}, OrphanPolicy::absorb};
  const EventReport removed = apply(simulation, remove);
  EXPECT_EQ(removed.particles_absorbed, in_slice);
  EXPECT_EQ(simulation.totals().absorbed, in_slice);
  EXPECT_EQ(simulation.particles().size(), 500 - in_slice);
  const std::size_t left = count_if(simulation, [](const Vec3& x) { return x.x < 5.5; });
  for (int i = 0; i < 100; ++i) simulation.step();
  EXPECT_EQ(count_if(simulation, [](const Vec3& x) { return x.x <= 5.5; }), left);
  test::expect_audited(simulation.environment().complex(), simulation.particles());
  const auto at = [](double x) { return plane_through({x, 0.0, 0.0}, {1.0, 0.0, 0.0}); };
  const EventReport filled = apply(simulation, {0.0, Reconnect{at(5.5), at(7.5), 0.01, {}}, OrphanPolicy::relocate});
  EXPECT_GT(filled.cells_added, 0U);
  std::size_t crossed = 0;
  for (int i = 0; i < 300; ++i) {
    simulation.step();
    crossed = std::max(crossed, count_if(simulation, [](const Vec3& x) { return x.x > 5.5 && x.x < 7.5; }));
  }
  EXPECT_GT(crossed, 0U);
  test::expect_audited(simulation.environment().complex(), simulation.particles());
}

TEST(Events, AnInletIsClosedWithItsLastFace) {
  BoxOptions o;
  o.cells = {4, 1, 1};
  o.size = {4.0, 1.0, 1.0};
  Environment environment(generate_box(o));
  Simulation simulation(environment, SimulationOptions{.dt = 0.1});
  simulation.add_inlet(environment.map().patch("xmin"), 50.0, {0.1, 0.0, 0.0});
  simulation.step();
  EXPECT_EQ(simulation.totals().injected, 5U);
  const Cell first = simulation.particles()[0].cell;
  simulation.edit([&](ComplexEdit& e) { e.topology().set_free(first, false); }, OrphanPolicy::relocate);
  simulation.step();
  EXPECT_EQ(simulation.totals().injected, 5U);
  simulation.edit([&](ComplexEdit& e) { e.topology().set_free(first, true); });
  simulation.step();
  EXPECT_EQ(simulation.totals().injected, 10U);
  test::expect_audited(simulation.environment().complex(), simulation.particles());
}

// A bump turns cells over; they are remeshed, and particles go on.
TEST(Events, RemeshesWhereADeformationTurnsCellsOver) {
  BoxOptions o;
  o.cells = {6, 6, 6};
  o.size = {6.0, 6.0, 6.0};
  std::size_t invalid[2] = {0, 0};  // cells, over all steps
  for (const bool remeshed : {false, true}) {
    Environment environment(generate_box(o));
    Simulation simulation(environment, test::with_response(SimulationOptions{.dt = 0.02}, Reflect{1.0, 0.0}));
    DeformationStep bump;
    bump.kind = DeformationKind::bump;
    bump.amplitude = 2.5;
    bump.length = 2.5;
    bump.centre = {3.0, 3.0, 3.0};
    simulation.set_deformation(Deformation({bump}, environment.positions()));
    simulation.add_random(300, {1.0, 0.5, 0.25});
    std::size_t mended = 0;
    for (int i = 0; i < 25; ++i) {
      simulation.step();
      if (remeshed) mended += simulation.repair().mended.size();
      invalid[remeshed ? 1 : 0] += environment.validity().invalid_count;
      test::expect_audited(simulation.environment().complex(), simulation.particles());
    }
    if (remeshed) EXPECT_GT(mended, 0U);
    EXPECT_EQ(simulation.particles().size(), 300U);
  }
  EXPECT_GT(invalid[0], 0U);
  EXPECT_LT(invalid[1], invalid[0]);  // most of the rest has a boundary that folds over itself
}

TEST(Events, SurgeryKeepsToTheTimesAndDoesItAgain) {
  const std::vector<Event> events = {
      cut_below, {0.1, Ligature{plane_through({3.5, 3.0, 3.0}, {1.0, 0.0, 0.0}), {3.5, 3.0, 3.0}, {0.0, 1.0}, 0.0}}};
  Environment environment(channel());
  Simulation simulation(environment, test::with_response(falling(0.02), Slide{}));
  simulation.add_random(200, {});
  simulation.set_events(events);
  for (int i = 0; i < 20; ++i) {
    simulation.step();
    EXPECT_EQ(simulation.event_log().events.size(), i < 5 ? 1U : 2U);
  }
  Environment other(channel());
  Simulation again(other, falling(0.02));
  again.set_events(events);
  again.restore(simulation.checkpoint());
  EXPECT_EQ(other.map(), environment.map());
  EXPECT_EQ(again.state_hash(), simulation.state_hash());
  test::expect_audited(other.complex(), again.particles());
  Simulation without(other, falling(0.02));  // it has no such events to repeat
  EXPECT_THROW(without.restore(simulation.checkpoint()), InvalidArgument);
}

// Nothing to tie, and nothing to join, as after an earlier event that was refused: the run goes on, and says which event
// did nothing. If the event is required, the run ends.
TEST(Events, SayWhichIsRefused) {
  const Plane beyond = plane_through({60.0, 3.0, 3.0}, {1.0, 0.0, 0.0});
  const Plane end = plane_through({0.0, 3.0, 3.0}, {1.0, 0.0, 0.0});
  std::vector<Event> events = {{0.0, Ligature{beyond, {}, {}, 0.0}}, {0.02, Reconnect{end, beyond, 1e-9, {}}}};
  {
    Environment environment(channel());
    Simulation simulation(environment, falling(0.02));
    simulation.set_events(events);
    for (int i = 0; i < 3; ++i) simulation.step();
    const std::vector<EventReport>& reports = simulation.event_log().events;
    ASSERT_EQ(reports.size(), 2U);
    test::expect_parts(reports[0].refused, {"crosses no free cell"});
    test::expect_parts(reports[1].refused, {"no open face", "end b"});
    EXPECT_EQ(environment.edit_count(), 0U);
  }
  events.front().required = true;
  Environment environment(channel());
  Simulation simulation(environment, falling(0.02));
  simulation.set_events(events);
  test::expect_parts(test::error_text([&] { simulation.step(); }),
                     {"event 1 (ligature at 0 s)", "crosses no free cell"});
  EXPECT_EQ(environment.edit_count(), 0U);
}

// Ends with a corner in common cannot be joined. The run goes on as without the event, unless it is required.
TEST(Events, WhatIsRefusedIsReported) {
  BoxOptions box;
  box.cells = {6, 6, 6};
  box.size = {6.0, 6.0, 6.0};
  box.blocked_layer = true;
  const Plane low = plane_through({0.0, 0.0, 0.0}, {0.0, 0.0, 1.0});
  const Plane left = plane_through({0.0, 0.0, 0.0}, {1.0, 0.0, 0.0});
  Event join = {0.1, Reconnect{low, left, 1e-9, {}}, OrphanPolicy::relocate};
  const auto end_of_run = [&](const std::vector<Event>& events) {
    Environment environment(generate_box(box));
    Simulation simulation(environment, falling(0.02));
    simulation.add(std::vector<Vec3>{{2.5, 3.0, 2.0}}, {});
    simulation.set_events(events);
    for (int i = 0; i < 10; ++i) simulation.step();
    EXPECT_EQ(environment.edit_count(), 0U);
    EXPECT_EQ(simulation.event_log().events.size(), events.size());
    for (const EventReport& report : simulation.event_log().events) {
      EXPECT_EQ(report.step, 5U);
      EXPECT_NE(report.refused.find("with one corner twice"), std::string::npos) << report.refused;
    }
    return simulation.particles()[0].position;
  };
  EXPECT_EQ(end_of_run({join}), end_of_run({}));
  join.required = true;
  try {
    end_of_run({join});
    FAIL() << "it is required";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("event 1 (reconnect at 0.1 s)"), std::string::npos) << e.what();
  }
}

// A box that twists: walls of the disc run close along those of bent cells. No part of these is valid as they are.
TEST(Events, ACutDividesBentCells) {
  BoxOptions box;
  box.cells = {6, 6, 6};
  box.size = {6.0, 6.0, 6.0};
  box.blocked_layer = true;
  DeformationStep twist;
  twist.kind = DeformationKind::twist;
  twist.amplitude = 0.3;
  twist.period = 2.0;
  twist.centre = {3.0, 3.0, 3.0};
  twist.length = 6.0;
  Environment environment(generate_box(box));
  Simulation simulation(environment, falling(0.02));
  simulation.set_deformation(Deformation({twist}, environment.positions()));
  Random random(3);
  simulation.add(test::random_points(200, {2.8, 2.2, 1.1}, {3.2, 3.8, 1.5}, random), {});
  simulation.set_events({{0.1, Cut{Disc{{3.0, 3.0, 0.5}, {1.0, 0.0, 0.0}, 1.0}, 0.25}, OrphanPolicy::relocate}});
  for (int i = 0; i < 60; ++i) simulation.step();
  ASSERT_EQ(simulation.event_log().events.size(), 1U);
  const EventReport& report = simulation.event_log().events[0];
  EXPECT_EQ(report.refused, "");
  EXPECT_GT(report.cells_opened, 0U);
  EXPECT_EQ(report.cells_whole, 0U);
  EXPECT_EQ(environment.edit_count(), 1U);
  EXPECT_EQ(simulation.particles().size(), 200U);
  EXPECT_GT(simulation.event_log().in_opened, 0U);
  test::expect_audited(environment.complex(), simulation.particles());
}

// A ligature across a strip in the plane stops who comes from the left; cuts are refused before anything is done.
// A box of three regions: the middle one is a valve.
MeshData valve_mesh(unsigned dimension) {
  MeshData mesh;
  if (dimension == 3) {
    BoxOptions box;
    box.cells = {12, 3, 3};
    box.size = {12.0, 3.0, 3.0};
    mesh = generate_box(box);
  } else {
    RectangleOptions rectangle;
    rectangle.cells = {12, 3};
    rectangle.size = {12.0, 3.0};
    mesh = generate_rectangle(rectangle);
  }
  mesh.regions.clear();
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    double x = 0.0;
    for (std::uint64_t k = mesh.offsets[c]; k < mesh.offsets[c + 1]; ++k) x += mesh.points[mesh.connectivity[k]].x;
    x /= static_cast<double>(mesh.offsets[c + 1] - mesh.offsets[c]);
    mesh.regions.push_back(x < 6.0 ? 1 : x < 7.0 ? 2 : 3);
  }
  mesh.region_names = {{1, "left"}, {2, "valve"}, {3, "right"}};
  return mesh;
}

class Valve : public testing::TestWithParam<std::tuple<unsigned, OrphanPolicy>> {};

TEST_P(Valve, LetsThroughOnlyWhileItIsOpen) {
  const auto [dimension, policy] = GetParam();
  MeshData mesh = valve_mesh(dimension);
  const std::vector<std::uint32_t> valve = cells_of_region(mesh, "valve");
  ASSERT_EQ(valve.size(), dimension == 3 ? 9U : 3U);
  const std::vector<std::string> open_at_first = {"left", "right"};
  select_free_regions(mesh, open_at_first);
  Environment environment(mesh);
  Simulation simulation(environment, test::with_response(SimulationOptions{.dt = 0.05}, Reflect{1.0, 0.0}));
  std::vector<Vec3> places;
  std::vector<Vec3> velocities;
  for (int i = 0; i < 200; ++i) {
    places.push_back({0.5 + 0.025 * i, 0.3 + 0.012 * i, dimension == 3 ? 1.3 : 0.0});
    velocities.push_back({2.0 + 0.01 * i, 0.4, 0.0});
  }
  simulation.add(places, velocities, std::vector<double>(200));
  simulation.set_events({{5.0, OpenCells{valve}, policy}, {10.0, CloseCells{valve}, policy}});
  const auto on_the_right = [&] { return count_if(simulation, [](const Vec3& x) { return x.x >= 7.0; }); };
  std::size_t passed = 0;
  for (int i = 0; i < 300; ++i) {
    simulation.step();
    ASSERT_NO_FATAL_FAILURE(test::expect_audited(simulation.environment().complex(), simulation.particles()));
    if (i < 100) ASSERT_EQ(on_the_right(), 0U) << "step " << i;
    if (i == 200) passed = on_the_right();
    if (i > 200 && policy != OrphanPolicy::relocate) ASSERT_EQ(on_the_right(), passed) << "step " << i;
  }
  EXPECT_GT(passed, 10U);
  const auto& events = simulation.event_log().events;
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].cells_opened, valve.size());
  EXPECT_EQ(events[1].cells_blocked, valve.size());
  EXPECT_EQ(events[0].step, 100U);
  const EventReport& closed = events[1];
  EXPECT_GT(closed.particles_in_opened, 0U);
  const std::uint64_t orphans = policy == OrphanPolicy::relocate ? closed.particles_moved
                                : policy == OrphanPolicy::hold   ? closed.particles_held
                                                                 : closed.particles_absorbed;
  EXPECT_EQ(orphans, closed.particles_in_opened);
  EXPECT_EQ(simulation.particles().size(), policy == OrphanPolicy::absorb ? 200U - orphans : 200U);
}

INSTANTIATE_TEST_SUITE_P(Policies, Valve,
                         testing::Combine(testing::Values(2U, 3U),
                                          testing::Values(OrphanPolicy::relocate, OrphanPolicy::hold,
                                                          OrphanPolicy::absorb)));

// A membrane across a channel, which closes and opens: a named group of faces between free cells.
MeshData membrane_mesh(unsigned dimension) {
  MeshData mesh = valve_mesh(dimension);
  mesh.patch_names[77] = "membrane";
  const auto is_across = [&](std::span<const std::uint32_t> face) {
    return std::all_of(face.begin(), face.end(), [&](std::uint32_t p) { return mesh.points[p].x == 6.0; });
  };
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    if (mesh.regions[c] != 1) continue;
    std::vector<std::vector<std::uint32_t>> across;
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> face) {
      if (is_across(face)) across.emplace_back(face.begin(), face.end());
    });
    for (const auto& face : across) mesh.add_patch_face(face, 77);
  }
  return mesh;
}

class Membrane : public testing::TestWithParam<unsigned> {};

TEST_P(Membrane, LetsThroughOnlyWhileItIsOpen) {
  MeshData mesh = membrane_mesh(GetParam());
  const std::size_t faces = GetParam() == 3 ? 9 : 3;
  const std::vector<std::string> name = {"membrane"};
  select_walls(mesh, name);
  Environment environment(mesh);
  const Patch membrane = environment.map().patch("membrane");
  const std::vector<CellFace> sides = inner_walls(environment.map());
  ASSERT_EQ(sides.size(), 2 * faces);
  for (const CellFace f : sides) EXPECT_EQ(environment.map().patch(f), membrane);
  Simulation simulation(environment, test::with_response(SimulationOptions{.dt = 0.05}, Reflect{1.0, 0.0}));
  std::vector<Vec3> places;
  std::vector<Vec3> velocities;
  for (int i = 0; i < 200; ++i) {
    places.push_back({0.5 + 0.025 * i, 0.3 + 0.012 * i, GetParam() == 3 ? 1.3 : 0.0});
    velocities.push_back({2.0 + 0.01 * i, 0.4, 0.0});
  }
  simulation.add(places, velocities, std::vector<double>(200));
  simulation.set_events({{5.0, OpenWalls{membrane}}, {6.0, OpenWalls{membrane}}, {10.0, CloseWalls{membrane}}});
  const auto on_the_right = [&] {  // one on the membrane, too
    const auto& states = simulation.particles().states();
    return static_cast<std::size_t>(std::count_if(states.begin(), states.end(), [&](const ParticleState& s) {
      return mesh.regions[environment.map().source(s.cell)] != 1;
    }));
  };
  std::size_t passed = 0;
  for (int i = 0; i < 300; ++i) {
    simulation.step();
    ASSERT_NO_FATAL_FAILURE(test::expect_audited(simulation.environment().complex(), simulation.particles()));
    if (i < 100) ASSERT_EQ(on_the_right(), 0U) << "step " << i;
    if (i == 200) passed = on_the_right();
    if (i > 200) ASSERT_EQ(on_the_right(), passed) << "step " << i;
  }
  EXPECT_GT(passed, 10U);
  EXPECT_LT(passed, 190U);
  const auto& events = simulation.event_log().events;
  ASSERT_EQ(events.size(), 3U);
  EXPECT_EQ(events[0].cells_added, 2 * faces);
  EXPECT_EQ(events[1].refused, "the patch 'membrane' has no faces between two cells to open");
  EXPECT_EQ(events[2].cells_added, 2 * faces);
  EXPECT_EQ(events[2].particles_moved, 0U);
}

INSTANTIATE_TEST_SUITE_P(Dimensions, Membrane, testing::Values(2U, 3U));

TEST(Events, CellsThatAreOpenStayOpen) {
  MeshData mesh = valve_mesh(3);
  Environment environment(mesh);
  Simulation simulation(environment);
  const std::vector<std::uint32_t> valve = cells_of_region(mesh, "2");
  EXPECT_EQ(apply(simulation, {0.0, OpenCells{valve}, OrphanPolicy::hold}).cells_opened, 0U);
  EXPECT_EQ(apply(simulation, {0.0, CloseCells{valve}, OrphanPolicy::hold}).cells_blocked, 9U);
  EXPECT_EQ(apply(simulation, {0.0, CloseCells{valve}, OrphanPolicy::hold}).cells_blocked, 0U);
  EXPECT_THROW((void)cells_of_region(mesh, "none"), InvalidMesh);
}

// The parts of a cell that was cut follow it.
// A blocked cell has the largest number that a cell can have in a file.
TEST(Events, CellsHaveAnyNumberInTheirFile) {
  if (test::sanitized()) GTEST_SKIP() << "takes half a GB";
  MeshData mesh = channel();
  for (std::uint32_t c = 0; c < mesh.cell_count(); ++c) mesh.source.push_back(mesh.free[c] != 0 ? c : ~0U - c);
  Environment environment(std::move(mesh));
  const Simulation simulation(environment, falling(0.02));
  EXPECT_EQ(simulation.event_log().in_opened, 0U);
}

TEST(Events, PartsOfCutCellsCloseWithTheirRegion) {
  MeshData mesh = valve_mesh(3);
  const std::vector<std::uint32_t> valve = cells_of_region(mesh, "valve");
  for (const std::uint32_t c : valve) {
    mesh.free.resize(mesh.cell_count(), 1);
    mesh.free[c] = 0;
  }
  Environment environment(mesh);
  Simulation simulation(environment);
  apply(simulation, {0.0, Cut{plane_through({6.5, 1.5, 1.45}, {0.0, 0.0, 1.0}), 0.2}, OrphanPolicy::hold});
  const EventReport report = apply(simulation, {0.0, OpenCells{valve}, OrphanPolicy::hold});
  EXPECT_GT(report.cells_opened, 9U);
  for (const Cell c : environment.map().cells()) EXPECT_TRUE(environment.map().is_free(c));
}

TEST(Events, InThePlaneALigatureSeals) {
  RectangleOptions o;
  o.cells = {12, 4};
  o.size = {12.0, 4.0};
  Environment environment(generate_rectangle(o));
  SimulationOptions drift;
  drift.dt = 0.05;
  drift.gravity = {1.0, 0.0, 0.0};
  Simulation simulation(environment, test::with_response(drift, Slide{}));
  std::vector<Vec3> places;
  for (int i = 0; i < 20; ++i) places.push_back({1.0, 0.1 + 0.19 * i, 0.0});
  simulation.add(places, {});
  EXPECT_THROW(simulation.set_events({cut_below}), InvalidArgument);
  const std::vector<Event> tie = {
      {0.5, Ligature{plane_through({6.5, 2.0, 0.0}, {1.0, 0.0, 0.0}), {6.5, 2.0, 0.0}, {0.0, 1.0}, 0.0}}};
  simulation.set_events(tie);
  for (int i = 0; i < 200; ++i) {
    simulation.step();
    ASSERT_NO_FATAL_FAILURE(test::expect_audited(simulation.environment().complex(), simulation.particles()));
  }
  EXPECT_EQ(simulation.event_log().events.at(0).cells_blocked, 4U);
  EXPECT_EQ(count_if(simulation, [](const Vec3& x) { return x.x == 6.0; }), 20U);
}

}  // namespace dartcast::event_test
