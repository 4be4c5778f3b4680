// The faces that a box reaches, and the boxes of walls that move: against a look at each of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "base/random.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/remeshing.hpp"
#include "dynamics/moving_walls.hpp"
#include "dynamics/reached_faces.hpp"
#include "support/meshes.hpp"
#include "support/random_vectors.hpp"

namespace dartcast::reach_test {

using test::cubes;
using test::random_vector;

// Whether all of some points, before and after, lie beyond one side of the box.
bool misses(std::span<const std::uint16_t> points, const CellView& cell, std::span<const Vec3> before,
            std::span<const Vec3> after, const detail::MovingBox& box) {
  const auto all = [&](auto&& beyond) {
    return std::all_of(points.begin(), points.end(), [&](std::uint16_t p) {
      const std::size_t v = cell.vertex(p).value;
      return beyond(before[v]) && beyond(after[v] - box.shift);
    });
  };
  return all([&](const Vec3& x) { return x.x < box.low.x; }) || all([&](const Vec3& x) { return x.x > box.high.x; }) ||
         all([&](const Vec3& x) { return x.y < box.low.y; }) || all([&](const Vec3& x) { return x.y > box.high.y; }) ||
         all([&](const Vec3& x) { return x.z < box.low.z; }) || all([&](const Vec3& x) { return x.z > box.high.z; });
}

TEST(Reach, FacesOfEachTypeWithEachInstructionSet) {
  Random random(3);
  for (const CellType type : {CellType::hexahedron, CellType::tetrahedron, CellType::pyramid, CellType::prism}) {
    const CellComplex complex(cubes(2, type, 0.05, 0.0, 1), Threads{1});
    const std::span<const Vec3> before = complex.positions();
    std::vector<Vec3> after;
    for (const Vec3& x : before) after.push_back(x + random_vector(random, 0.3));
    for (int k = 0; k < 40; ++k) {
      detail::MovingBox box;
      box.low = Vec3{1, 1, 1} + random_vector(random, 1.2);
      box.high = box.low + Vec3{random.uniform(0, 0.5), random.uniform(0, 0.5), random.uniform(0, 0.5)};
      box.shift = random_vector(random, 0.3);
      for (const Cell c : complex.map().cells()) {
        const CellView cell = complex.map().view(c);
        std::uint64_t expected = 0;
        for (std::uint16_t f = 0; f < cell.shape().face_count(); ++f) {
          const bool missed = misses(cell.shape().corners(f), cell, before, after, box);
          expected |= std::uint64_t{!missed} << f;
        }
        for (const auto set : {detail::InstructionSet::portable, detail::best_instruction_set()}) {
          ASSERT_EQ(detail::reached_faces(cell.shape(), cell.vertices().data(), before.data(), after.data(), box, set),
                    expected);
        }
      }
    }
  }
}

// After moves and an edit, too.
TEST(Reach, WallsWhoseBoxesMeetAWay) {
  Random random(5);
  Environment environment(cubes(6, CellType::hexahedron, 0.05, 0.3, 2), Threads{1});
  MovingWalls walls;
  for (std::uint64_t move = 0; move < 6; ++move) {
    if (move == 3) environment.edit([&](ComplexEdit& e) { subdivide(e, *environment.map().cells().begin()); });
    std::vector<Vec3> next;
    for (const Vec3& x : environment.positions()) next.push_back(x + random_vector(random, 0.1));
    environment.move(next);
    const CellComplex& complex = environment.complex();
    walls.update(complex, {1, environment.edit_count()}, Threads{1});
    for (int k = 0; k < 50; ++k) {
      const Vec3 from = Vec3{3, 3, 3} + random_vector(random, 3.0);
      const Vec3 to = from + random_vector(random, 0.5);
      const Box way = join({from, from}, {to, to});
      std::set<std::pair<std::uint32_t, std::uint16_t>> found;
      walls.all_near(complex, from, to, [&](const NearWall& w) {
        found.insert({w.face.cell.value, w.face.face});
        return true;
      });
      for (const Cell c : complex.map().cells()) {
        const CellView cell = complex.map().view(c);
        for (std::uint16_t f = 0; cell.is_free() && f < cell.shape().face_count(); ++f) {
          if (!cell.is_wall(f)) continue;
          Box box{complex.positions()[cell.vertex(cell.shape().corners(f)[0]).value], {}};
          box.high = box.low;
          for (const std::uint16_t p : cell.shape().corners(f)) {
            for (const auto& x : {complex.positions(), complex.previous_positions()})
              box = join(box, {x[cell.vertex(p).value], x[cell.vertex(p).value]});
          }
          ASSERT_EQ(found.contains({c.value, f}), overlap(box, way));
        }
      }
    }
  }
}

}  // namespace dartcast::reach_test
