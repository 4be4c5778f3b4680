// An environment from arrays of one's own, exact location, and a particle that is blocked.
#include <array>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "dartcast/environment.hpp"

int main() {
  using namespace dartcast;
  MeshData mesh;  // two tetrahedra on either side of the triangle 1 2 3; the upper one is blocked
  mesh.points = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}, {1.0, 1.0, 1.0}};
  mesh.add_cell(CellType::tetrahedron, std::array<std::uint32_t, 4>{0, 1, 2, 3});
  mesh.add_cell(CellType::tetrahedron, std::array<std::uint32_t, 4>{1, 4, 2, 3});
  mesh.free = {1, 0};
  Environment environment(mesh);

  const std::vector<Vec3> points = {{0.2, 0.2, 0.2}, {0.5, 0.25, 0.25}, {0.5, 0.5, 0.5}, {2.0, 0.0, 0.0}};
  const char* places[] = {"free", "blocked", "outside"};
  const char* kinds[] = {", at a vertex", ", on an edge", ", on a face", ", inside"};
  for (const Location& l : environment.locate(points)) {
    std::printf("%s%s\n", places[static_cast<int>(l.place)],
                l.place == Place::outside ? "" : kinds[static_cast<int>(l.kind)]);
  }

  Particles particles;
  environment.add(particles, points);  // those in free cells: two
  const StepReport report = environment.advance(particles, std::vector<Vec3>(particles.size(), Vec3{0.6, 0.6, 0.6}));
  for (const Contact& c : report.contacts.contacts) {
    const WallHit& wall = report.contacts.walls_of(c).front();
    std::printf("particle %u: t = %.4f, normal %.3f %.3f %.3f\n", c.particle, c.time_of_impact, wall.normal.x,
                wall.normal.y, wall.normal.z);
  }
}
