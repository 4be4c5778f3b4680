// The guarantees of a contact: unit normals, a particle near the contact's point, times that are right after a rebound.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/predicates.hpp"
#include "dartcast/response.hpp"
#include "support/meshes.hpp"
#include "support/particle_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::contacts_test {

void expect_unit_normals(const ContactList& list, const std::string& what) {
  for (const Contact& c : list.contacts) {
    for (const WallHit& wall : list.walls_of(c))
      ASSERT_NEAR(norm(wall.normal), 1.0, 1e-15) << what << ", particle " << c.particle;
  }
}

// A vertex lies on another one, or beyond the range: walls without area meet those with one.
TEST(Contacts, NormalsAreUnitVectorsWhereWallsHaveNoArea) {
  std::size_t contacts = 0;
  for (const CellType type : {CellType::hexahedron, CellType::tetrahedron}) {
    MeshData mesh = test::cubes(2, type);
    mesh.free.assign(mesh.cell_count(), 1);
    for (std::size_t c = 0; c < mesh.cell_count(); c += 3) mesh.free[c] = 0;
    std::vector<Vec3> start;
    for (const Vec3& p : mesh.points) {
      for (const double s : {0.0, 0.25, 0.5}) start.push_back(p + (Vec3{1, 1, 1} - p) * s);
    }
    const std::size_t stride = test::sanitized() ? 5 : 1;
    for (std::size_t v = 0; v < mesh.points.size(); v += stride) {
      for (std::size_t u = 0; u <= mesh.points.size(); u += stride) {
        Environment environment(mesh);
        Particles particles;
        environment.add(particles, start);
        std::vector<Vec3> moved = mesh.points;
        moved[v] = u < mesh.points.size() ? mesh.points[u] : Vec3{1e300, std::nan(""), 0.0};
        for (std::size_t q = 0; q < mesh.points.size(); q += 2 * stride) {
          environment.move(moved);
          const StepReport report = environment.advance(particles, std::vector<Vec3>(particles.size(), mesh.points[q]));
          expect_unit_normals(report.contacts, "vertex " + std::to_string(v) + " on " + std::to_string(u));
          if (testing::Test::HasFatalFailure()) return;
          contacts += report.contacts.contacts.size();
        }
      }
    }
  }
  EXPECT_GT(contacts, 1000U);
}

// A facet so thin that its cross product in doubles is 0, though its area is not.
TEST(Contacts, NormalsAreUnitVectorsOfThinWalls) {
  Random random(3);
  std::size_t contacts = 0;
  int scenes = 0;
  for (int i = 0; scenes < 20; ++i) {
    ASSERT_LT(i, 100000);
    const auto near_one = [&] { return 1.0 + 0x1p-52 * random.below(8); };
    const Vec3 u = {near_one(), near_one(), near_one()};
    const Vec3 v = {near_one(), near_one(), near_one()};
    if (cross(u, v) != Vec3{}) continue;
    MeshData mesh;
    mesh.points = {{0, 0, 0}, u, v, {1, -1, 0.5}};
    const Sign sign = orient3d(mesh.points[0], mesh.points[1], mesh.points[2], mesh.points[3]);
    if (sign == Sign::zero) continue;
    mesh.types = {CellType::tetrahedron};
    mesh.offsets = {0, 4};
    mesh.connectivity = {0, 1, 2, 3};
    if (sign == Sign::negative) std::swap(mesh.connectivity[0], mesh.connectivity[1]);
    ++scenes;
    Environment environment(mesh);
    Particles particles;
    environment.add(particles, mesh.points);
    ASSERT_EQ(particles.size(), 4U);
    for (int step = 0; step < 100; ++step) {
      std::vector<Vec3> targets;
      for (std::size_t k = 0; k < particles.size(); ++k)
        targets.push_back({random.uniform(-1, 2), random.uniform(-1, 2), random.uniform(-1, 2)});
      const StepReport report = environment.advance(particles, targets);
      expect_unit_normals(report.contacts, "step " + std::to_string(step));
      contacts += report.contacts.contacts.size();
    }
    EXPECT_EQ(audit(environment.complex(), particles).failed, 0U);
  }
  EXPECT_GT(contacts, 1000U);
}

// Cells whose sizes differ by up to 23 orders of magnitude from axis to axis: the particle ends near the contact's
// point.
TEST(Contacts, AParticleIsNeverFartherFromItsContactThanItsStart) {
  const std::vector<Vec3> sizes = {{1e-12, 1e5, 1e11}, {1e11, 1e-12, 1e5}, {1e5, 1e11, 1e-12}, {1e-3, 1.0, 1e3}};
  std::size_t contacts = 0;
  double farthest = 0.0;
  for (int scene = 0; scene < test::scaled(40, 2000); ++scene) {
    const Vec3 size = sizes[static_cast<std::size_t>(scene) % sizes.size()];
    Random random(static_cast<std::uint64_t>(scene));
    MeshData mesh = test::cubes(3, scene % 3 == 0 ? CellType::hexahedron : CellType::tetrahedron);
    const auto stretched = [&](const Vec3& p) { return Vec3{p.x * size.x, p.y * size.y, p.z * size.z}; };
    const double shear = scene % 2 == 0 ? 0.0 : 0.3;
    const auto place = [&](Vec3 p) {
      p = {p.x + shear * p.y, p.y + shear * p.z, p.z + shear * p.x};
      return stretched(p);
    };
    mesh.free.assign(mesh.cell_count(), 1);
    for (std::size_t c = 0; c < mesh.cell_count(); ++c) mesh.free[c] = random.below(5) != 0 ? 1 : 0;
    for (Vec3& p : mesh.points) p = place(p);
    Environment environment(mesh);
    Particles particles;
    std::vector<Vec3> start = test::random_points(200, {0, 0, 0}, {3, 3, 3}, random);
    for (Vec3& p : start) p = place(p);
    environment.add(particles, start);
    for (int step = 0; step < 10; ++step) {
      std::vector<Vec3> targets;
      std::vector<Vec3> before;
      for (std::size_t i = 0; i < particles.size(); ++i) {
        before.push_back(particles[i].position);
        targets.push_back(before.back() + place({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}));
      }
      const StepReport report = environment.advance(particles, targets);
      for (const Contact& c : report.contacts.contacts) {
        const auto distance = [&](const Vec3& x) {
          return std::hypot(x.x - c.point.x, x.y - c.point.y, x.z - c.point.z);
        };
        const double unit = std::numeric_limits<double>::epsilon() *
                            std::max({std::abs(c.point.x), std::abs(c.point.y), std::abs(c.point.z)});
        const double off = distance(particles[c.particle].position);
        ASSERT_LE(off, std::max(distance(before[c.particle]), 256 * unit))
            << "scene " << scene << ", step " << step << ", particle " << c.particle;
        farthest = std::max(farthest, off / unit);
      }
      contacts += report.contacts.contacts.size();
    }
    ASSERT_EQ(audit(environment.complex(), particles).failed, 0U) << "scene " << scene;
  }
  EXPECT_GT(contacts, 500U);
}

// Between two parallel planes, turned so that no plane is level. The times of the rebounds are known.
TEST(Contacts, TimesAreRightAtTheSecondReboundOffAWall) {
  constexpr double bound = 0x1p-40;
  int second = 0;
  const int scenes = test::scaled(60, 2000);
  for (int scene = 0; scene < scenes; ++scene) {
    Random random(static_cast<std::uint64_t>(scene));
    const double a = random.uniform(0.1, 1.4);
    const double b = random.uniform(0.1, 1.4);
    const auto turned = [&](const Vec3& p) {
      const Vec3 q = {std::cos(a) * p.x - std::sin(a) * p.y, std::sin(a) * p.x + std::cos(a) * p.y, p.z};
      return Vec3{q.x, std::cos(b) * q.y - std::sin(b) * q.z, std::sin(b) * q.y + std::cos(b) * q.z};
    };
    MeshData mesh = test::cubes(1, CellType::hexahedron);
    for (Vec3& p : mesh.points) p = turned({100 * p.x - 50, 100 * p.y - 50, p.z});  // a slab of thickness 1
    Environment environment(mesh);
    Particles particles;
    const double height = random.uniform(0.1, 0.9);
    environment.add(particles, std::vector<Vec3>{turned({0, 0, height})});
    const double fall = random.uniform(4, 12);
    const Vec3 motion = turned({random.uniform(-3, 3), random.uniform(-3, 3), -fall});
    std::vector<Vec3> velocity = {motion};
    std::vector<ParticleStatus> fate(1);
    const WallResponses responses(WallResponse{WallResponseKind::reflect, 1.0, 0.0});
    const StepReport report = environment.advance(particles, std::vector<Vec3>{particles[0].position + motion},
                                                  respond_with(responses, velocity, fate, 1.0));
    for (std::size_t i = 0; i < report.contacts.contacts.size(); ++i) {
      const double expected = (height + static_cast<double>(i)) / fall;
      // Coordinates are rounded at a size of 100: it moves the planes by some 1e-14.
      ASSERT_NEAR(report.contacts.contacts[i].time_of_impact, expected, bound)
          << "scene " << scene << ", contact " << i;
      second += i >= 2 ? 1 : 0;
    }
  }
  EXPECT_GT(second, scenes);
}

}  // namespace dartcast::contacts_test
