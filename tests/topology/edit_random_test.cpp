// Random sequences of edits: integrity after each, vertices as counted, everything as before where a transaction is
// taken back.
#include <gtest/gtest.h>

#include <array>
#include <set>

#include "dartcast/error.hpp"
#include "dartcast/map_edits.hpp"
#include "support/edit_meshes.hpp"
#include "support/random_edits.hpp"
#include "support/tier.hpp"

namespace dartcast::edit_random_test {

using test::CellBag;
using test::Edit;
using test::EditKind;

std::vector<Cell> with_neighbours(const CombinatorialMap& map, std::span<const Cell> cells) {
  std::set<Cell> all;
  for (const Cell c : cells) {
    all.insert(c);
    const CellView v = map.view(c);
    for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
      if (v.neighbour(f).valid()) all.insert(v.neighbour(f));
    }
  }
  return {all.begin(), all.end()};
}

std::set<std::uint32_t> vertices_of(const CombinatorialMap& map) {
  std::set<std::uint32_t> all;
  for (const Cell c : map.cells()) {
    const auto vertices = map.view(c).vertices();
    all.insert(vertices.begin(), vertices.end());
  }
  return all;
}

// Shapes of general cells; those of standard types, at most 45, stay when no cell uses them.
std::size_t shapes_used(const CombinatorialMap& map) {
  std::set<const Shape*> used;
  for (const Cell c : map.cells()) {
    if (c.pool() == CombinatorialMap::general_pool) used.insert(&map.shape(c));
  }
  return used.size();
}

class RandomEdits : public testing::TestWithParam<test::EditMesh> {};
INSTANTIATE_TEST_SUITE_P(CombinatorialMap, RandomEdits, testing::ValuesIn(test::all_edit_meshes()),
                         [](const auto& i) { return std::string(i.param.name); });

TEST_P(RandomEdits, LeaveAValidMap) {
  CombinatorialMap map(GetParam().make());
  CellBag bag(map);
  const std::size_t usual = bag.size();
  std::set<std::uint32_t> vertices = vertices_of(map);
  std::array<int, test::edit_kinds> done{};
  Random random(17);
  Transaction t(map);
  const int count = test::scaled(10000, 1000000) / static_cast<int>(test::all_edit_meshes().size());
  for (int i = 0, edits = 0; edits < count; ++i) {
    const EditKind kind = draw_kind(bag, usual, random, map.dimension());
    const Edit edit = draw_edit(map, kind, bag.draw(map, random), bag, random);
    try {
      apply(t, edit);
    } catch (const EditRefused& e) {
      ASSERT_EQ(std::string(e.what()).rfind("cell ", 0), 0U) << e.what();
      continue;
    } catch (const InvalidArgument&) {
      ASSERT_EQ(kind, EditKind::split_cell);  // a path of two darts
      continue;
    }
    ++done[static_cast<std::size_t>(kind)];
    const EditReport report = t.commit();
    bag.update(report);
    for (const CreatedVertex& v : report.created) ASSERT_TRUE(vertices.insert(v.vertex.value).second);
    for (const Vertex v : report.deleted) ASSERT_EQ(vertices.erase(v.value), 1U);
    for (const CellHandle& h : report.removed) ASSERT_FALSE(map.contains(h));
    for (const Cell c : report.added) ASSERT_TRUE(map.contains(c));
    const auto touched =
        kind == EditKind::mark ? with_neighbours(map, report.marked) : with_neighbours(map, report.added);
    const auto found = check_integrity(map, touched);
    ASSERT_TRUE(found.empty()) << "edit " << edits << " of kind " << static_cast<int>(kind) << ": " << found[0].message;
    if (++edits % 100 != 0 && edits != count) continue;
    ASSERT_TRUE(check_integrity(map).empty());
    ASSERT_EQ(map.cell_count(), bag.size());
    ASSERT_EQ(vertices_of(map), vertices);
    ASSERT_LE(map.shapes().size(), shapes_used(map) + 45);
  }
  if (test::sanitized()) return;  // too few edits for all kinds
  for (std::size_t k = 0; k < test::edit_kinds; ++k) {
    if (in_dimension(static_cast<EditKind>(k), map.dimension()) == static_cast<EditKind>(k))
      EXPECT_GT(done[k], count / 500) << "kind " << k;
  }
}

}  // namespace dartcast::edit_random_test
