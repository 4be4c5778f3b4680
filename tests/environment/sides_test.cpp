// A particle on a wall stays on its side of it, whatever edits make of the cells on both sides.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "dartcast/audit.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/map_edits.hpp"
#include "support/edit_meshes.hpp"
#include "support/particle_checks.hpp"
#include "support/random_edits.hpp"
#include "support/tier.hpp"

namespace dartcast::sides_test {

constexpr std::uint32_t edge = 3;

// Cubes of edge 1, or squares; every face between two of them is a wall.
Environment walled(bool flat) {
  MeshData mesh;
  if (flat) {
    RectangleOptions o;
    o.cells = {edge, edge};
    o.size = {edge, edge};
    mesh = generate_rectangle(o);
  } else {
    BoxOptions o;
    o.cells = {edge, edge, edge};
    o.size = {edge, edge, edge};
    mesh = generate_box(o);
  }
  return Environment(mesh, Threads{1});
}

void open_all(Environment& environment) {
  environment.edit([&](ComplexEdit& e) {
    for (bool more = true; more;) {
      more = false;
      for (const Cell c : e.map().cells()) {
        for (std::uint16_t f = 0; f < e.map().shape(c).face_count() && !more; ++f) {
          if (!e.map().view(c).neighbour(f).valid()) continue;
          unsew(e.topology(), CellFace{c, f});
          more = true;
        }
        if (more) break;
      }
    }
  });
}

// The cube that a cell is a part of.
std::array<int, 3> cube_of(const Environment& environment, Cell c) {
  Vec3 sum;
  double count = 0.0;
  for (const std::uint32_t v : environment.map().view(c).vertices()) {
    sum += environment.complex().positions()[v];
    count += 1.0;
  }
  const Vec3 mean = sum * (1.0 / count);
  return {static_cast<int>(mean.x), static_cast<int>(mean.y), static_cast<int>(mean.z)};
}

class Sides : public testing::TestWithParam<bool> {};

TEST_P(Sides, AreKeptWhereBothAreReplaced) {
  std::size_t on_walls = 0;
  for (int run = 0; run < test::scaled(20, 1000); ++run) {
    Environment environment = walled(GetParam());
    open_all(environment);
    Random random(static_cast<std::uint64_t>(run));
    Particles particles;
    std::vector<Vec3> targets;
    for (const Cell c : environment.map().cells()) {
      const auto [i, j, k] = cube_of(environment, c);
      const double z = GetParam() ? 0.0 : k + 0.25;
      for (const Vec3& way :
           {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{1, 1, 0}, Vec3{-1, -1, 0}}) {
        const std::vector<Vec3> start = {{i + 0.5, j + 0.5, z}};
        environment.add(particles, start);
        targets.push_back(start[0] + way);
      }
    }
    environment.advance(particles, targets);
    std::vector<std::array<int, 3>> cubes;
    for (const ParticleState& s : particles.states()) {
      cubes.push_back(cube_of(environment, s.cell));
      on_walls += s.position.x == std::floor(s.position.x) || s.position.y == std::floor(s.position.y) ? 1 : 0;
    }
    test::CellBag bag(environment.map());
    for (int step = 0; step < 6; ++step) {
      try {
        bag.update(environment
                       .edit([&](ComplexEdit& e) {
                         for (int n = 0; n < 40; ++n) {
                           constexpr std::array<test::EditKind, 3> kinds = {
                               test::EditKind::split_edge, test::EditKind::split_face, test::EditKind::split_cell};
                           const auto cells = e.map().cells();
                           const Cell c = cells[random.below(static_cast<std::uint32_t>(cells.size()))];
                           const auto kind = test::in_dimension(kinds[random.below(3)], GetParam() ? 2 : 3);
                           const Transaction::Savepoint before = e.savepoint();
                           try {
                             test::apply(e.topology(), test::draw_edit(e.map(), kind, c, bag, random));
                           } catch (const Error&) {
                             e.roll_back(before);
                           }
                         }
                       })
                       .map);
      } catch (const EditRefused&) {
        continue;
      }
      ASSERT_TRUE(environment.update_after_edit(particles).orphaned.empty());
      for (std::size_t i = 0; i < particles.size(); ++i)
        ASSERT_EQ(cube_of(environment, particles[i].cell), cubes[i]) << "run " << run << ", particle " << i;
      const Audit found = audit(environment.complex(), particles);
      ASSERT_EQ(found.failed, 0U) << found.first;
      // Against their walls again: nobody gets through.
      ASSERT_EQ(environment.advance(particles, targets).stopped.size(), particles.size());
      for (std::size_t i = 0; i < particles.size(); ++i)
        ASSERT_EQ(cube_of(environment, particles[i].cell), cubes[i]) << "run " << run << ", particle " << i;
    }
  }
  if (!test::sanitized()) EXPECT_GT(on_walls, 100U);
}

INSTANTIATE_TEST_SUITE_P(SpaceAndPlane, Sides, testing::Bool(),
                         [](const auto& flat) { return flat.param ? "plane" : "space"; });

}  // namespace dartcast::sides_test
