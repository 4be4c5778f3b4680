// The cases that users of other systems report, run with this one. Each line says what happens here.
//
// docs/compare.md names the reports. Every case counts its failures; the program ends with 1 if there is one.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <span>
#include <vector>

#include "dartcast/audit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"

namespace {

using namespace dartcast;

std::size_t failures = 0;

void say(const char* name, std::size_t cases, std::size_t failed, const char* meaning) {
  std::printf("%-44s %6zu cases, %zu %s\n", name, cases, failed, meaning);
  failures += failed;
}

BoxOptions cubes(std::uint32_t n) {
  BoxOptions box;
  box.cells = {n, n, n};
  box.size = {double(n), double(n), double(n)};
  return box;
}

// Rays from the middle of a cube to all corners and middles of edges of its walls. A ray that slips between two
// triangles misses.
void cast_at_edges_and_vertices() {
  Environment environment(generate_box(cubes(4)));
  std::vector<Vec3> directions;
  for (int i = 0; i <= 8; ++i) {
    for (int j = 0; j <= 8; ++j) {
      for (int k = 0; k <= 8; ++k) {
        const Vec3 x = {0.5 * i, 0.5 * j, 0.5 * k};
        if (i % 8 == 0 || j % 8 == 0 || k % 8 == 0) directions.push_back(x - Vec3{2.0, 2.0, 2.0});
      }
    }
  }
  const std::vector<Vec3> origins(directions.size(), Vec3{2.0, 2.0, 2.0});
  const std::vector<RayHit> hits = environment.cast_rays(origins, directions);
  const auto missed = std::count_if(hits.begin(), hits.end(), [](const RayHit& h) { return !h.hit; });
  say("rays at edges and vertices of walls", hits.size(), static_cast<std::size_t>(missed), "missed");
}

// Moves particles to their targets many times, and counts those that an exact check does not find where they should be.
std::size_t failed_steps(Environment& environment, std::vector<Vec3> velocities, Particles& particles, int steps) {
  std::size_t failed = 0;
  for (int step = 0; step < steps; ++step) {
    std::vector<Vec3> targets(particles.size());
    for (std::size_t i = 0; i < targets.size(); ++i) targets[i] = particles[i].position + velocities[i];
    const StepReport report = environment.advance(particles, targets);
    for (const Contact& c : report.contacts.contacts) velocities[c.particle] = -velocities[c.particle];
    failed += audit(environment.complex(), particles).failed;
  }
  return failed;
}

// Particles that start at vertices, and run along edges, through vertices and over several cells a step.
void hop_along_edges() {
  Environment environment(generate_box(cubes(6)));
  Particles particles;
  std::vector<Vec3> velocities;
  for (int direction = 0; direction < 26; ++direction) {
    const int code = direction < 13 ? direction : direction + 1;  // all but (0, 0, 0)
    const Vec3 d = {double(code % 3) - 1.0, double(code / 3 % 3) - 1.0, double(code / 9) - 1.0};
    for (int k = 1; k <= 5; ++k) {
      environment.add(particles, std::vector<Vec3>{{double(k), 3.0, double(6 - k)}});
      velocities.push_back(d * 2.5);
    }
  }
  const std::size_t failed = failed_steps(environment, velocities, particles, 20);
  say("steps along edges, through vertices", 20 * particles.size(), failed, "lost or in a wrong cell");
}

// A box that is pressed flat, to a millionth of its height: all its cells are slivers.
void walk_in_slivers() {
  BoxOptions box = cubes(6);
  box.type = CellType::tetrahedron;
  box.jitter = 0.3;
  MeshData mesh = generate_box(box);
  for (Vec3& x : mesh.points) x.z *= 1e-6;
  Environment environment(mesh);
  Particles particles;
  std::vector<Vec3> velocities;
  for (int i = 0; i < 200; ++i) {
    const double u = std::fmod(0.6180339887 * i, 1.0);
    const double v = std::fmod(0.7548776662 * i, 1.0);
    environment.add(particles, std::vector<Vec3>{{5.8 * u + 0.1, 5.8 * v + 0.1, 6e-6 * std::fmod(u + v, 1.0)}});
    velocities.push_back({0.7 * (v - 0.5), 0.9 * (u - 0.5), 4e-6 * (u - v)});
  }
  const std::size_t failed = failed_steps(environment, velocities, particles, 30);
  say("steps in slivers", 30 * particles.size(), failed, "lost or in a wrong cell");
}

// A wall runs over particles that stand still. Those that it passed would be behind it.
void sweep_over_resting_particles() {
  MeshData mesh = generate_box(cubes(4));
  mesh.free.assign(64, 1);
  for (std::size_t c = 0; c < 64; ++c) mesh.free[c] = c % 4 == 3 ? 0 : 1;  // the wall x = 3
  Environment environment(mesh);
  Particles particles;
  for (int i = 0; i < 100; ++i)
    environment.add(particles, std::vector<Vec3>{{2.1 + 0.008 * i, 0.04 * i + 0.01, 0.039 * i + 0.02}});
  std::vector<Vec3> after(environment.positions().begin(), environment.positions().end());
  for (Vec3& x : after) x.x *= x.x == 3.0 ? 2.05 / 3.0 : x.x < 3.0 ? 0.6 : 1.0;
  std::vector<Vec3> rest;
  for (std::size_t i = 0; i < particles.size(); ++i) rest.push_back(particles[i].position);
  environment.move(after);
  environment.advance(particles, rest);
  const auto behind = std::count_if(particles.states().begin(), particles.states().end(),
                                    [](const ParticleState& s) { return s.position.x > 2.05; });
  const std::size_t failed = audit(environment.complex(), particles).failed;
  say("a wall runs over resting particles", particles.size(), static_cast<std::size_t>(behind) + failed,
      "passed by it");
}

}  // namespace

int main() {
  cast_at_edges_and_vertices();
  hop_along_edges();
  walk_in_slivers();
  sweep_over_resting_particles();
  return failures == 0 ? 0 : 1;
}
