// Side tables against std::map.
#include <gtest/gtest.h>

#include <map>

#include "base/random.hpp"
#include "dartcast/storage.hpp"
#include "support/tier.hpp"

namespace dartcast::side_table_test {

TEST(SideTable, HoldsWhatWasSetLast) {
  for (const std::uint32_t cells : {3U, 40U, 1000U}) {
    Random random(cells);
    SideTable table;
    std::map<std::pair<std::uint32_t, std::uint16_t>, std::uint16_t> truth;
    for (int i = 0; i < test::scaled(20000, 1000000); ++i) {
      const std::uint32_t cell = random.below(cells);
      const auto number = static_cast<std::uint16_t>(random.below(6));
      const auto value = static_cast<std::uint16_t>(random.below(3) == 0 ? 0 : 1 + random.below(0xffff));
      table.set(Cell(cell), number, value);
      if (value == 0) {
        truth.erase({cell, number});
      } else {
        truth[{cell, number}] = value;
      }
      ASSERT_EQ(table.size(), truth.size());
      const std::pair<std::uint32_t, std::uint16_t> asked = {random.below(cells),
                                                             static_cast<std::uint16_t>(random.below(6))};
      ASSERT_EQ(table.find(Cell(asked.first), asked.second), truth.contains(asked) ? truth[asked] : 0);
    }
    SideTable again;
    for (const auto& [key, value] : truth) again.set(Cell(key.first), key.second, value);
    EXPECT_EQ(again, table);
    again.set(Cell(0), 0, static_cast<std::uint16_t>(again.find(Cell(0), 0) + 1U));
    EXPECT_FALSE(again == table);
    for (const auto& [key, value] : truth) table.set(Cell(key.first), key.second, 0);
    EXPECT_EQ(table.size(), 0U);
    EXPECT_EQ(table, SideTable{});
  }
}

TEST(SideTable, IsEmptyWhereNothingWasSet) {
  SideTable table;
  EXPECT_EQ(table.find(Cell(1), 2), 0);
  table.set(Cell(1), 2, 0);
  EXPECT_EQ(table.size(), 0U);
  EXPECT_EQ(table.bytes(), 0U);
}

}  // namespace dartcast::side_table_test
