// A response of one's own, and the forecast of a particle: wind-up mice that turn right at walls.
#include <cstdio>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/particle_state.hpp"

int main() {
  using namespace dartcast;
  Environment environment(generate_bar());
  Particles mice;
  environment.add(
      mice, std::vector<Vec3>{{2.5, 2.5, 0.0}, {2.5, 2.5, 3.5}, {1.7, 2.2, 20.0}});  // the first is in a blocked cell
  std::vector<Vec3> heading(mice.size(), Vec3{0.3, 0.1, 0.0});
  for (int step = 0; step < 100; ++step) {
    std::vector<Vec3> target;
    for (std::size_t i = 0; i < mice.size(); ++i) target.push_back(mice[i].position + heading[i]);
    environment.advance(mice, target, [&](const Contact& c, std::span<const WallHit> walls, std::span<const WallHit>) {
      Vec3& h = heading[c.particle];
      h = Vec3{h.y, -h.x, h.z};
      if (dot(h, walls.front().normal) < 0.0) h = -h;
      return AfterContact{};  // the rest of this step is lost
    });
  }
  for (const ParticleState& mouse : mice.states()) {
    const Forecast f = forecast(environment.map(), mouse, environment.complex().corners(mouse.at()));
    std::printf("%.3f %.3f %.3f in cell %u, heading for its face %u\n", mouse.position.x, mouse.position.y,
                mouse.position.z, environment.map().source(mouse.cell), f.face.face);
  }
}
