// The reports of transactions. A transaction that is undone leaves nothing behind.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "dartcast/error.hpp"
#include "dartcast/map_edits.hpp"
#include "support/edit_meshes.hpp"
#include "support/expectations.hpp"
#include "support/mixed_mesh.hpp"
#include "support/random_edits.hpp"
#include "support/tier.hpp"

namespace dartcast::transaction_test {

using test::CellBag;
using test::Edit;

// Edits until so many were possible; cells are drawn from those that there are now.
int edit_at_random(Transaction& t, int count, Random& random) {
  int tried = 0;
  for (int done = 0; done < count && tried < 100 * count; ++tried) {
    const CellBag bag(t.map());
    if (bag.size() == 0) return tried;
    const Edit edit =
        draw_edit(t.map(), draw_kind(bag, 60, random, t.map().dimension()), bag.draw(t.map(), random), bag, random);
    try {
      apply(t, edit);
      ++done;
    } catch (const Error&) {
      continue;
    }
  }
  return tried;
}

class Transactions : public testing::TestWithParam<test::EditMesh> {};
INSTANTIATE_TEST_SUITE_P(CombinatorialMap, Transactions, testing::ValuesIn(test::all_edit_meshes()),
                         [](const auto& i) { return std::string(i.param.name); });

TEST_P(Transactions, TakenBackLeaveTheMapAsItWas) {
  CombinatorialMap map(GetParam().make());
  Random random(5);
  for (int round = 0; round < test::scaled(60, 5000); ++round) {
    {
      Transaction t(map);  // what stays
      edit_at_random(t, static_cast<int>(random.below(4)), random);
      t.commit();
    }
    const CombinatorialMap before = map;
    {
      Transaction t(map);
      edit_at_random(t, 1 + static_cast<int>(random.below(8)), random);
      if (random.below(2) == 0) t.roll_back();
    }
    ASSERT_TRUE(map == before) << "round " << round;
  }
  EXPECT_TRUE(check_integrity(map).empty());
}

TEST_P(Transactions, GoBackToAMark) {
  CombinatorialMap map(GetParam().make());
  Random random(6);
  for (int round = 0; round < test::scaled(40, 2000); ++round) {
    Transaction t(map);
    edit_at_random(t, static_cast<int>(random.below(4)), random);
    const CombinatorialMap before = map;
    const Transaction::Savepoint mark = t.savepoint();
    edit_at_random(t, 1 + static_cast<int>(random.below(6)), random);
    t.roll_back(mark);
    ASSERT_TRUE(map == before) << "round " << round;
    t.commit();
    ASSERT_TRUE(check_integrity(map).empty());
  }
}

// Whatever is refused, refused it has changed nothing.
TEST_P(Transactions, RefusedEditsChangeNothing) {
  CombinatorialMap map(GetParam().make());
  Random random(7);
  Transaction t(map);
  edit_at_random(t, 20, random);
  t.commit();
  const CombinatorialMap before = map;
  int refused = 0;
  for (int i = 0; i < test::scaled(400, 20000); ++i) {
    const CellBag bag(map);
    const Edit edit = draw_edit(map, draw_kind(bag, 60, random, map.dimension()), bag.draw(map, random), bag, random);
    try {
      apply(t, edit);
      t.roll_back();
    } catch (const Error&) {
      ++refused;
    }
    ASSERT_TRUE(map == before) << "try " << i;
  }
  EXPECT_GT(refused, test::scaled(400, 20000) / 10);
}

TEST_P(Transactions, ReportWhatChangedInAll) {
  CombinatorialMap map(GetParam().make());
  Random random(8);
  for (int round = 0; round < test::scaled(60, 5000); ++round) {
    Transaction t(map);
    const auto cells = map.cells();
    std::set<CellHandle> before;
    std::set<std::uint32_t> vertices;
    std::set<Cell> blocked;
    for (const Cell c : cells) {
      before.insert(map.handle(c));
      vertices.insert(map.view(c).vertices().begin(), map.view(c).vertices().end());
      if (!map.is_free(c)) blocked.insert(c);
    }
    edit_at_random(t, 1 + static_cast<int>(random.below(8)), random);
    const EditReport report = t.commit();
    for (const CellHandle& h : report.removed) ASSERT_EQ(before.erase(h), 1U);
    for (const Cell c : report.added) ASSERT_TRUE(before.insert(map.handle(c)).second);
    for (const CreatedVertex& v : report.created) ASSERT_TRUE(vertices.insert(v.vertex.value).second);
    for (const Vertex v : report.deleted) ASSERT_EQ(vertices.erase(v.value), 1U);
    for (const Cell c : report.marked) ASSERT_TRUE(map.contains(c));
    std::set<CellHandle> after;
    std::set<std::uint32_t> vertices_after;
    for (const Cell c : map.cells()) {
      after.insert(map.handle(c));
      vertices_after.insert(map.view(c).vertices().begin(), map.view(c).vertices().end());
      const bool stayed = std::find(cells.begin(), cells.end(), c) != cells.end() &&
                          std::find(report.added.begin(), report.added.end(), c) == report.added.end();
      const bool said = std::find(report.marked.begin(), report.marked.end(), c) != report.marked.end();
      if (stayed && map.is_free(c) == blocked.contains(c)) ASSERT_TRUE(said);
    }
    ASSERT_EQ(before, after);
    ASSERT_EQ(vertices, vertices_after);
    for (std::uint32_t v = 0; v < map.vertex_count(); ++v) {
      if (vertices.contains(v)) ASSERT_TRUE(map.is_vertex(Vertex(v)));
    }
  }
}

// The size of the map is bounded by the most that there was at one time, not by the number of edits.
TEST(Transaction, PlacesAndNumbersAreUsedAgain) {
  CombinatorialMap map(test::edit_box(CellType::hexahedron, false, 3));
  Random random(9);
  std::size_t bytes = 0;
  const int rounds = test::scaled(400, 20000);
  for (int i = 0; i < rounds; ++i) {
    Transaction t(map);
    const auto cells = map.cells();
    const Cell c = cells[random.below(static_cast<std::uint32_t>(cells.size()))];
    const SplitEdge split = split_edge(t, {c, static_cast<std::uint16_t>(random.below(24))});
    t.commit();
    if (i == rounds * 3 / 4) bytes = map.bytes();
    const Cell some = split.cells[0];
    for (std::uint16_t d = 0; d < map.shape(some).dart_count(); ++d) {
      if (map.origin({some, d}) != split.vertex) continue;
      merge_edges(t, {some, d});
      break;
    }
    const EditReport report = t.commit();
    ASSERT_EQ(report.deleted, std::vector<Vertex>{split.vertex});
    ASSERT_FALSE(map.is_vertex(split.vertex));
    ASSERT_EQ(map.vertex_count(), 65U);
    ASSERT_EQ(map.cell_count(1), 27U);
    ASSERT_LE(map.slot_count(1) + map.slot_count(CombinatorialMap::general_pool), 40U);
  }
  EXPECT_LE(map.bytes(), bytes + 4096);
  EXPECT_TRUE(check_integrity(map).empty());
}

// A cell is replaced again and again, in two places by turns, until their versions have run out: then others are used.
TEST(Transaction, HandlesGoStale) {
  CombinatorialMap map(test::edit_box(CellType::hexahedron, false, 2));
  Transaction t(map);
  CellHandle now = map.handle(map.cells()[0]);
  std::vector<CellHandle> first;
  const int rounds = test::scaled(140000, 600000);
  for (int i = 0; i < rounds; ++i) {
    const CellDraft draft = draft_of(map, now.cell);
    const Cell cells[] = {now.cell};
    const Cell next = t.replace(cells, {&draft, 1})[0];
    t.commit();
    ASSERT_FALSE(map.contains(now));
    if (i < 10) first.push_back(now);
    for (const CellHandle& h : first) ASSERT_FALSE(map.contains(h));
    now = map.handle(next);
    ASSERT_TRUE(map.contains(now));
  }
  EXPECT_EQ(map.cell_count(), 8U);
  EXPECT_LE(map.slot_count(1), 9U + static_cast<std::size_t>(rounds) / 65535);
  EXPECT_TRUE(check_integrity(map).empty());
}

TEST(Transaction, WhatIsFreedIsNotUsedAgainBeforeTheCommit) {
  CombinatorialMap map(test::edit_box(CellType::tetrahedron, false, 2));
  Random random(10);
  Transaction t(map);
  edit_at_random(t, 30, random);
  t.commit();
  std::set<Cell> gone;
  for (int i = 0; i < 30; ++i) {
    const auto before = map.cells();
    edit_at_random(t, 1, random);
    for (const Cell c : map.cells()) ASSERT_FALSE(gone.contains(c));
    for (const Cell c : before) {
      if (!map.contains(c)) gone.insert(c);
    }
  }
}

TEST(Transaction, ReplaceRefusesWhatWouldBeNoMap) {
  MeshData mesh = test::mixed_mesh();
  mesh.source = {70, 10, 20, 30, 40, 50, 60, 80};
  CombinatorialMap map(mesh);
  std::map<std::uint32_t, Cell> cell;
  for (const Cell c : map.cells()) cell[map.source(c)] = c;
  Transaction t(map);
  const CombinatorialMap before = map;
  const auto replaced = [&](std::vector<Cell> removed, std::vector<CellDraft> drafts) {
    const std::string text = test::refusal([&] { t.replace(removed, drafts); });
    EXPECT_TRUE(map == before);
    return text;
  };
  const auto altered = [&](std::uint32_t source, auto&& alter) {
    CellDraft draft = draft_of(map, cell[source]);
    alter(draft);
    return replaced({cell[source]}, {draft});
  };
  const CellDraft cube = draft_of(map, cell[70]);
  test::expect_parts(replaced({Cell(0, 99)}, {}), {"invalid", "not there"});
  test::expect_parts(replaced({cell[70], cell[70]}, {}), {"invalid", "twice"});
  test::expect_parts(replaced({}, {cube}), {"refused", "cell 70, which stays", "unsew"});
  test::expect_parts(replaced({cell[70]}, {cube, cube}), {"refused", "another continues"});
  test::expect_parts(replaced({cell[70], cell[10]}, {cube}), {"refused", "cell 70", "no more"});
  test::expect_parts(altered(70, [](CellDraft& d) { d.faces.pop_back(); }), {"refused", "cell 70", "closed"});
  test::expect_parts(altered(70, [](CellDraft& d) { d.faces[0].corners[0].vertex = Vertex(99); }),
                     {"refused", "cell 70"});
  test::expect_parts(altered(80,
                             [](CellDraft& d) {
                               for (auto& f : d.faces) {
                                 for (auto& c : f.corners) c.vertex.value += 50;
                               }
                             }),
                     {"invalid", "no vertex"});
  test::expect_parts(altered(70, [](CellDraft& d) { std::swap(d.faces[3].across, d.faces[4].across); }),
                     {"refused", "cell 70", "corners"});
  test::expect_parts(altered(70,
                             [&](CellDraft& d) {
                               for (auto& f : d.faces) {
                                 if (f.across.face.valid()) f.point = Vertex(20);
                               }
                             }),
                     {"refused", "point"});
  test::expect_parts(altered(70, [](CellDraft& d) { d.faces[0].across = {{}, 0, 1}; }), {"refused", "both sides"});
  test::expect_parts(altered(70, [](CellDraft& d) { d.faces[0].across = {{}, 7, 1}; }), {"invalid"});
  test::expect_parts(altered(70, [](CellDraft& d) { d.faces[0].across = {{Cell(0, 77), 0}}; }), {"invalid"});
}

// A transaction can put in cells that never were, and take out all.
TEST(Transaction, CellsCanComeFromNothingAndGo) {
  CombinatorialMap map(test::mixed_mesh());
  Transaction t(map);
  const auto cells = map.cells();
  std::vector<CellDraft> drafts;
  for (const Cell c : cells) drafts.push_back(draft_of(map, c));
  t.replace(cells, {});
  EXPECT_EQ(map.cell_count(), 0U);
  EXPECT_TRUE(check_integrity(map).empty());
  t.roll_back();
  EXPECT_EQ(map.cell_count(), cells.size());
  const auto again = t.replace(cells, drafts);
  EXPECT_TRUE(check_integrity(map).empty());
  for (std::size_t i = 0; i < cells.size(); ++i) EXPECT_EQ(map.source(again[i]), map.source(cells[i]));
  EXPECT_EQ(t.commit().removed.size(), cells.size());
  EXPECT_EQ(map.cell_count(CombinatorialMap::general_pool), 0U);  // the polyhedron is combinatorially a hexahedron
  EXPECT_EQ(map.cell_count(1), 2U);
}

}  // namespace dartcast::transaction_test
