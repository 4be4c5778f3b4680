#include "simulation/polyline.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"

namespace dartcast::polyline_test {

Environment box(Vec3 size = {4, 4, 4}) {
  BoxOptions o;
  o.cells = {4, 4, 4};
  o.size = size;
  return Environment(generate_box(o));
}

TEST(Polyline, EndsAtTheLastPoint) {
  Environment environment = box();
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{0.5, 0.5, 0.5}, {1, 1, 1}});
  const std::vector<Vec3> targets = {{3.5, 0.5, 0.5}, {3.5, 3.5, 0.5}, {3.5, 3.5, 3.5},
                                     {2, 1, 1},       {2, 2, 1},       {1, 1, 1}};
  const StepReport report = advance_polyline(environment, particles, targets, 3);
  EXPECT_EQ(particles[0].position, targets[2]);
  EXPECT_EQ(particles[1].position, targets[5]);
  EXPECT_TRUE(report.contacts.contacts.empty());
  EXPECT_TRUE(report.stopped.empty());
  EXPECT_EQ(report.counters.particle_steps, 6U);
}

TEST(Polyline, EndsAtTheFirstContactWithItsTimeInTheWholeStep) {
  Environment environment = box();
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{3, 1.5, 1.5}, {1, 1.25, 1.75}});
  const std::vector<Vec3> targets = {
      {3.5, 1.5, 1.5},  {4.5, 1.5, 1.5}, {1, 1.5, 1.5},  // the second segment hits x = 4 halfway
      {-1, 1.25, 1.75}, {1, 1.25, 1.75}, {2, 2, 2}};     // the first hits x = 0 halfway
  const StepReport report = advance_polyline(environment, particles, targets, 3);
  ASSERT_EQ(report.contacts.contacts.size(), 2U);
  const auto& contacts = report.contacts.contacts;
  EXPECT_EQ(contacts[0].particle, 0U);
  EXPECT_EQ(contacts[1].particle, 1U);
  EXPECT_DOUBLE_EQ(contacts[0].time_of_impact, 0.5);
  EXPECT_DOUBLE_EQ(contacts[1].time_of_impact, 0.5 / 3);
  EXPECT_EQ(report.contacts.walls_of(contacts[0]).front().patch, environment.map().patch("xmax"));
  EXPECT_EQ(report.contacts.walls_of(contacts[1]).front().patch, environment.map().patch("xmin"));
  EXPECT_EQ(particles[0].position, (Vec3{4, 1.5, 1.5}));
  EXPECT_EQ(particles[1].position, (Vec3{0, 1.25, 1.75}));
  ASSERT_EQ(report.stopped.size(), 2U);
  EXPECT_EQ(report.stopped[0].unused, (Vec3{-3, 0, 0}));
  EXPECT_EQ(report.stopped[1].unused, (Vec3{2, 0.75, 0.25}));
}

TEST(Polyline, VerticesMoveWithTheFirstSegment) {
  Environment environment = box();
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{0.5, 1.5, 1.5}});
  std::vector<Vec3> moved(environment.positions().begin(), environment.positions().end());
  for (Vec3& p : moved) p.x += 1.0;  // the wall x = 0 sweeps over the particle
  environment.move(moved);
  const Vec3 rest = {0.5, 1.5, 1.5};
  const StepReport report = advance_polyline(environment, particles, std::vector<Vec3>{rest, rest}, 2);
  ASSERT_EQ(report.contacts.contacts.size(), 1U);
  EXPECT_DOUBLE_EQ(report.contacts.contacts[0].time_of_impact, 0.25);
  EXPECT_NEAR(particles[0].position.x, 1.0, 1e-12);
  EXPECT_NO_THROW(environment.advance(particles, std::vector<Vec3>{{1.5, 1.5, 1.5}}));
}

TEST(Polyline, RefusesWrongSizesAndNumbersAndChangesNothing) {
  Environment environment = box();
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{1, 1, 1}});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(advance_polyline(environment, particles, std::vector<Vec3>{{2, 2, 2}}, 2), InvalidArgument);
  EXPECT_THROW(advance_polyline(environment, particles, {}, 0), InvalidArgument);
  EXPECT_THROW(advance_polyline(environment, particles, std::vector<Vec3>{{2, 2, 2}, {nan, 1, 1}}, 2), InvalidArgument);
  EXPECT_EQ(particles[0].position, (Vec3{1, 1, 1}));
}

}  // namespace dartcast::polyline_test
