#include "dartcast/deformation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "support/expectations.hpp"
#include "support/generate_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::deformation_test {

using test::expect_near;

using Kind = DeformationKind;
constexpr double pi = std::numbers::pi;

DeformationStep step(Kind kind, double amplitude, double period = 4.0) {
  DeformationStep s;
  s.kind = kind;
  s.amplitude = amplitude;
  s.period = period;
  return s;
}

Vec3 move(const DeformationStep& s, double time, const Vec3& x) {
  Vec3 out;
  Deformation({s}, {&x, 1}).positions(time, {&out, 1});
  return out;
}

// At a quarter of the period, w = 1.
TEST(Deformation, RotateTurnsOnceAPeriod) {
  DeformationStep s = step(Kind::rotate, 0.0);
  s.centre = {1, 0, 5};
  s.axis = {0, 0, 3};
  expect_near(move(s, 1.0, {3, 0, 7}), {1, 2, 7});
  expect_near(move(s, 2.0, {3, 0, 7}), {-1, 0, 7});
  EXPECT_EQ(move(s, 4e9, {3, 0, 7}), (Vec3{3, 0, 7}));
}

TEST(Deformation, SwingGoesToAndFro) {
  DeformationStep s = step(Kind::swing, pi / 2);
  s.axis = {1, 0, 0};
  expect_near(move(s, 1.0, {7, 1, 0}), {7, 0, 1});
  expect_near(move(s, 3.0, {7, 1, 0}), {7, 0, -1});
}

TEST(Deformation, BendMakesTheAxisAnArc) {
  DeformationStep s = step(Kind::bend, pi / 2);
  s.length = 10;
  s.centre = {0, 0, 1};
  s.direction = {1, 0, 5};  // its part along the axis does not count
  const double radius = 20 / pi;
  expect_near(move(s, 1.0, {0, 0, 11}), {radius, 0, 1 + radius});
  expect_near(move(s, 1.0, {0, 0.5, 6}), {radius * (1 - std::sqrt(0.5)), 0.5, 1 + radius * std::sqrt(0.5)});
  expect_near(move(s, 1.0, {2, 0, 11}), {radius, 0, 1 + radius - 2});
  expect_near(move(s, 1.0, {2, 3, 1}), {2, 3, 1});
  EXPECT_EQ(move(s, 0.0, {2, 3, 11}), (Vec3{2, 3, 11}));
  expect_near(move(s, 1e-9, {2, 3, 11}), {2, 3, 11}, 1e-7);
}

TEST(Deformation, TwistTurnsBySections) {
  DeformationStep s = step(Kind::twist, pi / 2);
  s.length = 2;
  expect_near(move(s, 1.0, {1, 0, 2}), {0, 1, 2});
  expect_near(move(s, 1.0, {1, 0, 1}), {std::sqrt(0.5), std::sqrt(0.5), 1});
  expect_near(move(s, 1.0, {1, 0, 0}), {1, 0, 0});
}

TEST(Deformation, StretchKeepsVolumes) {
  DeformationStep s = step(Kind::stretch, 0.44);
  s.centre = {1, 1, 1};
  expect_near(move(s, 1.0, {2, 1, 2}), {1 + 1 / 1.2, 1, 2.44});
  BoxOptions box;
  box.cells = {3, 3, 3};
  box.size = {1.0, 1.0, 1.0};
  MeshData mesh = generate_box(box);
  Deformation({s}, mesh.points).positions(3.0, mesh.points);
  EXPECT_NEAR(test::volume(mesh), 1.0, 1e-14);
}

TEST(Deformation, PulseWidensFromAxisPointOrField) {
  DeformationStep s = step(Kind::pulse, 0.1);
  expect_near(move(s, 1.0, {2, 0, 9}), {2.2, 0, 9});
  s.axis = {};
  expect_near(move(s, 1.0, {2, 0, 9}), {2.2, 0, 9.9});
  s.field = {{0, 5, 0}};
  expect_near(move(s, 3.0, {2, 0, 9}), {2, -0.5, 9});
}

TEST(Deformation, PulseTravels) {
  DeformationStep s = step(Kind::pulse, 0.1);
  s.wavelength = 8;
  expect_near(move(s, 1.0, {2, 0, 2}), {2, 0, 2});
  expect_near(move(s, 2.0, {2, 0, 2}), {2.2, 0, 2});
  s.path = {4};
  expect_near(move(s, 3.0, {2, 0, 2}), {2.2, 0, 2});
}

TEST(Deformation, BumpIsLocalAndSmooth) {
  DeformationStep s = step(Kind::bump, 0.5);
  s.length = 2;
  expect_near(move(s, 1.0, {0, 0, 0}), {0, 0, 0.5});
  expect_near(move(s, 1.0, {1, 0, 0}), {1, 0, 0.5 * 0.75 * 0.75});
  EXPECT_EQ(move(s, 1.0, {2, 0, 0}), (Vec3{2, 0, 0}));
  EXPECT_EQ(move(s, 1.0, {3, 0, 0}), (Vec3{3, 0, 0}));
}

TEST(Deformation, FramesAreLinearBetweenAndHeldOutside) {
  DeformationStep s = step(Kind::frames, 0.0);
  s.times = {1, 2, 4};
  s.frames = {{{0, 0, 0}}, {{1, 0, 0}}, {{1, 8, 0}}};
  EXPECT_EQ(move(s, -5.0, {9, 9, 9}), (Vec3{0, 0, 0}));
  EXPECT_EQ(move(s, 1.0, {9, 9, 9}), (Vec3{0, 0, 0}));
  EXPECT_EQ(move(s, 1.25, {9, 9, 9}), (Vec3{0.25, 0, 0}));
  EXPECT_EQ(move(s, 2.0, {9, 9, 9}), (Vec3{1, 0, 0}));
  EXPECT_EQ(move(s, 3.0, {9, 9, 9}), (Vec3{1, 4, 0}));
  EXPECT_EQ(move(s, 7.0, {9, 9, 9}), (Vec3{1, 8, 0}));
}

TEST(Deformation, StepsApplyInOrder) {
  DeformationStep quarter = step(Kind::rotate, 0.0), wide = step(Kind::stretch, 0.44);
  wide.axis = {1, 0, 0};
  const Vec3 x = {1, 0, 0};
  Vec3 out;
  Deformation({wide, quarter}, {&x, 1}).positions(1.0, {&out, 1});
  expect_near(out, {0, 1.44, 0});
  Deformation({quarter, wide}, {&x, 1}).positions(1.0, {&out, 1});
  expect_near(out, {0, 1 / 1.2, 0});
}

std::vector<DeformationStep> one_of_each() {
  std::vector<DeformationStep> steps;
  for (const Kind k : {Kind::pulse, Kind::stretch, Kind::bump, Kind::twist, Kind::bend, Kind::swing, Kind::rotate}) {
    steps.push_back(step(k, 0.3, 1.7));
    steps.back().axis = {1, 2, 3};
    steps.back().wavelength = 0.5;
  }
  return steps;
}

TEST(Deformation, SameBitsForAnyNumberOfThreadsAndAnyHistory) {
  BoxOptions box;
  box.cells = {30, 30, 30};
  box.size = {1.0, 1.0, 1.0};
  const MeshData mesh = generate_box(box);
  const Deformation deformation(one_of_each(), mesh.points);
  std::vector<Vec3> one(mesh.points.size()), many(mesh.points.size());
  deformation.positions(0.123, one, Threads{1});
  for (const unsigned threads : {2U, 7U}) {
    deformation.positions(0.9, many, Threads{threads});
    deformation.positions(0.123, many, Threads{threads});
    EXPECT_EQ(std::memcmp(one.data(), many.data(), one.size() * sizeof(Vec3)), 0);
  }
  EXPECT_GT(norm(one.back() - mesh.points.back()), 0.1);
}

TEST(Deformation, EveryKindHasAName) {
  EXPECT_EQ(deformation_kind("rotate"), Kind::rotate);
  EXPECT_EQ(deformation_kind("bump"), Kind::bump);
  EXPECT_EQ(deformation_kind("frames"), Kind::frames);
  EXPECT_EQ(deformation_kind("wobble"), std::nullopt);
}

TEST(Deformation, RefusesWhatItCannotDo) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const auto refuses = [](Kind kind, auto&& change, const char* text) {
    DeformationStep s = step(kind, 0.1);
    if (kind == Kind::frames) s.times = {0, 1}, s.frames = {{Vec3{}}, {Vec3{}}};
    EXPECT_NO_THROW(move(s, 0.5, {1, 2, 3}));
    change(s);
    try {
      move(s, 0.5, {1, 2, 3});
      ADD_FAILURE() << "accepted: " << text;
    } catch (const InvalidArgument& e) {
      EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
    }
  };
  using S = DeformationStep;
  refuses(
      Kind::swing, [](S& s) { s.amplitude = nan; }, "deformation 1 (swing): amplitude");
  refuses(
      Kind::rotate, [](S& s) { s.period = 0; }, "period");
  refuses(
      Kind::rotate, [](S& s) { s.period = inf; }, "period");
  refuses(
      Kind::rotate, [](S& s) { s.axis = {}; }, "axis");
  refuses(
      Kind::rotate, [](S& s) { s.centre.y = nan; }, "finite");
  refuses(
      Kind::twist, [](S& s) { s.length = 0; }, "length");
  refuses(
      Kind::bend,
      [](S& s) {
        s.direction = {0, 0, 2};
      },
      "direction");
  refuses(
      Kind::stretch, [](S& s) { s.amplitude = 1; }, "amplitude");
  refuses(
      Kind::pulse, [](S& s) { s.wavelength = -1; }, "wavelength");
  refuses(
      Kind::pulse, [](S& s) { s.field.resize(2); }, "field");
  refuses(
      Kind::pulse,
      [](S& s) {
        s.field = {{nan, 0, 0}};
      },
      "field");
  refuses(
      Kind::pulse, [](S& s) { s.path.resize(2); }, "path");
  refuses(
      Kind::frames,
      [](S& s) {
        s.times = {1, 1};
      },
      "increasing");
  refuses(
      Kind::frames, [](S& s) { s.times = {1}; }, "one time per frame");
  refuses(
      Kind::frames, [](S& s) { s.frames[1].clear(); }, "frame 1");
  refuses(
      Kind::frames, [](S& s) { s.frames[0][0].z = inf; }, "frame 0 must be finite");
}

TEST(Deformation, RefusesFramesBesideOthersAndBadTimes) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const Vec3 x;
  Vec3 out = {1, 2, 3};
  DeformationStep frames = step(Kind::frames, 0.0);
  frames.times = {0};
  frames.frames = {{x}};
  EXPECT_THROW(Deformation({step(Kind::rotate, 0), frames}, {&x, 1}), InvalidArgument);
  const Deformation still({}, {&x, 1});
  EXPECT_THROW(still.positions(nan, {&out, 1}), InvalidArgument);
  EXPECT_THROW(still.positions(0.0, {}), InvalidArgument);
  EXPECT_EQ(out, (Vec3{1, 2, 3}));
  still.positions(0.0, {&out, 1});
  EXPECT_EQ(out, x);
}

// Points of the plane, and whether a list of steps ever takes one out of it: by the positions themselves.
std::vector<Vec3> plane_points() {
  std::vector<Vec3> points;
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) points.push_back({1.3 * i - 2.1, 0.7 * j - 0.9, 0.0});
  }
  return points;
}

bool leaves_the_plane(const std::vector<DeformationStep>& steps) {
  const std::vector<Vec3> points = plane_points();
  const Deformation deformation(steps, points);
  std::vector<Vec3> out(points.size());
  for (int i = 0; i < 200; ++i) {
    deformation.positions(0.0371 * i, out);
    if (std::any_of(out.begin(), out.end(), [](const Vec3& x) { return x.z != 0.0; })) return true;
  }
  return false;
}

DeformationStep step_about(Kind kind, const Vec3& axis, const Vec3& direction = {1, 0, 0}) {
  DeformationStep s = step(kind, kind == Kind::rotate ? 0.0 : 0.7, 3.1);
  s.axis = axis;
  s.direction = direction;
  s.length = 4.0;
  s.centre = {0.3, -0.2, 0.0};
  return s;
}

std::string refusal(const std::vector<DeformationStep>& steps) {
  return test::error_text([&] { Deformation(steps, plane_points()).check_plane(); });
}

DeformationStep step_of_frames(double z) {
  DeformationStep s;
  s.kind = Kind::frames;
  s.times = {0.0, 1.0};
  s.frames = {plane_points(), plane_points()};
  s.frames[1][7].z = z;
  return s;
}

TEST(Deformation, MotionsInThePlaneAreTaken) {
  const Vec3 across = {0, 0, -2.5};
  const Vec3 within = {0.6, 0.7, 0.0};
  DeformationStep field = step_about(Kind::pulse, across);
  field.field.assign(plane_points().size(), Vec3{0.3, -0.1, 0.0});
  std::vector<DeformationStep> good = {
      step_about(Kind::rotate, across),  step_about(Kind::swing, across), step_about(Kind::twist, across),
      step_about(Kind::bend, within),    step_about(Kind::bend, across),  step_about(Kind::stretch, within),
      step_about(Kind::stretch, across), step_about(Kind::pulse, within), step_about(Kind::pulse, across),
      step_about(Kind::pulse, {}),       step_about(Kind::bump, within),  field};
  for (const DeformationStep& s : good) {
    EXPECT_FALSE(leaves_the_plane({s})) << name_of(s.kind);
    EXPECT_EQ(refusal({s}), "");
  }
  good.insert(good.begin(), step_of_frames(0.0));
  EXPECT_FALSE(leaves_the_plane(good));
  EXPECT_EQ(refusal(good), "");
}

TEST(Deformation, MotionsOutOfThePlaneAreNamed) {
  const Vec3 across = {0, 0, 1};
  const Vec3 within = {1, 0, 0};
  const Vec3 skew = {1, 0.5, 0.25};
  DeformationStep field = step_about(Kind::pulse, across);
  field.field.assign(plane_points().size(), Vec3{0.3, -0.1, 0.0});
  field.field[3].z = 1e-12;
  DeformationStep high = step_about(Kind::rotate, {0.0, 0.0, 1.0});
  high.centre.z = 0.1;  // a rounding away from it
  const std::vector<std::pair<DeformationStep, std::string>> bad = {
      {step_about(Kind::rotate, within), "axis"},
      {step_about(Kind::swing, skew), "axis"},
      {step_about(Kind::twist, within), "axis"},
      {step_about(Kind::bend, skew, {0, 1, 0}), "axis"},
      {step_about(Kind::bend, within, {0, 0, 1}), "direction"},
      {step_about(Kind::stretch, skew), "axis"},
      {step_about(Kind::pulse, skew), "axis"},
      {step_about(Kind::bump, across), "axis"},
      {step_about(Kind::bump, skew), "axis"},
      {field, "field must have z = 0 everywhere, and its vector 3"},
      {high, "centre"},
      {step_of_frames(-0.5), "frame 1 must have z = 0 everywhere, and its position 7 has z = -0.5"}};
  for (const auto& [s, member] : bad) {
    const std::string kind(name_of(s.kind));
    EXPECT_TRUE(leaves_the_plane({s})) << kind;
    EXPECT_NE(refusal({s}).find("deformation 1 (" + kind + ")"), std::string::npos) << refusal({s});
    EXPECT_NE(refusal({s}).find(member), std::string::npos) << refusal({s});
    if (s.kind == Kind::frames) continue;
    const std::string second = refusal({step_about(Kind::rotate, across), s});
    EXPECT_NE(second.find("deformation 2 (" + kind + ")"), std::string::npos) << second;
  }
}

std::vector<Vec3> vectors(const DataArray& array) {
  std::vector<Vec3> v;
  for (std::size_t i = 0; i < array.values.size(); i += 3) {
    v.push_back({array.values[i], array.values[i + 1], array.values[i + 2]});
  }
  return v;
}

// The demo's motion: the vessel pulses by a tenth of its radius in a wave that travels, and bends far.
TEST(Deformation, TheVesselStaysValidWhileItPulsesAndBends) {
  const MeshData mesh = generate_vessel();
  const auto array = [&](const char* name) {
    return *std::find_if(mesh.point_data.begin(), mesh.point_data.end(),
                         [&](const DataArray& a) { return a.name == name; });
  };
  DeformationStep pulse = step(Kind::pulse, 0.1, 0.8), bend = step(Kind::bend, 0.8, 2.0);
  pulse.wavelength = 0.06;
  pulse.field = vectors(array("pulse_direction"));
  pulse.path = array("path_length").values;
  bend.centre = {0, 0, -0.03};
  bend.length = 0.06;
  for (const Vec3 towards : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{1, 1, 0}}) {
    bend.direction = towards;
    const Deformation deformation({pulse, bend}, mesh.points);
    std::vector<Vec3> points(mesh.points.size());
    double furthest = 0;
    for (int i = 0; i < 20; i += test::sanitized() ? 7 : 1) {  // over 4 s the two motions come back together
      deformation.positions(4.0 * i / 20 + 0.01, points);
      ASSERT_EQ(test::count_not_positive(mesh, points), 0U) << "time " << 4.0 * i / 20 + 0.01;
      for (std::size_t v = 0; v < points.size(); ++v) furthest = std::max(furthest, norm(points[v] - mesh.points[v]));
    }
    EXPECT_GT(furthest, 0.02);
  }
}

}  // namespace dartcast::deformation_test
