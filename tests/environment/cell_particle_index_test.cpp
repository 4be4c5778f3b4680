// Lists of particles by cell, while particles change their cells.
#include "environment/cell_particle_index.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "base/random.hpp"

namespace dartcast::detail::cell_particle_index_test {

constexpr std::uint32_t cell_count = 7;
constexpr std::uint32_t particle_count = 100;

std::set<std::uint32_t> listed(const CellParticleIndex& index, Cell c) {
  std::set<std::uint32_t> found;
  index.for_each(c, [&](std::uint32_t i) { found.insert(i); });
  return found;
}

TEST(CellParticleIndex, ListsEveryParticleAndStaysSmall) {
  Random random(1);
  std::vector<ParticleState> states(particle_count);
  for (std::uint32_t i = 0; i < particle_count; ++i) states[i].cell = Cell{i % cell_count};
  CellParticleIndex index(states);
  std::uint32_t added = 0;
  std::uint32_t made = 0;
  for (std::uint32_t k = 0; k < 100 * particle_count; ++k) {
    const auto i = random.below(particle_count);
    states[i].cell = Cell{random.below(cell_count)};
    index.add(i, states[i]);
    ++added;
    if (index.is_outdated()) {
      EXPECT_GE(added, particle_count);  // so that all new indices cost no more than all additions
      index = CellParticleIndex(states);
      EXPECT_FALSE(index.is_outdated());
      added = 0;
      ++made;
    }
    ASSERT_LE(added, 2 * particle_count);
  }
  EXPECT_GT(made, 10U);
  std::map<std::uint32_t, std::set<std::uint32_t>> expected;
  for (std::uint32_t i = 0; i < particle_count; ++i) expected[states[i].cell.value].insert(i);
  for (std::uint32_t c = 0; c < cell_count; ++c) {
    const std::set<std::uint32_t> found = listed(index, Cell{c});
    EXPECT_TRUE(std::includes(found.begin(), found.end(), expected[c].begin(), expected[c].end()));
  }
}

TEST(CellParticleIndex, ForgetsTheListOfACell) {
  std::vector<ParticleState> states(2);
  states[0].cell = Cell{3};
  states[1].cell = Cell{4};
  CellParticleIndex index(states);
  index.clear(Cell{3});
  EXPECT_TRUE(listed(index, Cell{3}).empty());
  EXPECT_EQ(listed(index, Cell{4}), std::set<std::uint32_t>{1});
}

}  // namespace dartcast::detail::cell_particle_index_test
