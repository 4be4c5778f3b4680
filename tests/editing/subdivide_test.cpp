#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "base/random.hpp"
#include "dartcast/error.hpp"
#include "dartcast/remeshing.hpp"
#include "support/edit_meshes.hpp"
#include "support/expectations.hpp"
#include "support/remesh_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::subdivide_test {

using test::expect_sound;
using test::volume6;
using test::written;

// Subdivided cells, most recent last; parts are found again after every edit.
class Refinement {
 public:
  explicit Refinement(CellComplex& complex) : complex_(complex) {}

  void subdivide(Cell c) {
    ComplexEdit edit(complex_);
    const Subdivision made = dartcast::subdivide(edit, c).subdivision;
    finish(edit, [&] { all_.push_back(made); });
  }

  // False where its parts are subdivided themselves.
  bool coarsen(std::size_t i) {
    ComplexEdit edit(complex_);
    try {
      dartcast::coarsen(edit, all_[i]);
    } catch (const EditRefused&) {
      return false;
    }
    finish(edit, [&] { all_.erase(all_.begin() + static_cast<std::ptrdiff_t>(i)); });
    return true;
  }

  [[nodiscard]] std::size_t size() const { return all_.size(); }
  [[nodiscard]] const Subdivision& operator[](std::size_t i) const { return all_[i]; }

 private:
  template <class List>
  void finish(ComplexEdit& edit, List&& list) {
    const ComplexEditReport report = edit.commit();
    list();
    for (Subdivision& s : all_) update_after_edit(complex_.map(), report.map.added, s);
  }

  CellComplex& complex_;
  std::vector<Subdivision> all_;
};

MeshData unit_boxes(std::uint32_t n, CellType type) {
  BoxOptions o;
  o.cells = {n, n, n};
  o.size = {4.0 * n, 4.0 * n, 4.0 * n};
  o.type = type;
  return generate_box(o);
}

std::size_t vertices_in_use(const CombinatorialMap& map) {
  std::size_t count = 0;
  for (std::uint32_t v = 0; v < map.vertex_count(); ++v) count += map.is_vertex(Vertex(v)) ? 1 : 0;
  return count;
}

bool has_flat(const CombinatorialMap& map) {
  const auto cells = map.cells();
  return std::any_of(cells.begin(), cells.end(), [&](Cell c) { return map.has_flat(c); });
}

TEST(Subdivide, HexahedronGivesEightHexahedra) {
  CellComplex complex(unit_boxes(1, CellType::hexahedron));
  ComplexEdit edit(complex);
  const Subdivided s = subdivide(edit, complex.map().cells()[0]);
  const ComplexEditReport done = edit.commit();
  EXPECT_EQ(done.placed.size(), 19U);
  for (const PlacedVertex& p : done.placed) EXPECT_EQ(p.offset, Vec3{});  // all are means of others
  expect_sound(complex);
  EXPECT_EQ(complex.map().cell_count(static_cast<std::uint32_t>(CellType::hexahedron)), 8U);
  EXPECT_EQ(complex.map().cell_count(), 8U);
  EXPECT_EQ(complex.positions()[s.subdivision.middle.value], (Vec3{2.0, 2.0, 2.0}));
  EXPECT_EQ(s.subdivision.edge_middles.size(), 12U);
  EXPECT_EQ(s.subdivision.face_middles.size(), 6U);
  EXPECT_EQ(vertices_in_use(complex.map()), 27U);
  EXPECT_EQ(complex.map().wall_face_count(), 24U);
}

TEST(Subdivide, PartsOfEachType) {
  struct Case {
    CellType type;
    std::size_t parts;
    std::size_t hexahedra;
  };
  for (const Case& c :
       {Case{CellType::tetrahedron, 4, 4}, Case{CellType::prism, 6, 6}, Case{CellType::pyramid, 5, 4}}) {
    CellComplex complex(unit_boxes(1, c.type));
    ComplexEdit edit(complex);
    const Subdivided s = subdivide(edit, complex.map().cells()[0]);
    EXPECT_EQ(s.subdivision.corners.size(), c.parts);
    std::size_t hexahedra = 0;
    for (std::size_t i = 0; i < c.parts; ++i) hexahedra += edit.map().type(s.cells[i]) == CellType::hexahedron ? 1 : 0;
    EXPECT_EQ(hexahedra, c.hexahedra);
    edit.commit();
    expect_sound(complex);
  }
}

// One cell after another, in any order, and the parts before the neighbours are: what comes out is the fine grid.
TEST(Subdivide, AnyOrderGivesTheFineGrid) {
  std::size_t edits = 0;
  for (std::uint64_t seed = 0; seed < test::scaled<std::uint64_t>(3, 500); ++seed) {
    Random random(seed);
    CellComplex complex(unit_boxes(2, CellType::hexahedron));
    const std::vector<std::string> before = written(complex.map());
    Refinement refinement(complex);
    const auto edge = [&](Cell c) {
      const CellView v = complex.map().view(c);
      double low = 1e9;
      double high = -1e9;
      for (std::uint16_t k = 0; k < v.shape().corner_count(); ++k) {
        low = std::min(low, complex.positions()[v.vertex(k).value].x);
        high = std::max(high, complex.positions()[v.vertex(k).value].x);
      }
      return high - low;
    };
    for (;;) {
      std::vector<Cell> coarse = complex.map().cells();
      std::erase_if(coarse, [&](Cell c) { return edge(c) <= 1.0; });
      if (coarse.empty()) break;
      refinement.subdivide(coarse[random.below(static_cast<std::uint32_t>(coarse.size()))]);
      if (seed < 3 && edits++ % test::stride(1, 8) == 0) expect_sound(complex);
    }
    expect_sound(complex);
    EXPECT_EQ(complex.map().cell_count(static_cast<std::uint32_t>(CellType::hexahedron)), 512U);
    EXPECT_EQ(complex.map().cell_count(), 512U);
    EXPECT_EQ(vertices_in_use(complex.map()), 729U);
    EXPECT_FALSE(has_flat(complex.map()));
    while (refinement.size() > 0) {
      refinement.coarsen(random.below(static_cast<std::uint32_t>(refinement.size())));
      if (seed < 3 && edits++ % test::stride(1, 8) == 0) expect_sound(complex);
    }
    EXPECT_EQ(written(complex.map()), before);
    EXPECT_EQ(vertices_in_use(complex.map()), 27U);
  }
}

class OnMeshes : public testing::TestWithParam<test::EditMesh> {};

TEST_P(OnMeshes, CoarsenRestores) {
  CellComplex complex(GetParam().make());
  const std::vector<std::string> before = written(complex.map());
  const std::vector<Vec3> positions(complex.positions().begin(),
                                    complex.positions().begin() + static_cast<std::ptrdiff_t>(complex.point_count()));
  const std::size_t used = vertices_in_use(complex.map());
  Random random(7);
  for (int i = 0; i < test::scaled(20, 1000); ++i) {
    const auto cells = complex.map().cells();
    Refinement refinement(complex);
    refinement.subdivide(cells[random.below(static_cast<std::uint32_t>(cells.size()))]);
    if (i < 5) expect_sound(complex);
    ASSERT_TRUE(refinement.coarsen(0));
    if (i < 5) expect_sound(complex);
    ASSERT_EQ(written(complex.map()), before);
    EXPECT_TRUE(std::equal(positions.begin(), positions.end(), complex.positions().begin()));
  }
  EXPECT_EQ(vertices_in_use(complex.map()), used);
}

// In one edit, without a commit between; taken back, the map is the same to the last record.
TEST_P(OnMeshes, TakenBack) {
  CellComplex complex(GetParam().make());
  { ComplexEdit first(complex); }
  const CombinatorialMap before = complex.map();
  {
    ComplexEdit edit(complex);
    const auto cells = complex.map().cells();
    std::vector<Subdivision> all;
    for (std::size_t i = 0; i < cells.size(); i += 3) {
      if (!complex.map().contains(cells[i])) continue;
      const Subdivided s = subdivide(edit, cells[i]);
      for (Subdivision& other : all) update_after_edit(edit.map(), s.cells, other);
      all.push_back(s.subdivision);
    }
    EXPECT_TRUE(check_integrity(complex.map()).empty());
    for (std::size_t i = 0; i < all.size(); i += 2) {
      const auto news = coarsen(edit, all[i]);
      for (std::size_t k = i + 1; k < all.size(); ++k) update_after_edit(edit.map(), news, all[k]);
    }
    EXPECT_TRUE(check_integrity(complex.map()).empty());
  }
  EXPECT_TRUE(complex.map() == before);
}

TEST_P(OnMeshes, RandomSequences) {
  CellComplex complex(GetParam().make());
  const std::vector<std::string> before = written(complex.map());
  const test::Dyadic volume = volume6(complex);
  const bool exact =
      std::string_view(GetParam().name) != "octahedra" && std::string_view(GetParam().name) != "handmade";
  const std::size_t usual = complex.map().cell_count();
  Refinement refinement(complex);
  Random random(11);
  int refused = 0;
  const int edits = test::scaled(40, 3000);
  for (int i = 0; i < edits; ++i) {
    const auto cells = complex.map().cells();
    const std::vector<std::string> here = written(complex.map());
    try {
      if (cells.size() > 2 * usual + 50 || (refinement.size() > 0 && random.below(3) == 0)) {
        refinement.coarsen(random.below(static_cast<std::uint32_t>(refinement.size())));
      } else {
        refinement.subdivide(cells[random.below(static_cast<std::uint32_t>(cells.size()))]);
      }
    } catch (const EditRefused&) {  // parts of warped cells, some levels down: no point makes all simplices positive
      ++refused;
      ASSERT_EQ(written(complex.map()), here);
    }
    expect_sound(complex);
    if (i % 20 != 0) continue;
    const test::Dyadic change = volume6(complex) - volume;
    EXPECT_TRUE(exact ? change.sign() == 0 : change.abs() < test::Dyadic(1e-12) * volume);
  }
  EXPECT_LE(refused, exact ? 0 : edits / 10);
  while (refinement.size() > 0) refinement.coarsen(random.below(static_cast<std::uint32_t>(refinement.size())));
  expect_sound(complex);
  EXPECT_EQ(written(complex.map()), before);
}

// Cells that are made again leave no trace next to those that stay subdivided, whatever the order.
TEST_P(OnMeshes, NoTraceOfOthers) {
  for (std::uint64_t seed = 0; seed < test::scaled<std::uint64_t>(2, 300); ++seed) {
    Random random(seed);
    CellComplex complex(GetParam().make());
    CellComplex other(GetParam().make());
    const auto cells = complex.map().cells();
    std::vector<std::uint32_t> sources(cells.size());
    for (std::uint32_t i = 0; i < sources.size(); ++i) sources[i] = i;
    for (std::size_t i = sources.size(); i > 1; --i)
      std::swap(sources[i - 1], sources[random.below(static_cast<std::uint32_t>(i))]);
    sources.resize(cells.size() / 2);
    const auto of_source = [](const CombinatorialMap& map, std::uint32_t source) {
      for (const Cell c : map.cells()) {
        if (map.source(c) == source) return c;
      }
      return Cell{};
    };
    Refinement refinement(complex);
    for (const std::uint32_t s : sources) refinement.subdivide(of_source(complex.map(), s));
    std::size_t kept = sources.size();
    for (std::size_t i = sources.size(); i-- > 0;) {
      if (i % 2 == 0 || !refinement.coarsen(i)) continue;
      sources.erase(sources.begin() + static_cast<std::ptrdiff_t>(i));
      --kept;
    }
    ASSERT_EQ(kept, refinement.size());
    Refinement alone(other);
    for (std::size_t i = sources.size(); i-- > 0;) alone.subdivide(of_source(other.map(), sources[i]));
    ASSERT_EQ(test::written_by_place(complex), test::written_by_place(other));
  }
}

INSTANTIATE_TEST_SUITE_P(Meshes, OnMeshes, testing::ValuesIn(test::edit_meshes()),
                         [](const auto& mesh) { return std::string(mesh.param.name); });

}  // namespace dartcast::subdivide_test
