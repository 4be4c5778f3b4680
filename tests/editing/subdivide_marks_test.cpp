// The marks that subdivide() leaves in the cells around, and its effect on cells that other edits made.
#include <gtest/gtest.h>

#include "base/random.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/remeshing.hpp"
#include "editing/outline.hpp"
#include "support/edit_meshes.hpp"
#include "support/expectations.hpp"
#include "support/remesh_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::subdivide_marks_test {

using test::refusal;

MeshData odd_box(CellType type) {
  BoxOptions o;
  o.cells = {3, 3, 3};
  o.origin = {0.1, 0.2, 0.3};
  o.size = {0.7, 1.1, 1.3};
  o.type = type;
  return generate_box(o);
}

// Signs of rounded middles cannot decide whether a face is straight. It is marked, and has a Steiner point.
TEST(SubdivideMarks, HangingMiddlesAreMarked) {
  CellComplex complex(odd_box(CellType::hexahedron));
  ComplexEdit edit(complex);
  const Subdivided s = subdivide(edit, complex.map().cells()[13]);
  edit.commit();
  const CombinatorialMap& map = complex.map();
  std::size_t hanging = 0;
  for (const Cell c : map.cells()) {
    const Shape& shape = map.shape(c);
    for (std::uint16_t d = 0; d < shape.dart_count(); ++d) {
      const auto& middles = s.subdivision.edge_middles;
      if (std::find(middles.begin(), middles.end(), map.origin({c, d})) == middles.end()) continue;
      // At a middle a face either turns or is straight: of a quadrilateral it is a corner.
      const CellFace f = map.face({c, d});
      const bool straight = shape.degree(f.face) > 4;
      EXPECT_EQ(map.flat({c, d}).straight, straight);
      EXPECT_EQ(map.point(f).valid(), straight);
      hanging += straight ? 1 : 0;
    }
  }
  // Both faces of each edge's three other cells hang. But the four quadrilaterals across a face are cut there.
  EXPECT_EQ(hanging, 12U * (3U * 2U - 2U));
}

// A middle of equal coordinates has that coordinate, however many digits it has.
TEST(SubdivideMarks, SidesOfABoxStayPlane) {
  for (const CellType type : {CellType::tetrahedron, CellType::hexahedron, CellType::prism, CellType::pyramid}) {
    CellComplex complex(odd_box(type));
    Random random(1);
    for (int i = 0; i < test::scaled(30, 300); ++i) {
      const auto cells = complex.map().cells();
      ComplexEdit edit(complex);
      subdivide(edit, cells[random.below(static_cast<std::uint32_t>(cells.size()))]);
      edit.commit();
    }
    for (const Cell c : complex.map().cells()) {
      const CellView v = complex.map().view(c);
      for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
        const std::uint16_t patch = complex.map().patch(CellFace{c, f}).value;
        EXPECT_EQ(patch != 0, !v.neighbour(f).valid());
        for (const std::uint16_t k : v.shape().corners(f)) {
          if (patch == complex.map().patch("xmin").value) EXPECT_EQ(complex.positions()[v.vertex(k).value].x, 0.1);
          if (patch == complex.map().patch("ymin").value) EXPECT_EQ(complex.positions()[v.vertex(k).value].y, 0.2);
          if (patch == complex.map().patch("zmin").value) EXPECT_EQ(complex.positions()[v.vertex(k).value].z, 0.3);
        }
      }
    }
  }
}

// Merged cells have marks between faces that are in no plane: they are subdivided by what they have.
TEST(SubdivideMarks, CellsThatWereMergedAtRandom) {
  int done = 0;
  int refused = 0;
  for (std::uint64_t seed = 0; seed < test::scaled<std::uint64_t>(20, 4000); ++seed) {
    Random random(seed);
    CellComplex complex(test::edit_box(seed % 2 == 0 ? CellType::tetrahedron : CellType::hexahedron, seed % 3 == 0, 2));
    ComplexEdit edit(complex);
    for (int i = 0; i < 30; ++i) {
      const auto cells = complex.map().cells();
      const Cell c = cells[random.below(static_cast<std::uint32_t>(cells.size()))];
      const auto d = static_cast<std::uint16_t>(random.below(complex.map().shape(c).dart_count()));
      refusal([&] {
        if (i % 3 == 0) {
          merge_cells(edit.topology(), complex.map().face({c, d}));
        } else if (i % 3 == 1) {
          merge_faces(edit.topology(), {c, d});
        } else {
          subdivide(edit, c);
        }
      });
    }
    for (const Cell c : complex.map().cells()) {
      if (!complex.map().contains(c)) continue;
      const CombinatorialMap before = complex.map();
      const std::string outcome = refusal([&] { subdivide(edit, c); });
      if (outcome == "done") {
        ++done;
      } else {
        ++refused;
        EXPECT_TRUE(complex.map() == before);
        test::expect_parts(outcome, {"refused: cell"});
      }
      ASSERT_TRUE(check_integrity(complex.map(), 1).empty());
    }
  }
  EXPECT_GT(done, 20 * refused);
}

TEST(SubdivideMarks, Refusals) {
  CellComplex complex(odd_box(CellType::hexahedron));
  ComplexEdit edit(complex);
  test::expect_parts(refusal([&] { subdivide(edit, Cell(1, 99)); }), {"invalid: there is no such cell"});
  const Subdivided s = subdivide(edit, complex.map().cells()[13]);
  Subdivision stale = s.subdivision;
  const Subdivided inner = subdivide(edit, s.cells[0]);
  test::expect_parts(refusal([&] { coarsen(edit, stale); }), {"invalid: coarsen: the part", "update_after_edit()"});
  update_after_edit(edit.map(), inner.cells, stale);
  test::expect_parts(refusal([&] { coarsen(edit, stale); }), {"refused: cell 13", "coarsen these first"});
  coarsen(edit, inner.subdivision);
  for (const Cell c : complex.map().cells()) update_after_edit(edit.map(), {&c, 1}, stale);
  edit.topology().set_free(stale.part.cell, false);
  test::expect_parts(refusal([&] { coarsen(edit, stale); }), {"refused: cell 13", "mark them alike first"});
  edit.topology().set_free(stale.part.cell, true);
  coarsen(edit, stale);
  EXPECT_EQ(complex.map().cell_count(), 27U);
}

}  // namespace dartcast::subdivide_marks_test
