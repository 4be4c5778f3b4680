// Queries of the tree of boxes, against a look at each box.
#include "mesh/box_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random.hpp"
#include "support/tier.hpp"

namespace dartcast::box_tree_test {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Some lie side by side, on a lattice; some are points; some are so far away, or so small, that floats hold them badly.
Box random_box(Random& random) {
  const int kind = static_cast<int>(random.uniform(0.0, 10.0));
  const auto coordinate = [&] {
    const double x = random.uniform(-8.0, 8.0);
    if (kind < 4) return std::floor(x);
    return kind == 4 ? x * 1e60 : kind == 5 ? x * 1e-60 : kind == 6 ? 1e7 + x * 1e-3 : x;
  };
  const Vec3 a = {coordinate(), coordinate(), coordinate()};
  if (kind == 7) return {a, a};
  const Vec3 b = {coordinate(), coordinate(), coordinate()};
  return join({a, a}, {b, b});
}

void expect_all(const BoxTree& tree, const std::vector<Box>& boxes, Random& random) {
  for (int k = 0; k < 40; ++k) {
    const Box query = random_box(random);
    std::vector<std::uint32_t> truth, found;
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
      if (overlap(boxes[i], query)) truth.push_back(i);
    }
    tree.query(query, [&](std::uint32_t i) {
      found.push_back(i);
      return true;
    });
    std::sort(found.begin(), found.end());
    ASSERT_EQ(found, truth);
    std::size_t visited = 0;
    tree.query(query, [&](std::uint32_t) { return ++visited < 3; });
    ASSERT_EQ(visited, std::min<std::size_t>(3, truth.size()));
  }
}

TEST(BoxTree, FindsWhatALookAtEachBoxFinds) {
  for (std::uint64_t seed = 1; seed <= test::scaled<std::uint64_t>(150, 2000); ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    std::vector<Box> boxes(seed <= 70 ? seed - 1 : static_cast<std::size_t>(random.uniform(0.0, 600.0)));
    for (Box& b : boxes) b = random_box(random);
    if (seed % 3 == 0 && boxes.size() > 2) {
      boxes[1] = {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};  // of no point
      boxes[2].high.x = infinity;
    }
    BoxTree tree(boxes);
    expect_all(tree, boxes, random);
    std::vector<Box> moved = tree.take_boxes();
    for (Box& b : moved) b = random_box(random);
    tree.refit(moved);
    expect_all(tree, moved, random);
  }
}

}  // namespace dartcast::box_tree_test
