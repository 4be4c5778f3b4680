// Uses the core alone: an environment, one particle, one contact.
#include <cstdio>
#include <vector>

#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"

int main() {
  dartcast::Environment environment(dartcast::generate_bar());
  dartcast::Particles particles;
  environment.add(particles, std::vector<dartcast::Vec3>{{2.5, 2.5, 14.0}});
  const dartcast::StepReport report = environment.advance(particles, std::vector<dartcast::Vec3>{{5.5, 2.5, 14.0}});
  for (const dartcast::Contact& c : report.contacts.contacts)
    std::printf("t = %.2f at x = %.2f\n", c.time_of_impact, c.point.x);
  return 0;
}
