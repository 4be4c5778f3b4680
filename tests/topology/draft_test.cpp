// The forms that drafts take, and the drafts that are refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "base/random.hpp"
#include "dartcast/map_edits.hpp"
#include "mesh/cell_types.hpp"
#include "support/generate_checks.hpp"
#include "support/mixed_mesh.hpp"
#include "topology/cell_form.hpp"

namespace dartcast::draft_test {

using test::from_lowest;

using Loops = std::vector<std::vector<std::uint32_t>>;

CellDraft draft_from(const Loops& loops) {
  CellDraft draft;
  for (const auto& loop : loops) {
    auto& face = draft.faces.emplace_back();
    for (const std::uint32_t v : loop) face.corners.push_back({Vertex(v)});
  }
  return draft;
}

Loops standard_loops(CellType type, const std::vector<std::uint32_t>& number) {
  Loops loops;
  for (const auto& face : standard_faces(type)) {
    auto& loop = loops.emplace_back();
    for (const std::uint8_t k : face) loop.push_back(number[k]);
  }
  return loops;
}

// The same surface: faces in another order, each from another corner.
void shuffle(Loops& loops, Random& random) {
  for (std::size_t i = loops.size(); i > 1; --i)
    std::swap(loops[i - 1], loops[random.below(static_cast<std::uint32_t>(i))]);
  for (auto& loop : loops)
    std::rotate(loop.begin(), loop.begin() + random.below(static_cast<std::uint32_t>(loop.size())), loop.end());
}

TEST(Draft, StandardTypesAreKnownHoweverTheyAreGiven) {
  Random random(3);
  for (const CellType type : {CellType::tetrahedron, CellType::hexahedron, CellType::prism, CellType::pyramid}) {
    for (int i = 0; i < 500; ++i) {
      std::vector<std::uint32_t> number = test::permutation(corner_count(type) + random.below(20), random);
      number.resize(corner_count(type));
      Loops loops = standard_loops(type, number);
      shuffle(loops, random);
      const DraftForm form = form_of(draft_from(loops));
      ASSERT_EQ(form.defect, "");
      ASSERT_EQ(form.pool, static_cast<std::uint32_t>(type));
      const StandardCorners best = turned(type, number);
      ASSERT_TRUE(std::equal(form.corners.begin(), form.corners.end(), best.begin()));
      // Each face under its number in the type.
      const Loops expected = standard_loops(type, form.corners);
      for (std::size_t f = 0; f < loops.size(); ++f)
        ASSERT_EQ(from_lowest(loops[f]), from_lowest(expected[form.face[f]]));
    }
  }
}

TEST(Draft, WithPointsItIsGeneral) {
  Loops loops = standard_loops(CellType::hexahedron, {0, 1, 2, 3, 4, 5, 6, 7});
  CellDraft draft = draft_from(loops);
  draft.point = Vertex(8);
  EXPECT_EQ(form_of(draft).pool, CombinatorialMap::general_pool);
  draft.point = {};
  draft.faces[2].point = Vertex(9);
  EXPECT_EQ(form_of(draft).pool, CombinatorialMap::general_pool);
  EXPECT_EQ(form_of(draft).corners, (std::vector<std::uint32_t>{0, 3, 2, 1, 4, 5, 6, 7}));
}

// As many faces, corners and darts as a standard type, put together in another way.
TEST(Draft, WhatOnlyCountsAlikeIsGeneral) {
  Random random(4);
  Loops six_slices;
  for (std::uint32_t i = 0; i < 6; ++i) six_slices.push_back({6, i, 7, (i + 1) % 6});
  Loops roof = {{0, 1, 2, 3, 4}, {1, 0, 5}, {2, 1, 5}, {3, 2, 5, 4}, {0, 4, 5}};
  for (int i = 0; i < 100; ++i) {
    for (Loops loops : {six_slices, roof}) {
      shuffle(loops, random);
      const DraftForm form = form_of(draft_from(loops));
      ASSERT_EQ(form.defect, "");
      ASSERT_EQ(form.pool, CombinatorialMap::general_pool);
      for (std::uint16_t f = 0; f < loops.size(); ++f) ASSERT_EQ(form.face[f], f);
      ASSERT_EQ(std::set<std::uint32_t>(form.corners.begin(), form.corners.end()).size(), form.corners.size());
    }
  }
}

void expect_defect(const CellDraft& draft, const std::string& part) {
  const std::string defect = form_of(draft).defect;
  EXPECT_NE(defect.find(part), std::string::npos) << "no \"" << part << "\" in: " << defect;
}

TEST(Draft, WhatIsNoCellIsRefused) {
  const Loops tetrahedron = standard_loops(CellType::tetrahedron, {0, 1, 2, 3});
  const auto altered = [&](auto&& alter) {
    Loops loops = tetrahedron;
    alter(loops);
    return draft_from(loops);
  };
  expect_defect(altered([](Loops& l) { l.pop_back(); }), "fewer than four faces");
  expect_defect(altered([](Loops& l) { l[1].pop_back(); }), "fewer than three corners");
  expect_defect(altered([](Loops& l) { l[1].push_back(l[1][0]); }), "one corner twice");
  expect_defect(altered([](Loops& l) { std::reverse(l[1].begin(), l[1].end()); }), "two edges between");
  expect_defect(altered([](Loops& l) { l[1] = {7, 8, 9}; }), "not be closed");
  expect_defect(altered([](Loops& l) { l.push_back({4, 5, 6}), l.push_back({6, 5, 4}); }), "one solid");

  // Two tetrahedra that touch in vertex 3.
  Loops pinched = tetrahedron;
  for (const auto& loop : standard_loops(CellType::tetrahedron, {3, 5, 6, 7})) pinched.push_back(loop);
  expect_defect(draft_from(pinched), "one solid");
  // A torus of nine quadrilaterals.
  Loops torus;
  for (std::uint32_t i = 0; i < 3; ++i) {
    for (std::uint32_t j = 0; j < 3; ++j) {
      const std::uint32_t a = (i + 1) % 3;
      const std::uint32_t b = (j + 1) % 3;
      torus.push_back({3 * i + j, 3 * a + j, 3 * a + b, 3 * i + b});
    }
  }
  expect_defect(draft_from(torus), "one solid");
  // Beside it a tetrahedron: together they have the numbers of one sphere.
  Loops both = torus;
  for (const auto& loop : standard_loops(CellType::tetrahedron, {20, 21, 22, 23})) both.push_back(loop);
  expect_defect(draft_from(both), "one solid");

  CellDraft points = draft_from(tetrahedron);
  points.point = Vertex(2);
  expect_defect(points, "Steiner point");
  points.point = points.faces[1].point = Vertex(9);
  expect_defect(points, "Steiner point");

  Loops large = {{}};
  for (std::uint32_t i = 0; i < 6000; ++i) {
    large[0].push_back(6000 - i);
    large.push_back({i + 1, (i + 1) % 6000 + 1, 0});
  }
  expect_defect(draft_from(large), "16383");
}

TEST(Draft, OfACellIsTheCell) {
  const CombinatorialMap map(test::mixed_mesh());
  for (const Cell c : map.cells()) {
    const CellDraft draft = draft_of(map, c);
    const Shape& s = map.shape(c);
    ASSERT_EQ(draft.faces.size(), s.face_count());
    EXPECT_EQ(draft.source, map.source(c));
    EXPECT_EQ(draft.free, map.is_free(c));
    for (std::uint16_t f = 0; f < s.face_count(); ++f) {
      const DraftFace& face = draft.faces[f];
      EXPECT_EQ(face.from, (CellFace{c, f}));
      EXPECT_EQ(face.across.face, map.opposite({c, f}));
      for (std::size_t k = 0; k < face.corners.size(); ++k)
        EXPECT_EQ(face.corners[k].vertex, map.origin({c, static_cast<std::uint16_t>(s.first_dart(f) + k)}));
    }
  }
}

}  // namespace dartcast::draft_test
