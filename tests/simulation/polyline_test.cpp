#include "simulation/polyline.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"

namespace dartcast::polyline_test {

TEST(Polyline, ContactsHaveTheirTimeInTheWholeStep) {
  BoxOptions o;
  o.cells = {4, 4, 4};
  o.size = {4, 4, 4};
  Environment environment(generate_box(o));
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{3, 1.5, 1.5}, {1, 1.25, 1.75}});
  // The first particle meets x = 4 halfway in the second segment; the second meets x = 0 halfway in the first.
  const std::array<std::vector<Vec3>, 2> targets = {std::vector<Vec3>{{3.5, 1.5, 1.5}, {-1, 1.25, 1.75}},
                                                    std::vector<Vec3>{{4.5, 1.5, 1.5}, {0, 1.25, 1.75}}};
  StepReport report;
  for (std::size_t k = 0; k < 2; ++k) append_segment(report, environment.advance(particles, targets[k]), k, 2);
  ASSERT_EQ(report.contacts.contacts.size(), 2U);
  const std::vector<Contact>& contacts = report.contacts.contacts;
  EXPECT_EQ(contacts[0].particle, 0U);
  EXPECT_EQ(contacts[1].particle, 1U);
  EXPECT_DOUBLE_EQ(contacts[0].time_of_impact, 0.75);
  EXPECT_DOUBLE_EQ(contacts[1].time_of_impact, 0.25);
  EXPECT_EQ(report.contacts.walls_of(contacts[0]).front().patch, environment.map().patch("xmax"));
  EXPECT_EQ(report.contacts.walls_of(contacts[1]).front().patch, environment.map().patch("xmin"));
  EXPECT_EQ(report.counters.particle_steps, 4U);
}

}  // namespace dartcast::polyline_test
