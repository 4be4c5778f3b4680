// Ligatures: flooding shows that they seal, a motion that they can be drawn together.
#include <algorithm>
#include <cmath>

#include "base/random.hpp"
#include "dartcast/cutting.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "support/expectations.hpp"
#include "support/surgery_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::ligature_test {

// A straight trunk, two branches.
VesselOptions small_vessel() {
  VesselOptions o;
  o.core = 2;
  o.rings = 1;
  o.out_of_plane = 0.0;
  return o;
}

// The free cell at one of the vessel's ends.
Cell end_of(const CellComplex& complex, const char* patch) {
  const Patch wanted = complex.map().patch(patch);
  for (const Cell c : complex.map().cells()) {
    for (std::uint16_t f = 0; f < complex.map().shape(c).face_count(); ++f) {
      if (complex.map().is_free(c) && complex.map().patch({c, f}) == wanted) return c;
    }
  }
  throw InvalidArgument("no such end");
}

TEST(Ligature, SealsAVessel) {
  CellComplex complex(generate_vessel(small_vessel()));
  const Cell inlet = end_of(complex, "inlet");
  const Cell left = end_of(complex, "outlet_left");
  const Cell right = end_of(complex, "outlet_right");
  Random random(2);
  for (int i = 0; i < std::max(1, test::scaled(10, 300)); ++i) {
    SCOPED_TRACE(i);
    const double z = random.uniform(-20e-3, -6e-3);
    const Plane plane =
        plane_through({0, 0, z}, {random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), 1.0 - 2.0 * (i % 2)});
    ComplexEdit edit(complex);
    const std::vector<Cell> tied = ligature(edit, plane, Vec3{0, 0, z});
    EXPECT_TRUE(edit.commit().placed.empty());
    test::expect_sound(complex);
    EXPECT_EQ(test::count_rooms(complex.map()), 2U);
    EXPECT_FALSE(test::flood(complex.map(), inlet).contains(left.value));
    EXPECT_TRUE(test::flood(complex.map(), left).contains(right.value));
    EXPECT_LT(tied.size(), 300U);
    ComplexEdit untie(complex);
    for (const Cell c : tied) untie.topology().set_free(c, true);
    untie.commit();
    EXPECT_EQ(test::count_rooms(complex.map()), 1U);
  }
}

// A plane that crosses both branches: only the one at the place is tied.
TEST(Ligature, TiesOneBranchOfTwo) {
  CellComplex complex(generate_vessel(small_vessel()));
  const Cell inlet = end_of(complex, "inlet");
  const Cell left = end_of(complex, "outlet_left");
  const Cell right = end_of(complex, "outlet_right");
  ComplexEdit edit(complex);
  ligature(edit, plane_through({0, 0, 18e-3}, {0, 0, 1}), Vec3{-12e-3, 0, 18e-3});
  edit.commit();
  const auto reached = test::flood(complex.map(), inlet);
  EXPECT_FALSE(reached.contains(left.value));
  EXPECT_TRUE(reached.contains(right.value));
}

class Ligatures : public testing::TestWithParam<test::EditMesh> {};
INSTANTIATE_TEST_SUITE_P(Surgery, Ligatures, testing::ValuesIn(test::edit_meshes()),
                         [](const auto& i) { return std::string(i.param.name); });

double height_of(const CellComplex& complex, const Plane& plane, Cell c, bool highest) {
  const CellView v = complex.map().view(c);
  double h = highest ? -1e300 : 1e300;
  for (std::uint16_t k = 0; k < v.shape().corner_count(); ++k) {
    const double x = plane.height(complex.positions()[v.vertex(k).value]);
    h = highest ? std::max(h, x) : std::min(h, x);
  }
  return h;
}

// Planes through lattice points, too: cells that touch the plane, and faces that lie in it. Where all sections are tied
// no way leads from below to above.
TEST_P(Ligatures, SealWhereverThePlaneLies) {
  Random random(7);
  for (int i = 0; i < std::max(1, test::scaled(10, 300)); ++i) {
    SCOPED_TRACE(i);
    MeshData mesh = GetParam().make();
    mesh.free.clear();
    CellComplex complex(mesh);
    const Vec3 x = complex.positions()[random.below(static_cast<std::uint32_t>(complex.positions().size()))];
    const Vec3 normal = i % 2 == 0 ? Vec3{0, 0, 1} : Vec3{random.uniform(-1, 1), random.uniform(-1, 1), 1.0};
    const Plane plane = plane_through(x, normal);
    ComplexEdit edit(complex);
    std::size_t sections = 0;
    try {
      for (; sections < 100; ++sections) ligature(edit, plane, x);
    } catch (const InvalidArgument&) {
    }
    ASSERT_LT(sections, 100U);
    edit.commit();
    test::expect_sound(complex);
    for (const Cell c : complex.map().cells()) {
      if (!complex.map().is_free(c) || height_of(complex, plane, c, true) >= 0.0) continue;
      for (const std::uint32_t other : test::flood(complex.map(), c))
        ASSERT_LT(height_of(complex, plane, Cell(other), true), 0.0);
    }
  }
}

TEST(Ligature, DrawsWallsTogether) {
  Environment environment(generate_vessel(small_vessel()));
  CellComplex tied(generate_vessel(small_vessel()));
  const Plane plane = plane_through({0, 0, -12e-3}, {0, 0, 1});
  ComplexEdit edit(tied);
  const std::vector<Cell> section = ligature(edit, plane, Vec3{0, 0, -12e-3});
  edit.commit();
  std::vector<Vec3> positions(environment.positions().begin(), environment.positions().end());
  draw_together(tied, section, plane, {0.6, 4e-3}, positions);
  double narrowest = 1.0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3 old = environment.positions()[i];
    EXPECT_NEAR(positions[i].z, old.z, 1e-12);
    if (std::abs(old.z + 12e-3) >= 4e-3 || std::hypot(old.x, old.y) > 8e-3) EXPECT_EQ(positions[i], old);
    if (std::abs(old.z + 12e-3) < 0.5e-3 && std::abs(std::hypot(old.x, old.y) - 3e-3) < 0.2e-3)
      narrowest = std::min(narrowest, std::hypot(positions[i].x, positions[i].y));
  }
  EXPECT_LT(narrowest, 1.4e-3);
  EXPECT_GT(narrowest, 1.0e-3);
  EXPECT_EQ(environment.move_until_inverted(positions), 1.0);
  EXPECT_TRUE(environment.validity().valid());
}

TEST(Ligature, RefusesWithoutAChange) {
  CellComplex complex(test::blocked_box({3, 3, 3}));
  { ComplexEdit first(complex); }
  const test::Before before(complex);
  const Plane plane = plane_through({1.5, 1.5, 1.5}, {0, 0, 1});
  const std::vector<Cell> cells = complex.map().cells();
  ComplexEdit edit(complex);
  test::expect_parts(test::refusal([&] { ligature(edit, plane, Vec3{1, 1, 1}); }), {"invalid", "no free cell"});
  test::expect_parts(test::refusal([&] { ligature(edit, plane, cells[13]); }), {"invalid", "free cell"});
  test::expect_parts(test::refusal([&] { ligature(edit, plane, Cell(1, 999)); }), {"invalid", "free cell"});
  std::vector<Vec3> x(complex.positions().begin(), complex.positions().end());
  test::expect_parts(test::refusal([&] { draw_together(complex, {}, plane, {}, x); }), {"invalid", "no cells"});
  test::expect_parts(test::refusal([&] { draw_together(complex, cells, plane, {1.0, 1.0}, x); }), {"invalid", "share"});
  test::expect_parts(test::refusal([&] { draw_together(complex, cells, plane, {0.5, 0.0}, x); }), {"invalid", "reach"});
  before.expect_unchanged();
}

}  // namespace dartcast::ligature_test
