// The shortest simulation: a particle in a box of cells, and the walls that it meets in one step.
#include <cstdio>

#include "dartcast/generators.hpp"
#include "dartcast/simulation.hpp"

int main() {
  dartcast::Environment environment(dartcast::generate_bar());
  dartcast::Simulation simulation(environment, {.dt = 0.1, .response = dartcast::Reflect{0.5}});
  simulation.add({{2.5, 2.5, 14.0}}, {30.0, 0.0, 1.0});
  for (const auto& c : simulation.step().contacts()) std::printf("t = %.3f at x = %.3f\n", c.time_of_impact, c.point.x);
}
