// Scenes that stand still and deform, particles all over them, and answers to contacts of every kind.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/response.hpp"
#include "support/particle_checks.hpp"

namespace dartcast::test {

// Has a mesh, and where its vertices are at a step.
struct SteppedScene {
  std::string name;
  MeshData mesh;
  std::function<Vec3(const Vec3&, int step)> moved;  // none: it stands still
  double speed;                                      // of particles, length per step
  double lattice = 0.0;  // > 0: ways are along the lattice of halves instead, as far as that in each coordinate
};

// A swirl and a squeeze; every eighth step so strong that cells turn invalid.
inline Vec3 swirled(const Vec3& p, int step) {
  const double s = std::sin(0.3 * step);
  const double strong = step % 8 == 5 ? 2.5 : 1.0;
  return {p.x + 0.3 * strong * s * std::sin(p.y + p.z), p.y + 0.3 * s * std::sin(p.z + 2.0 * p.x),
          p.z * (1.0 + 0.05 * s)};
}

inline Vec3 sheared(const Vec3& p, int step) { return {p.x + 0.1 * std::sin(0.4 * step) * std::sin(p.y), p.y, p.z}; }

// Bends and pulses, as a vessel does. `p` in metres.
inline Vec3 pulsed(const Vec3& p, int step) {
  const double s = std::sin(0.5 * step);
  const double wide = 1.0 + 0.1 * s;
  return {p.x * wide + 2e-3 * s * std::sin(60.0 * p.z), p.y * wide, p.z};
}

inline std::vector<SteppedScene> make_scenes() {
  std::vector<SteppedScene> scenes;
  BoxOptions box;
  box.cells = {5, 4, 5};
  box.size = {5, 4, 5};
  box.mixed = true;
  box.blocked_share = 0.15;
  box.jitter = 0.3;
  scenes.push_back({"box", generate_box(box), {}, 1.5});
  scenes.push_back({"box that deforms", generate_box(box), swirled, 1.5});
  BoxOptions bar;
  bar.cells = {5, 5, 12};
  bar.size = {5, 5, 12};
  bar.blocked_layer = true;
  scenes.push_back({"bar that deforms", generate_box(bar), swirled, 3.0});
  MazeOptions maze;
  maze.rooms = {2, 2};
  maze.room_cells = 4;
  maze.size = {9, 9};
  scenes.push_back({"maze that deforms", generate_maze(maze), sheared, 2.0});
  VesselOptions vessel;
  vessel.core = 2;
  vessel.rings = 1;
  vessel.step_length = 1.5e-3;
  scenes.push_back({"vessel that deforms", generate_vessel(vessel), pulsed, 8e-3});
  return scenes;
}

// Particles all over the mesh, some at its vertices and edges, where several walls meet.
inline Particles scattered(Environment& environment, const MeshData& mesh, std::size_t count, Random& random) {
  Particles particles;
  Vec3 low = mesh.points.front();
  Vec3 high = low;
  for (const Vec3& p : mesh.points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  environment.add(particles, random_points(count, low, high, random));
  std::vector<Vec3> vertices;
  for (std::size_t i = 0; i < mesh.points.size(); i += 7) vertices.push_back(mesh.points[i]);
  environment.add(particles, vertices);
  return particles;
}

// Answers by the particle's number: reflects, slides, stays, goes straight on into the wall, or stops after some
// contacts. It remembers how many it has answered for each particle.
class Answers {
 public:
  explicit Answers(std::size_t particles) : counts_(particles) {}

  void set_answered(std::uint32_t particle, unsigned count) { counts_[particle] = count; }
  void start_step() { std::fill(counts_.begin(), counts_.end(), 0U); }

  AfterContact operator()(const Contact& c, std::span<const WallHit> walls, std::span<const WallHit> earlier) {
    const unsigned count = ++counts_[c.particle];
    switch (c.particle % 6) {
      case 0: return {slid(c.unused, walls, earlier), true};
      case 1: return {};
      case 2: return {c.unused * 0.5};
      case 3: return count < 3 ? AfterContact{reflected(c.unused, walls, 1.0, 0.0), true} : AfterContact{};
      case 4: return {reflected(c.unused, earlier, 0.9, 0.1)};
      default: break;
    }
    std::vector<WallHit> together(earlier.end() - c.together, earlier.end());
    together.insert(together.end(), walls.begin(), walls.end());
    return {reflected(c.unused, c.last ? walls : together, 1.0, 0.05), true};
  }

 private:
  std::vector<unsigned> counts_;
};

}  // namespace dartcast::test
