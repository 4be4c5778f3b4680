// A search that many elements share finds the touches that each finds by itself.
#include "solids/element_touches.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <tuple>

#include "dartcast/environment.hpp"
#include "support/element_checks.hpp"
#include "support/meshes.hpp"
#include "support/random_vectors.hpp"
#include "support/solid_scenes.hpp"
#include "support/tier.hpp"

namespace dartcast::element_touches_test {

using test::random_vector;

// Names of touches with their times.
auto keys_of(const std::vector<ElementTouch>& touches, double last) {
  std::vector<std::tuple<SolidContactKind, std::array<std::uint32_t, 3>, std::vector<std::uint32_t>, double>> keys;
  for (const ElementTouch& t : touches) {
    if (t.time > last) continue;
    std::vector<std::uint32_t> wall;
    for (unsigned i = 0; i < t.wall_count; ++i) wall.push_back(t.wall.vertex[t.corners[i]].value);
    std::sort(wall.begin(), wall.end());
    keys.emplace_back(t.kind, t.vertices, wall, t.time);
  }
  std::sort(keys.begin(), keys.end());
  return keys;
}

TEST(ElementTouches, ASharedSearchFindsTheSameFirstTouches) {
  Random random(5);
  int touched = 0;
  for (int k = 0; k < std::max(20, test::scaled(400, 10000)); ++k) {
    const auto type = k % 2 == 0 ? CellType::hexahedron : CellType::tetrahedron;
    Environment environment(test::cubes(4, type, 0.15, 0.2, static_cast<std::uint64_t>(k % 16)), Threads{1});
    SolidSet solids(environment);
    const Vec3 at = random_vector(random, 2.0) + Vec3{2.0, 2.0, 2.0};
    if (solids.add(test::moved(test::ball(random.uniform(0.05, 0.5), 1), at)).refusal != SolidRefusal::none) continue;
    const std::vector<Vec3> from(solids.positions().begin(), solids.positions().end());
    std::vector<Vec3> to = from;
    const Vec3 way = random_vector(random, 0.5);
    for (Vec3& x : to) x += way + random_vector(random, 0.02);
    std::vector<Vec3> walls(environment.positions().begin(), environment.positions().end());
    if (k % 3 != 0) walls = test::waved(environment.positions(), 0.05);
    std::vector<Vec3> after(environment.complex().positions().begin(), environment.complex().positions().end());
    std::copy(walls.begin(), walls.end(), after.begin());
    environment.complex().steiner_weights().compute(after);
    const VertexMotion motion = {environment.complex().positions(), after};
    SolidMesh mesh;
    mesh.points = from;
    mesh.triangles = test::ball(1.0, 1).triangles;
    const std::vector<SolidElement> elements = elements_of(mesh);
    std::vector<Cell> cells;
    for (const SolidElement& e : elements) cells.push_back(solids.particles()[e.vertex[0]].cell);
    TouchFinder finder;
    std::vector<ElementTouch> each;
    std::optional<double> flat;
    for (std::size_t i = 0; i < elements.size(); ++i) {
      const ElementGroup one = {{&elements[i], 1}, {&cells[i], 1}};
      const auto now = finder.find(environment.complex(), one, {from, to}, motion, each);
      if (now) flat = std::min(flat.value_or(*now), *now);
    }
    std::vector<ElementTouch> together;
    EXPECT_EQ(finder.find(environment.complex(), {elements, cells}, {from, to}, motion, together), flat);
    double first = 2.0;
    for (const ElementTouch& t : each) first = std::min(first, t.time);
    double first_together = 2.0;
    for (const ElementTouch& t : together) first_together = std::min(first_together, t.time);
    EXPECT_EQ(first_together, first);
    EXPECT_EQ(keys_of(together, first), keys_of(each, first));
    touched += first <= 1.0 ? 1 : 0;
  }
  EXPECT_GT(touched, test::sanitized() ? 0 : 30);
}

}  // namespace dartcast::element_touches_test
