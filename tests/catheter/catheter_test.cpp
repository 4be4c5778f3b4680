// The catheter in pipes: pushed, pulled, turned, bent, refused. (In the vessel: steering_test.cpp.)
#include "dartcast/catheter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>

#include "dartcast/audit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "support/catheter_scenes.hpp"
#include "support/tier.hpp"

namespace dartcast::catheter_test {

constexpr double pi = std::numbers::pi;

CatheterOptions in_pipe(double length) {
  CatheterOptions o;
  o.length = length;
  o.spacing = 0.5;
  o.stiffness = 16.0;
  o.entry = {2.5, 2.5, 2.0};
  o.direction = {0.0, 0.0, 1.0};
  return o;
}

// A wide box, free everywhere, that is entered at the middle of its bottom.
MeshData hall(double width, double height) {
  BoxOptions box;
  box.cells = {8, 8, 8};
  box.origin = {-0.5 * width, -0.5 * width, 0.0};
  box.size = {width, width, height};
  return generate_box(box);
}

CatheterOptions in_hall(double length) {
  CatheterOptions o = in_pipe(length);
  o.entry = {0.01, 0.02, 0.3};
  return o;
}

void expect_in_lumen(const Environment& environment, const Catheter& c) {
  const Audit a = audit(environment.complex(), c.particles());
  EXPECT_EQ(a.failed, 0U) << a.first;
  EXPECT_EQ(a.checked, c.particles().size());
  EXPECT_EQ(c.audit().failed, 0U) << c.audit().first;
}

TEST(Catheter, GoesStraightThroughAStraightPipeAndBack) {
  Environment environment(test::pipe(28));
  Catheter c(environment, in_pipe(20.0));
  EXPECT_TRUE(c.points().empty());
  double asked = 0.0;
  for (int i = 0; i < 77; ++i) {
    const double push = 0.25 * (i % 3 == 0 ? 1.0 : 0.7);
    const CatheterStep s = c.step({push});
    asked += push;
    EXPECT_NEAR(s.pushed, push, 1e-13);
    EXPECT_LE(s.worst_segment, 1e-9);
    EXPECT_NEAR(c.inserted(), asked, 1e-12);
    const std::vector<Vec3> p = c.points();
    ASSERT_FALSE(p.empty());
    EXPECT_LE(norm(p.front() - Vec3{2.5, 2.5, 2.0 + asked}), 1e-9);
    for (const Vec3& x : p) EXPECT_LE(std::hypot(x.x - 2.5, x.y - 2.5), 1e-9);
  }
  expect_in_lumen(environment, c);
  EXPECT_GT(c.points().size(), 25U);
  const CatheterStep all = c.step({-1e3});
  EXPECT_NEAR(all.pushed, -asked, 1e-9);
  EXPECT_NEAR(c.inserted(), 0.0, 1e-9);
  for (const ParticleState& s : c.particles().states()) EXPECT_LE(norm(s.position - c.entry()), 1e-9);
}

TEST(Catheter, IsNotLongerThanItIs) {
  Environment environment(test::pipe(28));
  Catheter c(environment, in_pipe(3.0));
  const CatheterStep s = c.step({5.0});
  EXPECT_NEAR(s.pushed, 3.0, 1e-12);
  EXPECT_EQ(c.points().size(), 7U);
  EXPECT_NEAR(c.measured_length(), 3.0, 1e-9);
  EXPECT_EQ(c.step({1.0}).pushed, 0.0);
}

// Straight against a wall it cannot go on: lengths are kept, and the rest of the push is refused.
TEST(Catheter, IsRefusedInPartAtADeadEnd) {
  Environment environment(test::pipe(14));  // free up to z = 13: 11 from the entry
  Catheter c(environment, in_pipe(20.0));
  double pushed = 0.0;
  for (int i = 0; i < 80; ++i) {
    const CatheterStep s = c.step({0.25});
    pushed += s.pushed;
    EXPECT_LE(s.worst_segment, 0.01);
    EXPECT_LE(std::abs(c.measured_length() - c.inserted()), 0.01 * c.inserted());
  }
  EXPECT_NEAR(c.inserted(), pushed, 1e-9);
  EXPECT_GE(pushed, 10.9);
  EXPECT_LE(pushed, 11.0 * 1.01);
  expect_in_lumen(environment, c);
  const CatheterStep back = c.step({-1.0});
  EXPECT_NEAR(back.pushed, -1.0, 1e-9);
}

// With a bent tip and room beside it buckles, and goes on being pushed with its lengths kept.
TEST(Catheter, BucklesInADeadEnd) {
  Environment environment(hall(12.0, 10.0));
  CatheterOptions o = in_hall(20.0);
  o.stiffness = 4.0;
  o.tip_length = 3.0;
  o.tip_curvature = 0.15;
  Catheter c(environment, o);
  double worst = 0.0;
  for (int i = 0; i < 80; ++i) {
    const CatheterStep s = c.step({0.2});
    worst = std::max(worst, s.worst_segment);
    ASSERT_LE(std::abs(c.measured_length() - c.inserted()), 0.01 * std::max(c.inserted(), o.spacing));
  }
  RecordProperty("inserted", std::to_string(c.inserted()));
  EXPECT_LE(worst, 0.01);
  EXPECT_GT(c.inserted(), 13.0);  // the top is 9.7 from the entry
  double sideways = 0.0;
  for (const Vec3& x : c.points()) sideways = std::max(sideways, std::hypot(x.x - o.entry.x, x.y - o.entry.y));
  EXPECT_GT(sideways, 2.0);
  expect_in_lumen(environment, c);
}

double deflection(double stiffness, double load) {
  Environment environment(hall(30.0, 30.0));
  CatheterOptions o = in_hall(20.0);
  o.stiffness = stiffness;
  Catheter c(environment, o);
  c.step({10.0});
  CatheterStep s;
  for (int i = 0; i < 60; ++i) s = c.step({0.0, 0.0, {load, 0.0, 0.0}});
  EXPECT_LE(s.worst_segment, 0.01);
  return c.points().front().x - o.entry.x;
}

// A cantilever under an even load of its points, as hinges with springs: exactly, for small bends. Continuous it would
// be q L^4 / (8 B) at its end, its length being known to one spacing.
double expected_deflection(int points, double spacing, double stiffness, double load) {
  double sum = 0.0;
  for (int hinge = 1; hinge <= points; ++hinge) {
    double moment = 0.0;
    for (int i = 0; i < hinge; ++i) moment += load * (hinge - i) * spacing;
    sum += moment / (stiffness / (spacing * spacing)) * (hinge * spacing);
  }
  return sum;
}

TEST(Catheter, BendsAsABeamDoes) {
  const double load = 2e-3;
  double before = std::numeric_limits<double>::max();
  for (const double stiffness : {400.0, 1600.0, 6400.0}) {
    const double expected = expected_deflection(19, 0.5, stiffness, load);
    const double found = deflection(stiffness, load);
    EXPECT_NEAR(found, expected, 0.002 * expected) << stiffness;
    EXPECT_NEAR(found, load * std::pow(9.5, 4) / (8.0 * stiffness), 0.25 * expected) << stiffness;
    EXPECT_LT(found, before);
    before = found;
  }
}

// A bent tip in the open is an arc of its curvature; turned by an angle it is that arc turned; turned by 2 pi the same.
TEST(Catheter, TurnsItsTip) {
  Environment environment(hall(20.0, 20.0));
  CatheterOptions o = in_hall(12.0);
  o.stiffness = 400.0;
  o.tip_length = 4.0;
  o.tip_curvature = 0.2;
  Catheter c(environment, o);
  c.step({10.0});
  const auto place_in_simplex = [&] {
    for (int i = 0; i < 60; ++i) c.step({});
    return c.points();
  };
  const std::vector<Vec3> first = place_in_simplex();
  for (std::size_t i = 1; i < 7; ++i) {  // the tip's last point has but half of the bend
    const double turn = norm(cross(first[i - 1] - first[i], first[i] - first[i + 1])) / (o.spacing * o.spacing);
    EXPECT_NEAR(std::asin(turn) / o.spacing, 0.2, 0.002) << i;
  }
  const Vec3 normal = c.frames().back().normal;
  const Vec3 tip = first.front() - o.entry;
  EXPECT_GT(dot(tip, normal), 1.0);
  EXPECT_NEAR(dot(tip, cross({0, 0, 1}, normal)), 0.0, 1e-6);
  c.step({0.0, 0.5 * pi});
  const Vec3 quarter = place_in_simplex().front() - o.entry;
  EXPECT_LE(norm(quarter - (cross({0, 0, 1}, normal) * dot(tip, normal) + Vec3{0, 0, tip.z})), 1e-3 * o.spacing);
  c.step({0.0, 1.5 * pi});
  const std::vector<Vec3> whole = place_in_simplex();
  ASSERT_EQ(whole.size(), first.size());
  for (std::size_t i = 0; i < whole.size(); ++i) EXPECT_LE(norm(whole[i] - first[i]), 1e-3 * o.spacing) << i;
}

TEST(Catheter, FramesAreRightHandedAndDoNotTwist) {
  Environment environment(hall(20.0, 20.0));
  CatheterOptions o = in_hall(12.0);
  o.tip_length = 6.0;
  o.tip_curvature = 0.3;
  Catheter c(environment, o);
  for (int i = 0; i < 40; ++i) c.step({0.25, 0.1});
  const std::vector<CatheterFrame> frames = c.frames();
  ASSERT_EQ(frames.size(), c.points().size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const CatheterFrame& f = frames[i];
    EXPECT_NEAR(norm(f.tangent), 1.0, 1e-12);
    EXPECT_NEAR(norm(f.normal), 1.0, 1e-12);
    EXPECT_NEAR(dot(f.tangent, f.normal), 0.0, 1e-12);
    EXPECT_LE(norm(cross(f.tangent, f.normal) - f.binormal), 1e-12);
    if (i == 0) continue;
    // No turn about the tangent: the normal's change is along the tangents' plane.
    const Vec3 axis = frames[i].tangent + frames[i - 1].tangent;
    EXPECT_NEAR(dot(cross(frames[i].normal, frames[i - 1].normal), axis), 0.0, 1e-9);
  }
}

// Where the vessel turns as a whole, the catheter does as it would in one that stands still: its entry, its shape and
// what presses on walls are carried along.
TEST(Catheter, IsCarriedAlongByTheVessel) {
  Environment environment(test::pipe(20));
  Environment still(test::pipe(20));
  CatheterOptions o = in_pipe(12.0);
  o.tip_length = 4.0;
  o.tip_curvature = 0.4;  // wider than the pipe
  Catheter c(environment, o);
  Catheter other(still, o);
  for (int i = 0; i < 800; ++i) {  // until its tip slides no more
    c.step({i == 0 ? 10.0 : 0.0, i == 0 ? 0.3 : 0.0});
    other.step({i == 0 ? 10.0 : 0.0, i == 0 ? 0.3 : 0.0});
  }
  const std::vector<Vec3> rest(environment.positions().begin(), environment.positions().end());
  for (int i = 1; i <= 40; ++i) {
    const double a = 0.02 * i;
    const auto turned = [a](const Vec3& x) {
      return Vec3{x.x, x.y * std::cos(a) - x.z * std::sin(a), x.y * std::sin(a) + x.z * std::cos(a)};
    };
    std::vector<Vec3> now;
    for (const Vec3& x : rest) now.push_back(turned(x));
    EXPECT_EQ(c.move_with(now), 1.0);
    EXPECT_LE(c.step({}).worst_segment, 1e-3);
    EXPECT_GT(other.step({}).at_walls, 0U);
    EXPECT_LE(norm(c.entry() - turned(o.entry)), 1e-10);
    EXPECT_LE(norm(c.direction() - turned({0, 0, 1})), 1e-10);
    const std::vector<Vec3> p = c.points();
    const std::vector<Vec3> q = other.points();
    ASSERT_EQ(p.size(), q.size());
    for (std::size_t k = 0; k < p.size(); ++k) EXPECT_LE(norm(p[k] - turned(q[k])), 0.02 * o.spacing) << i << " " << k;
  }
}

TEST(Catheter, RefusesWhatMakesNoSense) {
  Environment environment(test::pipe(14));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto expect_refused = [&](auto&& spoil) {
    CatheterOptions o = in_pipe(5.0);
    spoil(o);
    EXPECT_THROW(Catheter(environment, o), InvalidArgument);
  };
  expect_refused([](CatheterOptions& o) { o.spacing = 0.0; });
  expect_refused([](CatheterOptions& o) { o.length = 0.1; });
  expect_refused([&](CatheterOptions& o) { o.length = nan; });
  expect_refused([](CatheterOptions& o) { o.length = 1e12; });
  expect_refused([](CatheterOptions& o) { o.stiffness = -1.0; });
  expect_refused([](CatheterOptions& o) { o.stiffness = 1e12; });
  expect_refused([](CatheterOptions& o) { o.tip_length = 6.0; });
  expect_refused([](CatheterOptions& o) { o.tip_curvature = -1.0; });
  expect_refused([&](CatheterOptions& o) { o.friction = nan; });
  expect_refused([](CatheterOptions& o) { o.rounds = 0; });
  expect_refused([](CatheterOptions& o) { o.tolerance = 0.5; });
  expect_refused([](CatheterOptions& o) { o.direction = {}; });
  expect_refused([&](CatheterOptions& o) { o.entry.x = nan; });
  expect_refused([](CatheterOptions& o) { o.entry = {0.5, 0.5, 2.0}; });   // blocked
  expect_refused([](CatheterOptions& o) { o.entry = {-5.0, 0.5, 2.0}; });  // outside
  expect_refused([](CatheterOptions& o) { o.entry = {2.5, 2.5, 12.8}; });  // at the end wall
  Environment plane(generate_rectangle({}));
  EXPECT_THROW(Catheter(plane, in_pipe(5.0)), InvalidArgument);

  Catheter c(environment, in_pipe(5.0));
  c.step({2.2});
  const std::string before = c.state_hash().hex();
  EXPECT_THROW(c.step({nan}), InvalidArgument);
  EXPECT_THROW(c.step({0.0, 7.0}), InvalidArgument);
  EXPECT_THROW(c.step({0.0, nan}), InvalidArgument);
  EXPECT_THROW(c.step({0.0, 0.0, {1e9, 0.0, 0.0}}), InvalidArgument);
  EXPECT_EQ(c.state_hash().hex(), before);
  environment.move(std::vector<Vec3>(environment.positions().begin(), environment.positions().end()));
  environment.move(std::vector<Vec3>(environment.positions().begin(), environment.positions().end()));
  EXPECT_THROW(c.step({0.1}), InvalidArgument);
  EXPECT_EQ(c.state_hash().hex(), before);
}

// A cell ahead is blocked: the catheter follows the edit, and stops there.
TEST(Catheter, FollowsEdits) {
  Environment environment(test::pipe(14));
  Catheter c(environment, in_pipe(9.0));
  c.step({2.0});
  std::vector<Cell> ahead;  // the cells of a layer, from z = 6 to 7
  for (const double x : {1.5, 2.5, 3.5}) {
    for (const double y : {1.5, 2.5, 3.5}) ahead.push_back(environment.locate({x, y, 6.5}).simplex.cell);
  }
  environment.edit([&](ComplexEdit& edit) {
    for (const Cell cell : ahead) edit.topology().set_free(cell, false);
  });
  EXPECT_THROW(c.step({0.1}), InvalidArgument);
  c.update_after_edit();
  for (int i = 0; i < 40; ++i) c.step({0.2});
  EXPECT_LE(c.inserted(), 4.0 * 1.01);
  EXPECT_GE(c.inserted(), 3.9);
  expect_in_lumen(environment, c);
}

}  // namespace dartcast::catheter_test
