// Moves that would invert cells: found before they are made, and made as far as all cells stay valid.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/validity.hpp"
#include "oracle/scenes.hpp"
#include "support/meshes.hpp"
#include "support/moving_simplex.hpp"
#include "support/particle_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::test::flattening_test {

std::vector<Vec3> copy(std::span<const Vec3> positions) { return {positions.begin(), positions.end()}; }

Environment box_of(std::uint32_t edge) { return Environment(cubes(edge), Threads{1}); }

// Every vertex in a direction of its own, by up to `size`.
std::vector<Vec3> shaken(std::span<const Vec3> positions, double size, Random& random) {
  std::vector<Vec3> all = copy(positions);
  for (Vec3& p : all) p += Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)} * size;
  return all;
}

// The volume of no simplex reaches zero on the way: exact, by another method.
bool stays_positive(const CellComplex& complex) {
  for (const Cell c : complex.map().cells()) {
    const CellView cell = complex.map().view(c);
    for (const ImplicitSimplex& s : cell.shape().simplices()) {
      Corners before;
      Corners after;
      for (unsigned i = 0; i < 4; ++i) {
        before[i] = complex.previous_positions()[cell.vertex(s.vertex[i]).value];
        after[i] = complex.positions()[cell.vertex(s.vertex[i]).value];
      }
      const MovingSimplex moving(before, after);
      if (moving.sign_of_volume(0.0) <= 0 || moving.has_root_by(1.0)) return false;
    }
  }
  return true;
}

TEST(SimplexInversion, AVertexPushedThroughItsCellIsStoppedWhereTheCellIsFlat) {
  Environment e = box_of(2);
  std::vector<Vec3> next = copy(e.positions());
  std::size_t middle = 0;
  while (next[middle] != Vec3{1, 1, 1}) ++middle;
  next[middle] = {1, 1, 3};  // the upper cells' ceiling is at 2
  const auto inversion = e.first_inversion(next);
  ASSERT_TRUE(inversion);
  EXPECT_GT(inversion->how.safe_time, 0.2);
  EXPECT_LE(inversion->how.safe_time, 0.5);
  EXPECT_NE(inversion->message.find("vertex " + std::to_string(middle)), std::string::npos) << inversion->message;
  const double time = e.move_until_inverted(next);
  EXPECT_LE(time, inversion->how.safe_time);
  EXPECT_GT(time, inversion->how.safe_time - 1e-9);
  EXPECT_TRUE(e.validity().valid());
  EXPECT_NEAR(e.positions()[middle].z, 1.0 + 2.0 * time, 1e-9);
}

TEST(SimplexInversion, AShareOfTheWayCanBeLeft) {
  Environment e = box_of(2);
  std::vector<Vec3> next = copy(e.positions());
  for (Vec3& p : next) p.z = 2.0 - p.z;  // turned inside out: flat in the middle
  EXPECT_NEAR(e.first_inversion(next)->how.safe_time, 0.5, 1e-9);
  EXPECT_NEAR(e.move_until_inverted(next, 0.5), 0.25, 1e-9);
  EXPECT_NEAR(e.positions().back().z, 1.5, 1e-9);
}

TEST(SimplexInversion, WhatHarmsNothingIsMadeWhole) {
  Environment e = box_of(2);
  Random random(1);
  const std::vector<Vec3> next = shaken(e.positions(), 0.05, random);
  EXPECT_FALSE(e.first_inversion(next));
  EXPECT_EQ(e.move_until_inverted(next), 1.0);
  EXPECT_TRUE(std::ranges::equal(e.positions(), next));
}

TEST(SimplexInversion, APositionTooFewIsRefused) {
  Environment e = box_of(2);
  std::vector<Vec3> next = copy(e.positions());
  next.pop_back();
  EXPECT_THROW((void)e.first_inversion(next), InvalidArgument);
  EXPECT_THROW(e.move_until_inverted(next), InvalidArgument);
}

// At its coordinates in the simplex, from the moment that the cell is valid again.
TEST(SimplexInversion, WhatIsAddedToSuchACellWaits) {
  const MeshData mesh = cubes(3);
  Environment environment(mesh, Threads{1});
  std::vector<Vec3> points = mesh.points;
  for (const bool finite : {true, false}) {
    points[0] = finite ? Vec3{2, 2, 2} : Vec3{std::nan(""), 0, 0};
    environment.move(points);
    const Cell cell = environment.validity().first.at(0).cell;
    const Weights weights = {0.125, 0.25, 0.5, 0.125};
    Particles particles;
    std::uint16_t simplex = 0;
    while (environment.add_at(particles, {cell, simplex}, weights)) ++simplex;
    ASSERT_GT(simplex, 0U);
    EXPECT_EQ(check_states(environment, particles), "");
    EXPECT_TRUE(particles[0].held || particles[simplex - 1U].held);
    EXPECT_THROW(environment.add_at(particles, {cell, 0}, {2, 0, 0, 0}), InvalidArgument);
    environment.move(mesh.points);
    std::vector<Vec3> places;
    for (const ParticleState& s : particles.states()) places.push_back(s.position);
    const StepReport report = environment.advance(particles, places);
    EXPECT_TRUE(report.held.empty());
    EXPECT_EQ(check_states(environment, particles), "");
    for (const ParticleState& s : particles.states()) EXPECT_FALSE(s.held);
  }
}

class FlatteningOf : public ::testing::TestWithParam<int> {};

// Wild motions, followed as far as they can be, again and again: the scene stays valid, and its particles in their
// cells.
TEST_P(FlatteningOf, WildMotionsLeaveAllCellsValidAndParticlesInTheirs) {
  const auto kind = static_cast<oracle::SceneKind>(GetParam());
  std::size_t stopped = 0;
  std::size_t whole = 0;
  for (std::uint64_t seed = 0; seed < std::max<std::uint64_t>(2, scaled(6, 300)); ++seed) {
    const MeshData mesh = oracle::random_scene(kind, seed, 0.2);
    if (!CellComplex(mesh).invalid_cells().empty()) continue;
    Environment e(mesh, Threads{1});
    Random random(seed, 5);
    Particles particles;
    std::vector<Vec3> inside;
    for (const Cell c : e.map().cells()) {
      const auto v = e.complex().corners({c, 0});
      inside.push_back((v[0] + v[1] + v[2] + v[3]) * 0.25);
    }
    e.add(particles, inside);
    for (int step = 0; step < 5; ++step) {
      const double edge = norm(e.positions()[1] - e.positions()[0]);
      const std::vector<Vec3> next = shaken(e.positions(), edge * std::exp2(random.uniform(-8.0, 1.0)), random);
      const bool flattens = e.first_inversion(next).has_value();
      const double time = e.move_until_inverted(next, random.uniform());
      EXPECT_EQ(time == 1.0, !flattens);
      EXPECT_TRUE(e.validity().valid()) << "seed " << seed << ", step " << step;
      EXPECT_TRUE(stays_positive(e.complex())) << "seed " << seed << ", step " << step;
      std::vector<Vec3> targets;
      for (const ParticleState& s : particles.states()) targets.push_back(s.position);
      const StepReport report = e.advance(particles, targets);
      EXPECT_TRUE(report.held.empty());
      (flattens ? stopped : whole) += 1;
    }
    EXPECT_EQ(audit(e.complex(), particles).failed, 0U) << "seed " << seed;
  }
  EXPECT_GT(stopped, 0U);
  EXPECT_GT(whole, 0U);
}

INSTANTIATE_TEST_SUITE_P(Scenes, FlatteningOf, ::testing::Range(0, oracle::scene_kinds), [](const auto& scene) {
  return oracle::name_of(static_cast<oracle::SceneKind>(scene.param));
});

}  // namespace dartcast::test::flattening_test
