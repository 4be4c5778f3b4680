// Cuts of a vessel: who can enter, and cuts anywhere.
#include <algorithm>

#include "base/random.hpp"
#include "dartcast/cutting.hpp"
#include "dartcast/generators.hpp"
#include "support/surgery_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::vessel_test {

using test::Dyadic;
using test::volume6;

// A slab through the tissue of a vessel opens the lumen into the gap.
TEST(VesselCuts, OpenTheLumen) {
  VesselOptions o;
  o.core = 2;
  o.out_of_plane = 0.0;
  o.rings = 1;
  CellComplex complex(generate_vessel(o));
  const double r = o.radius;
  Disc disc;
  disc.centre = {0, 0, -12e-3};
  disc.normal = {0.2, 0.1, 1.0};
  disc.radius = r + 0.7 * o.tissue_thickness;
  std::vector<Cell> cells = complex.map().cells();
  const Cell lumen = *std::find_if(cells.begin(), cells.end(), [&](Cell c) { return complex.map().is_free(c); });
  const auto tools = thicken(disc, 0.1e-3);
  const Dyadic before = volume6(complex);
  ComplexEdit edit(complex);
  Carved carved = cut(edit, cells_near(complex, tools), disc, 0.1e-3);
  carved.opened = test::now(edit.commit(), carved.opened);
  test::expect_sound(complex);
  ASSERT_FALSE(HasFatalFailure());
  ASSERT_GT(carved.opened.size(), 20U);
  EXPECT_TRUE(carved.whole.empty());
  const auto reached = test::flood(complex.map(), lumen);
  for (const Cell c : carved.opened) EXPECT_TRUE(reached.contains(c.value));
  EXPECT_EQ(test::count_rooms(complex.map()), 1U);
  EXPECT_TRUE(test::near(volume6(complex), before, 1e-9 * r * r * r));  // nothing on the outside was split
}

// Anywhere, at any angle, again and again: warped cells, cells cut before, ends in lumen, tissue and outside.
TEST(VesselCuts, AtRandom) {
  VesselOptions o;
  o.core = 2;
  o.rings = 1;
  const MeshData mesh = generate_vessel(o);
  Random random(12);
  CellComplex complex(mesh);
  int with_whole = 0;  // cuts that left a cell whole, whose section is no simple loop
  const auto direction = [&] { return Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}; };
  for (int i = 0; i < std::max(1, test::scaled(8, 200)); ++i) {
    SCOPED_TRACE(i);
    if (i % 8 == 0) complex = CellComplex(mesh);
    const std::vector<Cell> cells = complex.map().cells();
    const Vec3 x = complex.corners({cells[random.below(static_cast<std::uint32_t>(cells.size()))], 0})[0];
    const Vec3 n = plane_through({}, direction()).normal;
    std::vector<ConvexTool> tools;
    if (i % 4 == 0) tools = thicken(plane_through(x, n), 0.2e-3);
    if (i % 4 == 1) tools = thicken(Disc{x, n, 4e-3, 12}, 0.1e-3);
    if (i % 4 == 2) tools = {capsule_tool(x, x + n * 3e-3, 0.7e-3)};
    if (i % 4 == 3) {
      BladePath path;  // bends a little, and twists
      const Vec3 blade = plane_through({}, cross(n, direction())).normal * 3e-3;
      for (int k = 0; k < 4; ++k)
        path.places.push_back({x + n * (k * 1e-3) + Vec3{0, 0, 0.1e-3 * k * k}, x + blade + n * (k * 1e-3)});
      tools = thicken(path, 0.1e-3);
    }
    ComplexEdit edit(complex);
    const Carving what = i % 3 == 2 ? Carving::remove : Carving::open;
    const Carved carved = carve(edit, cells_near(complex, tools), tools, what);
    with_whole += carved.whole.empty() ? 0 : 1;
    edit.commit();
    test::expect_sound(complex);
    ASSERT_FALSE(HasFatalFailure());
  }
  EXPECT_LE(with_whole, test::scaled(0, 2));
}

}  // namespace dartcast::vessel_test
