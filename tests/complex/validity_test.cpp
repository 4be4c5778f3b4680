// The whole-scene check finds exactly the cells that have been spoilt.
#include "dartcast/validity.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/random.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "support/dyadic.hpp"
#include "support/generate_checks.hpp"
#include "support/meshes.hpp"

namespace dartcast::validity_test {

MeshData box(int which) {
  BoxOptions o;
  o.cells = {6, 5, 4};
  o.size = {6, 5, 4};
  o.jitter = 0.3;
  test::set_kind(o, which);
  return generate_box(o);
}

std::set<std::uint32_t> sources(const CombinatorialMap& map, const Validity& validity) {
  std::set<std::uint32_t> cells;
  for (const InvalidCell& c : validity.first) cells.insert(map.source(c.cell));
  return cells;
}

// Cells with a simplex that is not positive, by rationals and the mesh's own faces.
std::set<std::uint32_t> brute_invalid(const MeshData& mesh, const std::vector<Vec3>& points) {
  std::set<std::uint32_t> cells;
  for (std::uint32_t c = 0; c < mesh.cell_count(); ++c) {
    test::for_each_simplex(mesh, c, [&](std::uint32_t i, std::uint32_t j, std::uint32_t k, std::uint32_t l) {
      const std::array<Vec3, 4> v = {points[i], points[j], points[k], points[l]};
      const bool finite = std::all_of(v.begin(), v.end(), [](const Vec3& p) { return is_finite(p) && norm(p) < 1e30; });
      if (!finite || test::exact_sign(v[0], v[1], v[2], v[3]) <= 0) cells.insert(c);
    });
  }
  return cells;
}

TEST(Validity, FindsExactlyTheSpoiltCells) {
  constexpr std::size_t all = 100000;
  for (int which = 0; which < 5; ++which) {
    const MeshData mesh = box(which);
    const CellComplex complex(mesh);
    ASSERT_EQ(complex.steiner_point_count(), 0U);
    const CombinatorialMap& map = complex.map();
    std::vector<Vec3> points = mesh.points;
    EXPECT_TRUE(check_validity(map, points, {}, all).valid());
    Random random(5);
    for (int k = 0; k < 12; ++k) {
      Vec3& p = points[random.below(static_cast<std::uint32_t>(points.size()))];
      switch (k % 6) {
        case 0: p = points[random.below(static_cast<std::uint32_t>(points.size()))]; break;  // flat
        case 1: p.x += 1.7; break;                                                           // inverted
        case 2: p.y = std::nan(""); break;
        case 3: p.z = std::numeric_limits<double>::infinity(); break;
        case 4: p.x = 0x1p+310; break;
        default: p = {p.x + 0.01, p.y, p.z}; break;  // harmless, mostly
      }
      const Validity one = check_validity(map, points, Threads{1}, all);
      const auto expected = brute_invalid(mesh, points);
      EXPECT_EQ(sources(map, one), expected);
      EXPECT_EQ(one.invalid_count, expected.size());
      EXPECT_EQ(one.cells_checked, mesh.cell_count());
      for (const Cell c : map.cells())
        EXPECT_EQ(check_cell(map, points, c).has_value(), expected.contains(map.source(c)));
    }
  }
}

TEST(Validity, MessagesNameCellAndKind) {
  MeshData mesh = box(0);
  mesh.source.resize(mesh.cell_count());
  for (std::uint32_t c = 0; c < mesh.cell_count(); ++c) mesh.source[c] = c + 5000;
  const CellComplex complex(mesh);
  const auto text = [&](const Vec3& p) {
    std::vector<Vec3> points = mesh.points;
    points[mesh.cell(0)[0]] = p;
    for (const InvalidCell& c : check_validity(complex.map(), points, {}, 1000).first) {
      if (complex.map().source(c.cell) == 5000) return c.message;
    }
    return std::string("not found");
  };
  EXPECT_NE(text(mesh.points[mesh.cell(0)[1]]).find("cell 5000: simplex 0 is flat"), std::string::npos);
  EXPECT_NE(text({9, 9, 9}).find("is inverted"), std::string::npos) << text({9, 9, 9});
  EXPECT_NE(text({std::nan(""), 0, 0}).find("not finite"), std::string::npos);
}

TEST(Validity, SameResultForAnyNumberOfThreadsAndAtMostSoMany) {
  BoxOptions o;
  o.cells = {24, 24, 24};
  o.size = {1.0, 1.0, 1.0};
  o.jitter = 0.9;
  const MeshData mesh = generate_box(o);
  const CombinatorialMap map(mesh);
  const Validity one = check_validity(map, mesh.points, Threads{1}, 50);
  ASSERT_GT(one.invalid_count, 50U);
  EXPECT_EQ(one.first.size(), 50U);
  EXPECT_TRUE(std::is_sorted(one.first.begin(), one.first.end(), [](auto& a, auto& b) { return a.cell < b.cell; }));
  for (const std::size_t most : {0U, 1U, 7U}) {
    EXPECT_EQ(check_validity(map, mesh.points, Threads{2}, most).first.size(), most);
    EXPECT_EQ(check_validity(map, mesh.points, Threads{2}, most).invalid_count, one.invalid_count);
  }
  for (const unsigned threads : {2U, 7U}) {
    const Validity many = check_validity(map, mesh.points, Threads{threads}, 50);
    EXPECT_EQ(many.invalid_count, one.invalid_count);
    ASSERT_EQ(many.first.size(), one.first.size());
    for (std::size_t i = 0; i < one.first.size(); ++i) {
      EXPECT_EQ(many.first[i].cell, one.first[i].cell);
      EXPECT_EQ(many.first[i].message, one.first[i].message);
    }
  }
}

// Places of cells that edits have taken away hold nothing to check: in pools of standard types, and in the general one.
TEST(Validity, PassesOverVacantPlaces) {
  const MeshData mesh = box(1);
  CombinatorialMap map(mesh);
  Transaction t(map);
  const Cell last(1, static_cast<std::uint32_t>(map.slot_count(1) - 1));
  const auto split = split_face(t, {last, 0}, {last, 2});
  t.commit();
  ASSERT_GT(map.cell_count(CombinatorialMap::general_pool), 0U);
  remove(t, split.front());
  remove(t, Cell(1, 0));
  t.commit();
  ASSERT_LT(map.cell_count(CombinatorialMap::general_pool), map.slot_count(CombinatorialMap::general_pool));
  ASSERT_LT(map.cell_count(1), map.slot_count(1));
  std::vector<Vec3> points = mesh.points;
  EXPECT_EQ(check_validity(map, points, Threads{1}, 10).cells_checked, map.cell_count());
  // The content of vacant places is not read. The general cells are flat on purpose, by their split faces.
  for (const InvalidCell& c : check_validity(map, points, Threads{1}, 10).first)
    EXPECT_EQ(c.cell.pool(), CombinatorialMap::general_pool);
  const auto inversion = first_inversion(map, points, points, Threads{1});
  EXPECT_TRUE(!inversion || map.contains(inversion->simplex.cell));
}

}  // namespace dartcast::validity_test
