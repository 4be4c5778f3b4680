#include "dartcast/audit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "base/random.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "oracle/oracle.hpp"

namespace dartcast::audit_test {

constexpr double tiniest = 0x1p-300;

// One tetrahedron with a particle on its base.
struct OneTetrahedron {
  OneTetrahedron() : environment(mesh()), complex(environment.complex()) {
    environment.add(particles, std::vector<Vec3>{{0.25, 0.25, 0.0}});
  }
  static MeshData mesh() {
    MeshData m;
    m.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    m.add_cell(CellType::tetrahedron, std::vector<std::uint32_t>{0, 1, 2, 3});
    return m;
  }
  void move_to(const std::vector<Vec3>& points) {
    std::copy(points.begin(), points.end(), complex.next_positions().begin());
    complex.commit_positions();
  }

  Environment environment;
  Particles particles;
  CellComplex complex;  // to be moved away from the particle
};

TEST(Audit, AcceptsAParticleOnTheBorder) {
  OneTetrahedron scene;
  const Audit result = audit(scene.complex, scene.particles);
  EXPECT_EQ(result.checked, 1U);
  EXPECT_EQ(result.failed, 0U);
  EXPECT_TRUE(result.first.empty());
}

TEST(Audit, FindsAParticleOutsideByTheSmallestCoordinateThatCounts) {
  OneTetrahedron scene;
  scene.move_to({{0, 0, tiniest}, {1, 0, tiniest}, {0, 1, tiniest}, {0, 0, 1}});
  const Audit result = audit(scene.complex, scene.particles);
  EXPECT_EQ(result.failed, 1U);
  EXPECT_NE(result.first.find("particle 0 at (0.25, 0.25, 0), cell 0"), std::string::npos) << result.first;
  EXPECT_NE(result.first.find("outside"), std::string::npos) << result.first;
  const double less = 0.5 * tiniest;
  scene.move_to({{0, 0, less}, {1, 0, less}, {0, 1, less}, {0, 0, 1}});
  EXPECT_EQ(audit(scene.complex, scene.particles).failed, 0U) << "it counts as 0";
}

TEST(Audit, FindsSimplicesThatAreFlatOrInverted) {
  OneTetrahedron scene;
  scene.move_to({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0.5, 0}});
  EXPECT_NE(audit(scene.complex, scene.particles).first.find("not positive"), std::string::npos);
  scene.move_to({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}});
  EXPECT_NE(audit(scene.complex, scene.particles).first.find("not positive"), std::string::npos);
  scene.move_to({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, std::numeric_limits<double>::quiet_NaN()}});
  EXPECT_NE(audit(scene.complex, scene.particles).first.find("not finite"), std::string::npos);
}

TEST(Audit, FindsBlockedAndMissingCells) {
  OneTetrahedron scene;
  scene.complex.map().set_free(scene.particles[0].cell, false);
  EXPECT_NE(audit(scene.complex, scene.particles).first.find("blocked"), std::string::npos);
  const CellComplex hexahedra(generate_box({}));
  EXPECT_NE(audit(hexahedra, scene.particles).first.find("no such cell"), std::string::npos);
}

TEST(Audit, AcceptsAHeldParticleInAFreeCell) {
  OneTetrahedron scene;
  scene.environment.move(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}});
  const auto report = scene.environment.advance(scene.particles, std::vector<Vec3>{{0.25, 0.25, 0.1}});
  ASSERT_EQ(report.held.size(), 1U);
  EXPECT_EQ(audit(scene.environment.complex(), scene.particles).failed, 0U);
}

// Particles stay while the lattice they were put into jumps by a unit or by a rounding: the oracle says who is outside.
TEST(Audit, AgreesWithTheOracleOnALattice) {
  BoxOptions box;
  box.cells = {3, 3, 3};
  box.size = {3, 3, 3};
  const MeshData mesh = generate_box(box);
  Environment environment(mesh);
  std::vector<Vec3> positions;
  for (int i = 0; i <= 6 * 6 * 6; ++i) positions.push_back({0.5 * (i % 7), 0.5 * (i / 7 % 7), 0.5 * (i / 49 % 7)});
  Particles particles;
  environment.add(particles, positions);
  ASSERT_EQ(particles.size(), positions.size());
  for (const double shift : {0.0, 0.5, -1.0, 0x1p-52, -0x1p-300}) {
    CellComplex moved = environment.complex();
    std::vector<Vec3> points = mesh.points;
    for (Vec3& p : points) p.x += shift;
    std::copy(points.begin(), points.end(), moved.next_positions().begin());
    moved.commit_positions();
    std::uint64_t outside = 0;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const Corners v = moved.corners(particles[i].at());
      MeshData one;
      one.points = {v[0], v[1], v[2], v[3]};
      one.add_cell(CellType::tetrahedron, std::vector<std::uint32_t>{0, 1, 2, 3});
      outside += oracle::Oracle(one).contains(0, particles[i].position) ? 0 : 1;
    }
    EXPECT_EQ(audit(moved, particles, Threads{2}).failed, outside) << shift;
    if (shift == -1.0) EXPECT_GT(outside, 0U);
  }
}

}  // namespace dartcast::audit_test
