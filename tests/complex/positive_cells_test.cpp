// The vectors' filter never calls a simplex positive that is not, and leaves few cells open.
#include "complex/positive_cells.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/random.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/validity.hpp"
#include "support/meshes.hpp"
#include "support/tier.hpp"

namespace dartcast::positive_cells_test {

using detail::InstructionSet;
using detail::not_proved_positive;

MeshData mesh_of(int which) {
  if (which == 5) return generate_octahedra({.cells = {2, 2, 2}, .size = Vec3{2, 2, 2}});
  BoxOptions o;
  o.cells = {3, 2, 2};
  o.size = {3, 2, 2};
  o.jitter = 0.2;
  test::set_kind(o, which);
  return generate_box(o);
}

// Moves points so that many simplices come out flat, nearly so, turned over or without a volume at all.
void spoil(std::vector<Vec3>& points, Random& random) {
  const auto any = [&]() -> Vec3& { return points[random.below(static_cast<std::uint32_t>(points.size()))]; };
  for (int k = 0; k < 4; ++k) {
    Vec3& p = any();
    switch (random.below(6)) {
      case 0: p = any(); break;
      case 1: p = 0.5 * (any() + any()); break;
      case 2: {  // nearly in the plane of three others
        const double s = random.uniform(0, 1);
        const double t = random.uniform(0, 1);
        const Vec3 a = any();
        p = a + (any() - a) * s + (any() - a) * t;
        break;
      }
      case 3: p = p * std::ldexp(1.0, static_cast<int>(random.below(700)) - 350); break;
      case 4: p.y = std::numeric_limits<double>::quiet_NaN(); break;
      default: p.z = -std::numeric_limits<double>::infinity(); break;
    }
  }
}

TEST(PositiveCells, ProvesOnlyWhatIsSo) {
  Random random(31);
  int cells = 0;
  int positive = 0;
  for (int i = 0; i < test::scaled(3000, 300000); ++i) {
    const CellComplex complex(mesh_of(i % 6));
    const CombinatorialMap& map = complex.map();
    std::vector<Vec3> points(complex.positions().begin(), complex.positions().end());
    spoil(points, random);
    if (i % 4 == 3) {  // so small that products underflow
      const auto exponent = static_cast<int>(i % 8 == 3 ? 180 + random.below(200) : 205 + random.below(40));
      const double factor = std::ldexp(1.0, -exponent);
      for (Vec3& p : points) p = p * factor;
    }
    const std::vector<Cell> all = map.cells();
    for (const Cell c : all) {
      std::array<const std::uint32_t*, 4> vertices;
      vertices.fill(map.view(c).vertices().data());
      std::array<Cell, 4> four = {c, c, c, c};
      for (std::size_t lane = 1; lane < 4; ++lane) {
        const Cell other = all[random.below(static_cast<std::uint32_t>(all.size()))];
        if (&map.shape(other) != &map.shape(c)) continue;
        four[lane] = other;
        vertices[lane] = map.view(other).vertices().data();
      }
      const unsigned open = not_proved_positive(map.shape(c), vertices, points.data());
      EXPECT_EQ(open, not_proved_positive(map.shape(c), vertices, points.data(), InstructionSet::portable));
      for (unsigned lane = 0; lane < 4; ++lane) {
        const bool proved = ((open >> lane) & 1U) == 0;
        ++cells;
        positive += proved ? 1 : 0;
        if (!proved) continue;
        const auto invalid = check_cell(map, points, four[lane]);
        ASSERT_TRUE(!invalid) << "mesh " << i << ": " << invalid->message;
      }
    }
  }
  EXPECT_GT(positive, cells / 10);
  EXPECT_LT(positive, cells);
}

TEST(PositiveCells, LeavesNoPlainCellOpen) {
  for (int which = 0; which < 6; ++which) {
    const CellComplex complex(mesh_of(which));
    for (const Cell c : complex.map().cells()) {
      std::array<const std::uint32_t*, 4> vertices;
      vertices.fill(complex.map().view(c).vertices().data());
      EXPECT_EQ(not_proved_positive(complex.map().shape(c), vertices, complex.positions().data()), 0U) << which;
    }
  }
}

}  // namespace dartcast::positive_cells_test
