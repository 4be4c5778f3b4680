// Locating random points, against a search through all cells with another predicate.
#include "tracking/locate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random.hpp"
#include "dartcast/generators.hpp"
#include "support/dyadic.hpp"
#include "support/generate_checks.hpp"
#include "support/meshes.hpp"
#include "support/tier.hpp"

namespace dartcast::locate_test {

struct Box {
  Vec3 low, high;
};

// The answer by brute force: free if any closed simplex of a free cell holds x.
class Brute {
 public:
  explicit Brute(const CellComplex& complex) : complex_(complex) {
    for (const Cell c : complex.map().cells()) {
      for (std::uint16_t s = 0; s < complex.map().shape(c).simplices().size(); ++s) {
        const auto v = complex.corners({c, s});
        Box b{v[0], v[0]};
        for (const Vec3& p : v) {
          b.low = {std::min(b.low.x, p.x), std::min(b.low.y, p.y), std::min(b.low.z, p.z)};
          b.high = {std::max(b.high.x, p.x), std::max(b.high.y, p.y), std::max(b.high.z, p.z)};
        }
        simplices_.push_back({{c, s}, b});
      }
    }
  }

  [[nodiscard]] bool holds(SimplexId id, const Vec3& x) const {
    const auto v = complex_.corners(id);
    for (unsigned k = 0; k < 4; ++k) {
      auto replaced = v;
      replaced[k] = x;
      if (test::exact_sign(replaced[0], replaced[1], replaced[2], replaced[3]) < 0) return false;
    }
    return true;
  }

  /// The place, and the lowest simplex there.
  [[nodiscard]] std::pair<Place, SimplexId> locate(const Vec3& x) const {
    std::pair<Place, SimplexId> best{Place::outside, {}};
    for (const auto& [id, b] : simplices_) {
      if (x.x < b.low.x || x.y < b.low.y || x.z < b.low.z || x.x > b.high.x || x.y > b.high.y || x.z > b.high.z)
        continue;
      if (!holds(id, x)) continue;
      if (complex_.map().is_free(id.cell)) return {Place::free, id};
      if (best.first == Place::outside) best = {Place::blocked, id};
    }
    return best;
  }

 private:
  const CellComplex& complex_;
  std::vector<std::pair<SimplexId, Box>> simplices_;
};

MeshData mesh_of(int which) {
  if (which == 5) {
    OctahedraOptions o;
    o.cells = {3, 3, 3};
    o.size = {3, 3, 3};
    o.blocked_share = 0.3;
    return generate_octahedra(o);
  }
  BoxOptions o;
  o.cells = {4, 3, 5};
  o.size = {3, 3, 3};
  o.jitter = 0.4;
  o.blocked_share = 0.3;
  test::set_kind(o, which);
  return generate_box(o);
}

TEST(Locate, RandomPointsAgreeWithASearchThroughAllCells) {
  int outside = 0, blocked = 0, free = 0;
  for (int which = 0; which < 6; ++which) {
    const CellComplex complex(mesh_of(which));
    ASSERT_TRUE(complex.invalid_cells().empty());
    const Locator locator(complex);
    const Brute brute(complex);
    Random random(static_cast<std::uint64_t>(which));
    for (int i = 0; i < test::scaled(17000, 17000); ++i) {
      Vec3 x{random.uniform(-0.5, 4), random.uniform(-0.5, 4), random.uniform(-0.5, 4)};
      if (i % 4 == 1) x = {std::floor(x.x * 4) / 4, std::floor(x.y * 4) / 4, std::floor(x.z * 4) / 4};
      if (i % 4 == 2) {  // on or beside a face's middle
        const auto cells = complex.map().cells();
        const Corners v = complex.corners({cells[random.below(static_cast<std::uint32_t>(cells.size()))], 0});
        x = (v[1] + v[2] + v[3]) * (1.0 / 3.0);
      }
      const Location found = locator.locate(complex, x);
      const auto [place, simplex] = brute.locate(x);
      ASSERT_EQ(found.place, place) << x.x << " " << x.y << " " << x.z;
      ASSERT_EQ(found.simplex, simplex) << "the lowest of those that hold it";
      ++(place == Place::free ? free : place == Place::blocked ? blocked : outside);
    }
  }
  EXPECT_GT(free, test::scaled(20000, 20000));
  EXPECT_GT(blocked, test::scaled(10000, 10000));
  EXPECT_GT(outside, test::scaled(10000, 10000));
}

TEST(Locate, CellsOfVeryDifferentSizes) {
  // Layers that double in height: a grid's bins suit few of them.
  BoxOptions o;
  o.cells = {3, 3, 24};
  o.size = {3, 3, 24};
  MeshData mesh = generate_box(o);
  for (Vec3& p : mesh.points) p.z = std::ldexp(1.0, static_cast<int>(p.z)) - 1.0;
  const CellComplex complex(mesh);
  const Locator locator(complex);
  const Brute brute(complex);
  Random random(3);
  for (int i = 0; i < 5000; ++i) {
    const Vec3 x{random.uniform(0, 3), random.uniform(0, 3), std::exp2(random.uniform(0, 24.1)) - 1.0};
    const auto [place, simplex] = brute.locate(x);
    const Location found = locator.locate(complex, x);
    ASSERT_EQ(found.place, place);
    ASSERT_EQ(found.simplex, simplex);
  }
}

TEST(Locate, OneUlpInsideAndOutside) {
  BoxOptions o;
  o.cells = {3, 3, 3};
  o.size = {0.3, 0.3, 0.3};
  o.origin = {0.1, 0.1, 0.1};
  const CellComplex complex(generate_box(o));
  const Locator locator(complex);
  const double high = complex.positions().back().x;
  EXPECT_EQ(locator.locate(complex, {high, 0.2, 0.3}).place, Place::free);
  EXPECT_EQ(locator.locate(complex, {std::nextafter(high, 1.0), 0.2, 0.3}).place, Place::outside);
  EXPECT_EQ(locator.locate(complex, {std::nextafter(high, 0.0), 0.2, 0.3}).place, Place::free);
  EXPECT_EQ(locator.locate(complex, {0.1, 0.1, 0.1}).kind, Kind::vertex);
  EXPECT_EQ(locator.locate(complex, {std::nextafter(0.1, 0.0), 0.1, 0.1}).place, Place::outside);
}

TEST(Locate, VerticesThatAreNotFiniteSpoilTheirCellsOnly) {
  BoxOptions o;
  o.cells = {3, 3, 3};
  o.size = {3, 3, 3};
  const MeshData mesh = generate_box(o);
  CellComplex complex(mesh);
  const auto next = complex.next_positions();
  next[0] = {std::nan(""), std::numeric_limits<double>::infinity(), 0};
  for (const std::uint32_t v : mesh.cell(26)) next[v] = {std::nan(""), std::nan(""), std::nan("")};
  complex.commit_positions();
  const Locator locator(complex);
  int found = 0;
  for (int c = 0; c < 27; ++c) {
    const Vec3 middle{c % 3 + 0.5, c / 3 % 3 + 0.5, c / 9 + 0.5};
    const Location at = locator.locate(complex, middle);
    if (at.place == Place::free) EXPECT_EQ(complex.map().source(at.simplex.cell), static_cast<std::uint32_t>(c));
    found += at.place == Place::free ? 1 : 0;
  }
  EXPECT_EQ(found, 27 - 1 - 8);
}

}  // namespace dartcast::locate_test
