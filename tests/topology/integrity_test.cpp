// Faults planted in a map's records are found and named. (phi1 and phi2 are tables of an immutable shape, whose
// constructor refuses what does not close; phi1 o phi3 follows from phi3 in these records: those constraints can't be
// broken from outside.)
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "support/mixed_mesh.hpp"
#include "support/random_edits.hpp"

namespace dartcast::integrity_test {

// A record's words, as described at the head of map.hpp.
struct Record {
  const CellView view;
  std::uint32_t* word;
  bool general;

  Record(const CombinatorialMap& map, Cell c)
      : view(map.view(c)),
        word(const_cast<std::uint32_t*>(view.vertices().data()) - 2),
        general(c.pool() == CombinatorialMap::general_pool) {}

  std::uint32_t& vertex(unsigned k) { return word[2 + k]; }
  std::uint32_t& neighbour(unsigned f) { return word[2U + view.shape().point_count() + f]; }
  std::uint32_t& extra(unsigned f) { return word[2U + view.shape().point_count() + view.shape().face_count() + f]; }
  void set_neighbour_face(unsigned f, std::uint32_t face) {
    if (general) {
      extra(f) = (extra(f) & 0xffff0000U) | face;
    } else {
      word[1] = (word[1] & ~(7U << (3U * f))) | (face << (3U * f));
    }
  }
  void flip_wall(unsigned f) { general ? extra(f) ^= 1U << 16U : word[1] ^= 1U << (18U + f); }
};

Cell cell_in_the_middle(const CombinatorialMap& map) {
  for (const Cell c : map.cells()) {
    const CellView v = map.view(c);
    bool inside = true;
    for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) inside = inside && v.neighbour(f).valid();
    if (inside) return c;
  }
  return {};
}

Cell vacant_cell(const CombinatorialMap& map) {
  for (std::uint32_t pool = 0; pool <= CombinatorialMap::general_pool; ++pool) {
    for (std::uint32_t i = 0; i < map.slot_count(pool); ++i) {
      if (!map.contains(Cell(pool, i))) return Cell(pool, i);
    }
  }
  return {};
}

void expect_found(const MeshData& mesh, const char* constraint,
                  const std::function<void(const CombinatorialMap&, Record&, Cell)>& plant) {
  CombinatorialMap map(mesh);
  const Cell c = cell_in_the_middle(map);
  ASSERT_TRUE(c.valid());
  Record record(map, c);
  plant(map, record, c);
  const auto found = check_integrity(map, std::size_t{100000});
  const auto named =
      std::find_if(found.begin(), found.end(), [&](const Violation& v) { return v.constraint == constraint; });
  ASSERT_NE(named, found.end()) << constraint
                                << " is not named; found: " << (found.empty() ? "nothing" : found[0].message);
  EXPECT_NE(named->message.find("cell " + std::to_string(map.source(named->dart.cell))), std::string::npos)
      << named->message;
  EXPECT_NE(named->message.find(constraint), std::string::npos);
}

class Planted : public testing::TestWithParam<CellType> {
 protected:
  static MeshData mesh() {
    if (GetParam() == CellType::polyhedron) {
      OctahedraOptions o;
      o.cells = {3, 3, 3};
      o.size = {1.0, 1.0, 1.0};
      return generate_octahedra(o);
    }
    BoxOptions o;
    o.cells = {3, 3, 3};
    o.size = {1.0, 1.0, 1.0};
    o.type = GetParam();
    return generate_box(o);
  }
};
INSTANTIATE_TEST_SUITE_P(Integrity, Planted,
                         testing::Values(CellType::tetrahedron, CellType::hexahedron, CellType::prism,
                                         CellType::pyramid, CellType::polyhedron),
                         [](const auto& i) { return std::string(cell_type_names[static_cast<std::size_t>(i.param)]); });

TEST_P(Planted, VertexOutOfRange) {
  expect_found(mesh(), "vertices are in range", [](const CombinatorialMap& map, Record& r, Cell) {
    r.vertex(2) = static_cast<std::uint32_t>(map.vertex_count());
  });
}

TEST_P(Planted, VertexTwiceInACell) {
  expect_found(mesh(), "the vertices of a cell are distinct",
               [](const CombinatorialMap&, Record& r, Cell) { r.vertex(2) = r.vertex(1); });
}

TEST_P(Planted, VerticesExchanged) {
  const auto exchange = [](const CombinatorialMap&, Record& r, Cell) { std::swap(r.vertex(0), r.vertex(1)); };
  expect_found(mesh(), "sewn darts have the same vertices", exchange);
  expect_found(mesh(), "a face starts at its lowest-numbered vertex", exchange);
}

TEST_P(Planted, NeighbourThatIsNone) {
  expect_found(mesh(), "phi3 leads to a face with as many darts",
               [](const CombinatorialMap&, Record& r, Cell c) { r.neighbour(1) = Cell(c.pool(), 100000).value; });
  expect_found(mesh(), "phi3 leads to a face with as many darts",
               [](const CombinatorialMap&, Record& r, Cell) { r.neighbour(1) = Cell(7, 0).value; });
}

TEST_P(Planted, NeighbourFaceThatIsNone) {
  expect_found(mesh(), "phi3 leads to a face with as many darts", [](const CombinatorialMap&, Record& r, Cell) {
    for (unsigned f = 0; f < r.view.shape().face_count(); ++f) r.set_neighbour_face(f, r.general ? 99 : 6);
  });
}

TEST_P(Planted, NeighbourThatDoesNotPointBack) {
  expect_found(mesh(), "phi3 is an involution", [](const CombinatorialMap&, Record& r, Cell c) {
    r.neighbour(1) = Cell(c.pool(), c.index() == 0 ? 1 : 0).value;
    r.set_neighbour_face(1, 1);
  });
}

TEST_P(Planted, SewnToItself) {
  expect_found(mesh(), "phi3 is an involution", [](const CombinatorialMap&, Record& r, Cell c) {
    r.neighbour(1) = c.value;
    r.set_neighbour_face(1, 0);
  });
}

TEST_P(Planted, WallMarkTurned) {
  expect_found(mesh(), "a wall is where exactly one side is free",
               [](const CombinatorialMap&, Record& r, Cell) { r.flip_wall(1); });
}

// Faults planted in maps that were edited: each is found in the cell itself, and only as long as it is there.
TEST_P(Planted, AfterEdits) {
  CombinatorialMap map(mesh());
  Random random(41);
  {
    Transaction t(map);
    test::CellBag bag(map);
    for (int i = 0; i < 600; ++i) {
      const auto edit = draw_edit(map, draw_kind(bag, 60, random), bag.draw(map, random), bag, random);
      try {
        apply(t, edit);
        bag.update(t.commit());
      } catch (const Error&) {
        continue;
      }
    }
  }
  ASSERT_TRUE(check_integrity(map).empty());
  const std::vector<Cell> cells = map.cells();
  using Fault = std::function<void(Record&, unsigned face)>;
  const std::vector<Fault> faults = {
      [&](Record& r, unsigned) { r.vertex(1) = static_cast<std::uint32_t>(map.vertex_count()) + 5; },
      [](Record& r, unsigned) { r.vertex(0) = r.vertex(1); },
      [](Record& r, unsigned face) { r.neighbour(face) = Cell(6, 3).value; },
      [&](Record& r, unsigned face) { r.neighbour(face) = vacant_cell(map).value; },
      [](Record& r, unsigned face) {
        r.set_neighbour_face(face, r.view.neighbour_face(static_cast<std::uint16_t>(face)) == 0 ? 1 : 0);
      },
      [](Record& r, unsigned face) { r.flip_wall(face); }};
  for (int i = 0; i < 100; ++i) {
    const Cell c = cells[random.below(static_cast<std::uint32_t>(cells.size()))];
    Record record(map, c);
    const std::uint16_t faces = record.view.shape().face_count();
    unsigned face = 0;
    while (face < faces && !record.view.neighbour(static_cast<std::uint16_t>(face)).valid()) ++face;
    if (face == faces) continue;
    const std::vector<std::uint32_t> words(
        record.word, record.word + 2 + record.view.shape().point_count() + (record.general ? 2U : 1U) * faces);
    for (std::size_t k = 0; k < faults.size(); ++k) {
      faults[k](record, face);
      EXPECT_FALSE(check_integrity(map, {&c, 1}).empty()) << "fault " << k;
      std::copy(words.begin(), words.end(), record.word);
    }
  }
  EXPECT_TRUE(check_integrity(map).empty());
}

TEST(Integrity, BothSidesOfAFaceHaveOnePoint) {
  BoxOptions o;
  o.cells = {2, 1, 1};
  o.size = {1.0, 1.0, 1.0};
  CombinatorialMap map(generate_box(o));
  Transaction t(map);
  std::vector<CellDraft> drafts;
  const auto cells = map.cells();
  const Vertex point = t.add_vertex({}, {});
  for (const Cell c : cells) {
    drafts.push_back(draft_of(map, c));
    for (DraftFace& f : drafts.back().faces) f.point = f.across.face.valid() ? point : Vertex{};
  }
  const auto made = t.replace(cells, drafts);
  t.commit();
  ASSERT_TRUE(check_integrity(map).empty());
  Record(map, made[0]).vertex(8) = 0xfU;
  const auto found = check_integrity(map);
  ASSERT_TRUE(std::any_of(found.begin(), found.end(), [](const Violation& v) {
    return v.constraint == "both sides of a face are fanned from the same point";
  }));
}

TEST(Integrity, NamesAtMostSoManyAndOnlyTheCellsGiven) {
  const MeshData mesh = test::mixed_mesh();
  CombinatorialMap map(mesh);
  std::vector<Cell> others;
  for (const Cell c : map.cells()) {
    if (map.type(c) == CellType::prism) {
      std::swap(Record(map, c).vertex(0), Record(map, c).vertex(4));
    } else if (map.type(c) == CellType::polyhedron) {
      others.push_back(c);
    }
  }
  EXPECT_EQ(check_integrity(map, std::size_t{1}).size(), 1U);
  EXPECT_GT(check_integrity(map).size(), 1U);
  EXPECT_TRUE(check_integrity(map, others).empty());
}

}  // namespace dartcast::integrity_test
