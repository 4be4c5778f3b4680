// Which shapes a table keeps, and under which numbers.
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <set>
#include <thread>
#include <vector>

#include "base/random.hpp"
#include "dartcast/error.hpp"
#include "dartcast/storage.hpp"
#include "support/tier.hpp"
#include "topology/cell_form.hpp"

namespace dartcast::shape_table_test {

// A pyramid over a polygon: a shape for every number of its corners.
ShapeKey cone(std::uint16_t corners) {
  ShapeKey key;
  key.corner_count = static_cast<std::uint16_t>(corners + 1);
  key.faces.resize(1);
  for (std::uint16_t i = 0; i < corners; ++i) {
    key.faces[0].corners.push_back(static_cast<std::uint16_t>((corners - i) % corners));
    const auto next = static_cast<std::uint16_t>((i + 1) % corners);
    key.faces.push_back(
        {next < i ? std::vector<std::uint16_t>{next, corners, i} : std::vector<std::uint16_t>{i, next, corners},
         false});
  }
  return key;
}

TEST(ShapeTable, KeepsAShapeAsLongAsItIsUsed) {
  ShapeTable table;
  std::map<std::uint16_t, std::pair<std::uint32_t, int>> used;  // corners: number and uses
  Random random(1);
  std::uint32_t highest = 0;
  for (int i = 0; i < test::scaled(5000, 100000); ++i) {
    const auto corners = static_cast<std::uint16_t>(3 + random.below(12));
    if (random.below(2) == 0) {
      const auto interned = table.intern(cone(corners));
      highest = std::max(highest, interned.number);
      ASSERT_EQ(interned.made, !used.contains(corners));
      auto& entry = used.try_emplace(corners, interned.number, 0).first->second;
      ASSERT_EQ(entry.first, interned.number);
      ++entry.second;
    } else if (used.contains(corners)) {
      table.release(used[corners].first);
      if (--used[corners].second == 0) used.erase(corners);
    }
    ASSERT_EQ(table.size(), used.size());
    for (const auto& [n, entry] : used) ASSERT_EQ(table[entry.first].corner_count(), n + 1);
  }
  EXPECT_LT(highest, 12U);  // numbers are used again
}

TEST(ShapeTable, UndoneIsAsBefore) {
  Random random(2);
  ShapeTable table;
  for (int round = 0; round < test::scaled(200, 5000); ++round) {
    const ShapeTable before = table;
    std::vector<ShapeTable::Interned> done;
    const std::uint32_t count = random.below(8);
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto n = static_cast<std::uint16_t>(3 + random.below(9));
      const bool standard = random.below(4) == 0;
      done.push_back(standard ? table.intern_standard(n, [&] { return cone(n); }) : table.intern(cone(n)));
    }
    for (std::size_t i = done.size(); i-- > 0;) table.undo(done[i]);
    ASSERT_TRUE(table == before);
    const auto kept = table.intern(cone(static_cast<std::uint16_t>(3 + random.below(9))));
    if (random.below(2) == 0) table.release(kept.number);
  }
}

TEST(ShapeTable, AReleasedShapeIsNotMadeAgain) {
  ShapeTable table;
  const auto first = table.intern(cone(5));
  const Shape* shape = &table[first.number];
  table.release(first.number);
  EXPECT_EQ(table.size(), 0U);
  EXPECT_TRUE(table.intern(cone(6)).made);  // under the number that is vacant
  const auto again = table.intern(cone(5));
  EXPECT_TRUE(again.made);
  EXPECT_EQ(&table[again.number], shape);
}

// However many large shapes come and go, little memory is kept.
TEST(ShapeTable, LargeReleasedShapesAreNotKept) {
  ShapeTable table;
  for (std::uint16_t n = 200; n < 260; ++n) table.release(table.intern(cone(n)).number);
  EXPECT_EQ(table.bytes(), 0U);
}

TEST(Shape, AllThreadsGetTheSameStars) {
  constexpr std::size_t count = 4;
  for (std::uint16_t n = 3; n < 40; ++n) {
    const Shape shape(cone(n));
    std::array<const Stars*, count> stars{};
    std::vector<std::thread> threads;
    for (const Stars*& mine : stars) threads.emplace_back([&] { mine = &shape.stars(); });
    for (std::thread& t : threads) t.join();
    EXPECT_FALSE(stars[0]->empty());
    EXPECT_EQ(std::set(stars.begin(), stars.end()).size(), 1U);
  }
}

TEST(ShapeTable, RefusedShapesLeaveNothing) {
  ShapeTable table;
  ShapeKey open = cone(4);
  open.faces.pop_back();
  EXPECT_THROW(table.intern(open), InvalidMesh);
  EXPECT_THROW(table.intern_standard(1, [&] { return open; }), InvalidMesh);
  EXPECT_TRUE(table == ShapeTable{});
}

// However many others there are, the numbers of standard shapes fit in 16 bits. (Keys differ in a face's point.)
TEST(ShapeTable, StandardShapesHaveSmallNumbers) {
  if (test::sanitized()) GTEST_SKIP() << "too many shapes for sanitizers";
  ShapeTable table;
  const std::uint32_t count = ShapeTable::kept_end + 100;
  for (std::uint32_t i = 0; i < count; ++i) {
    ShapeKey key = cone(17);
    for (unsigned f = 0; f < 17; ++f) key.faces[f].has_point = ((i >> f) & 1U) != 0;
    if (i == ShapeTable::kept_begin) {
      const ShapeTable before = table;
      table.undo(table.intern(key));
      EXPECT_TRUE(table == before);
    }
    const std::uint32_t number = table.intern(key).number;
    ASSERT_TRUE(number < ShapeTable::kept_begin || number >= ShapeTable::kept_end);
  }
  std::map<std::uint32_t, std::uint16_t> standard;
  for (std::uint16_t n = 3; n < 48; ++n) {
    const auto interned = table.intern_standard(n, [&] { return cone(n); });
    EXPECT_LT(interned.number, 0x10000U);
    EXPECT_TRUE(standard.emplace(interned.number, n).second);
    if (n % 5 == 0) table.undo(interned), standard.erase(interned.number);
  }
  for (const auto& [number, n] : standard) EXPECT_EQ(table[number].corner_count(), n + 1);
  EXPECT_EQ(table.size(), count + standard.size());
}

}  // namespace dartcast::shape_table_test
