// The walls near a sphere, against all walls of the scene.
#include "dynamics/near_walls.hpp"

#include <set>

#include "dartcast/complex_edit.hpp"
#include "support/element_checks.hpp"
#include "support/sphere_checks.hpp"

namespace dartcast::near_walls_test {

using test::cubes;
using test::scaled;
using test::Swarm;

// Every wall that the sphere touches before it comes to another is found.
TEST(NearWalls, FindsWhatIsTouchedFirst) {
  const std::array<CellType, 3> types = {CellType::hexahedron, CellType::tetrahedron, CellType::pyramid};
  NearWalls near;
  int touched = 0;
  for (std::size_t k = 0; k < types.size(); ++k) {
    Swarm swarm(cubes(7, types[k], 0.05, 0.3, k + 1), k);
    swarm.fill(static_cast<std::size_t>(std::max(5, scaled(40, 400))), 0.3, {0, 0, 0}, {7, 7, 7}, 0.0);
    const auto walls = test::all_walls(swarm.environment.complex(), false);
    for (std::size_t i = 0; i < swarm.radii.size(); ++i) {
      const Vec3 x = swarm.particles[i].position;
      const MovingSphere sphere = {x, x + swarm.vector(i % 3 == 0 ? 6.0 : 1.0), 0.3};
      std::optional<double> found;
      for (const NearWall& w : near.search(swarm.environment.complex(), swarm.particles[i].cell, sphere, false)) {
        const auto touch = first_touch(sphere, w.corners);
        if (touch && (!found || touch->time < *found)) found = touch->time;
      }
      std::optional<double> truth;
      for (const MovingTriangle& w : walls) {
        const auto touch = first_touch(sphere, w);
        if (touch && (!truth || touch->time < *truth)) truth = touch->time;
      }
      ASSERT_EQ(found, truth);
      touched += truth ? 1 : 0;
    }
  }
  EXPECT_GT(touched, 3);
}

TEST(NearWalls, TheNearestPlacesOfABox) {
  Swarm swarm(cubes(4));
  swarm.add({0.75, 1.5, 2.25}, 0.5);
  NearWalls near;
  const auto features = walls_within(swarm.environment.complex(), swarm.particles[0], 1.8, near);
  ASSERT_EQ(features.size(), 3U);
  EXPECT_EQ(features[0].point, (Vec3{0, 1.5, 2.25}));
  EXPECT_EQ(features[1].point, (Vec3{0.75, 0, 2.25}));
  EXPECT_EQ(features[2].point, (Vec3{0.75, 1.5, 4}));
  EXPECT_EQ(features[0].normal, (Vec3{1, 0, 0}));
  EXPECT_EQ(features[2].normal, (Vec3{0, 0, -1}));
  for (const WallFeature& f : features) {
    EXPECT_EQ(f.kind, Kind::face);
    EXPECT_EQ(f.displacement, (Vec3{}));
    EXPECT_TRUE(swarm.environment.map().view(f.face.cell).is_wall(f.face.face));
    EXPECT_EQ(f.patch, swarm.environment.map().patch(f.face));
  }
  EXPECT_EQ(walls_within(swarm.environment.complex(), swarm.particles[0], 0.75, near).size(), 1U);
  EXPECT_TRUE(walls_within(swarm.environment.complex(), swarm.particles[0], 0.7, near).empty());
}

TEST(NearWalls, EdgesAndCornersAreOnePlaceEach) {
  MeshData mesh = cubes(5, CellType::tetrahedron, 0.0, 0.0, 1);
  mesh.free.assign(mesh.cell_count(), 1);
  for (std::size_t t = 0; t < 6; ++t) mesh.free[6 * (2 + 5 * (2 + 5 * 2)) + t] = 0;  // the cube [2, 3]^3
  Swarm swarm(mesh);
  swarm.add({3.5, 2.4, 3.25}, 0.1);
  swarm.add({3.5, 3.25, 3.25}, 0.1);
  swarm.add({2.5, 2.5, 3.5}, 0.1);
  NearWalls near;
  const auto places = [&](std::size_t i) {
    const auto features = walls_within(swarm.environment.complex(), swarm.particles[i], 0.9, near);
    EXPECT_EQ(features.size(), 1U);
    return features[0];
  };
  EXPECT_EQ(places(0).kind, Kind::edge);
  EXPECT_LE(norm(places(0).point - Vec3{3, 2.4, 3}), 1e-15);
  EXPECT_EQ(places(1).kind, Kind::vertex);
  EXPECT_EQ(places(1).point, (Vec3{3, 3, 3}));
  EXPECT_EQ(places(2).kind, Kind::edge);  // of two tetrahedra, in one plane
}

// Behind a wall nothing is found; through a gap it is.
TEST(NearWalls, WallsBehindWallsAreNotReached) {
  MeshData mesh = cubes(5);
  mesh.free.assign(mesh.cell_count(), 1);
  for (std::size_t j = 0; j < 25; ++j) mesh.free[2 + 5 * j] = 0;  // the layer 2 < x < 3
  Swarm swarm(mesh);
  swarm.add({1.5, 2.5, 2.5}, 0.1);
  NearWalls near;
  const auto search = [&] {
    std::set<double> planes;
    for (const NearWall& w : near.search(swarm.environment.complex(), swarm.particles[0].cell,
                                         {{1.5, 2.5, 2.5}, {1.5, 2.5, 2.5}, 2.2}, false))
      if (w.corners.to[0].x == w.corners.to[1].x && w.corners.to[0].x == w.corners.to[2].x)
        planes.insert(w.corners.to[0].x);
    return planes;
  };
  EXPECT_EQ(search(), (std::set<double>{0.0, 2.0}));
  swarm.environment.edit([&](ComplexEdit& edit) {
    for (const Cell c : edit.map().cells())
      if (edit.map().source(c) == 2 + 5 * (3 + 5 * 2)) edit.topology().set_free(c, true);
  });
  EXPECT_EQ(search(), (std::set<double>{0.0, 2.0, 3.0}));
}

TEST(NearWalls, DisplacementsOfTheLastMove) {
  Swarm swarm(cubes(3));
  swarm.add({1.5, 1.5, 0.5}, 0.1);
  auto next = swarm.environment.next_positions();
  for (std::size_t i = 0; i < next.size(); ++i) {
    next[i] = swarm.environment.positions()[i];
    next[i].z += 0.1 * next[i].x;
  }
  swarm.environment.move();
  swarm.environment.advance(swarm.particles, std::vector<Vec3>{swarm.particles[0].position});
  NearWalls near;
  for (const bool moved : {false, true}) {
    const auto features = walls_within(swarm.environment.complex(), swarm.particles[0], 0.6, near, moved);
    ASSERT_FALSE(features.empty());
    EXPECT_NEAR(features[0].displacement.z, moved ? 0.1 * features[0].point.x : 0.0, 1e-14);
  }
}

// The cost is that of the cells reached, however large the scene.
TEST(NearWalls, CellsReachedDoNotGrowWithTheScene) {
  std::array<std::size_t, 3> reached{};
  const std::array<std::uint32_t, 3> sizes = {8, test::sanitized() ? 12U : 16U, test::sanitized() ? 16U : 40U};
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    Swarm swarm(cubes(sizes[k]));
    NearWalls near;
    Random random(1);
    for (int i = 0; i < 50; ++i) {
      const Vec3 x = {random.uniform(3, 5), random.uniform(3, 5), random.uniform(3, 5)};
      swarm.add(x, 0.2);
      near.search(swarm.environment.complex(), swarm.particles[swarm.particles.size() - 1].cell, {x, x, 0.2}, false);
      reached[k] += near.cells_reached().size();
      EXPECT_LE(near.cells_reached().size(), 8U);
    }
  }
  EXPECT_EQ(reached[0], reached[1]);
  EXPECT_EQ(reached[0], reached[2]);
  // A long way in a diagonal: the cells along it, not the box around it.
  const std::uint32_t cells = sizes[2];
  const double end = cells - 0.5;
  Swarm swarm(cubes(cells));
  swarm.add({0.5, 0.5, 0.5}, 0.2);
  NearWalls near;
  near.search(swarm.environment.complex(), swarm.particles[0].cell, {{0.5, 0.5, 0.5}, {end, end, end}, 0.2}, false);
  EXPECT_LE(near.cells_reached().size(), cells * 30U);
}

}  // namespace dartcast::near_walls_test
