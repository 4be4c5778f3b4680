// Edits with positions, against exact volumes and against the complex built anew.
#include "dartcast/complex_edit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <optional>

#include "dartcast/error.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/predicates.hpp"
#include "dartcast/validity.hpp"
#include "oracle/fraction.hpp"
#include "support/edit_meshes.hpp"
#include "support/random_edits.hpp"
#include "support/tier.hpp"

namespace dartcast::complex_edit_test {

using oracle::Exact;

Exact volume6(const Corners& v) {
  const auto minus = [&](const Vec3& a) {
    return std::array<Exact, 3>{Exact(a.x) - Exact(v[0].x), Exact(a.y) - Exact(v[0].y), Exact(a.z) - Exact(v[0].z)};
  };
  const auto a = minus(v[1]);
  const auto b = minus(v[2]);
  const auto c = minus(v[3]);
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

Exact volume6(const CellComplex& complex) {
  Exact sum(0);
  for (const Cell c : complex.map().cells()) {
    for (std::uint16_t s = 0; s < complex.map().shape(c).simplices().size(); ++s)
      sum = sum + volume6(complex.corners({c, s}));
  }
  return sum;
}

std::uint64_t count_simplices(const CellComplex& complex) {
  std::uint64_t sum = 0;
  for (const Cell c : complex.map().cells()) sum += complex.map().shape(c).simplices().size();
  return sum;
}

// Cell points and face points, each once.
std::size_t count_interior(const CellComplex& complex) {
  std::map<std::uint32_t, int> seen;
  for (const Cell c : complex.map().cells()) {
    const CellView v = complex.map().view(c);
    for (std::uint16_t k = v.shape().corner_count(); k < v.shape().point_count(); ++k) ++seen[v.vertex(k).value];
  }
  return seen.size();
}

void expect_sound(const CellComplex& complex) {
  ASSERT_TRUE(check_integrity(complex.map(), 1).empty());
  const Validity validity = check_validity(complex, {});
  ASSERT_TRUE(validity.valid()) << validity.first.front().message;
  EXPECT_EQ(complex.simplex_count(), count_simplices(complex));
  EXPECT_EQ(complex.steiner_point_count(), count_interior(complex));
  EXPECT_GE(complex.positions().size(), complex.map().vertex_count());
}

class ComplexEdits : public testing::TestWithParam<test::EditMesh> {};

// A shear of few digits: planes stay planes, and no place is rounded.
Vec3 sheared(const Vec3& x, double by) { return {x.x + by * x.y, x.y, x.z - by * x.x * 0.5}; }

// With coordinates of few digits, so that middles of middles are exact.
MeshData in_few_digits(MeshData mesh) {
  for (Vec3& x : mesh.points)
    x = {std::nearbyint(x.x * 48.0) / 4.0, std::nearbyint(x.y * 48.0) / 4.0, std::nearbyint(x.z * 48.0) / 4.0};
  return mesh;
}

CellComplex prepared(const MeshData& mesh) {
  CellComplex complex(mesh);
  const ComplexEdit counts_what_edits_need(complex);
  return complex;
}

bool in_one_plane(ComplexEdit& edit, std::span<const Dart> path) {
  std::vector<Vec3> x;
  for (const Dart d : path) x.push_back(edit.position(edit.map().origin(d)));
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      for (std::size_t k = 0; k < j; ++k) {
        for (std::size_t l = 0; l < k; ++l) {
          if (orient3d(x[i], x[j], x[k], x[l]) != Sign::zero) return false;
        }
      }
    }
  }
  return true;
}

// In the plane, where corners of the boundary may have two edges without being straight.
bool goes_straight_on(ComplexEdit& edit, Dart d) {
  const CombinatorialMap& map = edit.map();
  const auto at = [&](Dart x) { return edit.position(map.origin(x)); };
  return map.dimension() == 3 || orient2d(at(map.phi_1(d)), at(d), at(map.phi1(d))) == Sign::zero;
}

// Whether an edit leaves convex cells convex.
bool is_planar(ComplexEdit& edit, const test::Edit& e) {
  if (e.darts.empty()) return true;
  switch (e.kind) {
    case test::EditKind::merge_faces: return edit.map().dimension() == 3 && edit.map().flat(e.darts[0]).coplanar;
    case test::EditKind::merge_edges: return edit.map().flat(e.darts[0]).straight && goes_straight_on(edit, e.darts[0]);
    case test::EditKind::split_cell: return in_one_plane(edit, e.darts);
    case test::EditKind::merge_cells:
    case test::EditKind::sew: return false;
    default: return true;
  }
}

// Edits at random, one at a time.
class RandomEdits {
 public:
  RandomEdits(const MeshData& mesh, bool planar)
      : complex(prepared(in_few_digits(mesh))), planar_(planar), bag_(complex.map()), usual_(bag_.size()) {}

  /// Nothing where the edit was refused.
  std::optional<ComplexEditReport> make() {
    ComplexEdit edit(complex);
    kind = test::draw_kind(bag_, usual_, random, complex.map().dimension());
    try {
      const test::Edit e = test::draw_edit(edit.map(), kind, bag_.draw(edit.map(), random), bag_, random);
      if (planar_ && !is_planar(edit, e)) return {};
      test::apply(edit.topology(), e);
      ComplexEditReport report = edit.commit();
      bag_.update(report.map);
      ++done[kind];
      return report;
    } catch (const Error&) {
      return {};
    }
  }

  CellComplex complex;
  Random random = Random(42);
  test::EditKind kind{};
  std::map<test::EditKind, int> done;

 private:
  bool planar_;
  test::CellBag bag_;
  std::size_t usual_;
};

void expect_same(const CellComplex& complex, const CellComplex& before) {
  ASSERT_EQ(complex.map(), before.map());
  for (std::uint32_t v = 0; v < complex.map().vertex_count(); ++v) {
    if (complex.map().is_vertex(Vertex(v))) ASSERT_EQ(complex.positions()[v], before.positions()[v]);
  }
}

TEST_P(ComplexEdits, LeaveAValidComplexOfTheSameVolume) {
  RandomEdits edits(GetParam().make(), false);
  Exact volume = volume6(edits.complex);
  int refused = 0;
  for (int i = 0; i < test::scaled(400, 4000); ++i) {
    std::optional<CellComplex> before;
    if (i % 50 == 0) before = edits.complex;
    const auto report = edits.make();
    refused += report ? 0 : 1;
    if (!report && before) expect_same(edits.complex, *before);
    if (!report) continue;
    for (const Cell c : report->map.added) ASSERT_FALSE(check_cell(edits.complex.map(), edits.complex.positions(), c));
    const bool from_now =
        edits.kind == test::EditKind::remove || edits.kind == test::EditKind::sew || report->boundary_shift > 0.0;
    if (i % 20 != 0 && !from_now) continue;
    expect_sound(edits.complex);
    const Exact now = volume6(edits.complex);
    if (!from_now) ASSERT_EQ(now, volume) << "edit " << i << " of kind " << static_cast<int>(edits.kind);
    volume = now;
  }
  EXPECT_GT(refused, 0);
  if (test::sanitized()) return;
  for (const auto kind : {test::EditKind::split_edge, test::EditKind::split_face, test::EditKind::split_cell,
                          test::EditKind::merge_cells, test::EditKind::mark})
    EXPECT_GT(edits.done[test::in_dimension(kind, edits.complex.map().dimension())], 0) << static_cast<int>(kind);
}

// Among planes, nothing moves but by what is said; and cells stay convex when the whole is sheared.
TEST_P(ComplexEdits, AmongPlanesMoveNothing) {
  RandomEdits edits(GetParam().make(), true);
  CellComplex& complex = edits.complex;
  Exact volume = volume6(complex);
  for (int i = 0; i < test::scaled(400, 4000); ++i) {
    const auto report = edits.make();
    if (!report) continue;
    ASSERT_EQ(report->boundary_shift, 0.0) << "edit " << i << " of kind " << static_cast<int>(edits.kind);
    if (edits.kind == test::EditKind::remove) volume = volume6(complex);
    if (i % 20 != 0) continue;
    expect_sound(complex);
    ASSERT_EQ(volume6(complex), volume);
    const auto next = complex.next_positions();
    for (std::size_t v = 0; v < next.size(); ++v) next[v] = sheared(complex.positions()[v], i % 40 == 0 ? 0.25 : -0.25);
    complex.commit_positions();
    expect_sound(complex);
    volume = volume6(complex);
  }
  EXPECT_TRUE(test::sanitized() || edits.done[test::EditKind::split_edge] > 0);
}

INSTANTIATE_TEST_SUITE_P(Meshes, ComplexEdits, testing::ValuesIn(test::all_edit_meshes()),
                         [](const auto& mesh) { return std::string(mesh.param.name); });

CellComplex one_box() {
  BoxOptions o;
  o.cells = {1, 1, 1};
  o.blocked_layer = false;
  return prepared(generate_box(o));
}

Dart any_dart(const CombinatorialMap& map) { return {map.cells().front(), 0}; }

TEST(ComplexEdit, PutsAVertexInTheMiddleOfItsEdgeUnlessItIsPlaced) {
  CellComplex complex = one_box();
  ComplexEdit edit(complex);
  const Dart d = any_dart(edit.map());
  const Vec3 a = edit.position(edit.map().origin(d));
  const Vec3 b = edit.position(edit.map().origin(edit.map().phi1(d)));
  const Vertex v = split_edge(edit.topology(), d).vertex;
  EXPECT_EQ(edit.position(v), (a + b) * 0.5);
  edit.place(v, a + (b - a) * 0.25);
  const ComplexEditReport report = edit.commit();
  EXPECT_EQ(complex.positions()[v.value], a + (b - a) * 0.25);
  ASSERT_EQ(report.placed.size(), 1U);
  EXPECT_EQ(report.placed[0].weights, (std::vector<double>{0.75, 0.25}));
  EXPECT_EQ(report.placed[0].offset, Vec3{});
  EXPECT_EQ(complex.point_count(), v.value + 1U);
}

TEST(ComplexEdit, TakesEverythingBackWhereACellIsNotConvex) {
  CellComplex complex = one_box();
  const CellComplex before = complex;
  {
    ComplexEdit edit(complex);
    const Dart d = any_dart(edit.map());
    const Vec3 far = edit.position(edit.map().origin(d)) + Vec3{-100.0, 70.0, 50.0};
    edit.place(split_edge(edit.topology(), d).vertex, far);
    EXPECT_THROW(edit.commit(), EditRefused);
    EXPECT_EQ(complex.map(), before.map());
    EXPECT_EQ(complex.positions().size(), before.positions().size());
    split_edge(edit.topology(), any_dart(edit.map()));  // and goes on
    EXPECT_NO_THROW(edit.commit());
  }
  EXPECT_EQ(complex.map().vertex_count(),
            before.map().vertex_count() + 2 + 2);  // the middle, the two faces', the cell's
}

// Between a move and the next one, new vertices count as not moved.
TEST(ComplexEdit, GivesNewVerticesAPast) {
  CellComplex complex = one_box();
  const auto next = complex.next_positions();
  for (std::size_t v = 0; v < next.size(); ++v) next[v] = complex.positions()[v] + Vec3{0.5, 0.0, 0.0};
  complex.commit_positions();
  ComplexEdit edit(complex);
  const Vertex v = split_edge(edit.topology(), any_dart(edit.map())).vertex;
  const ComplexEditReport report = edit.commit();
  EXPECT_EQ(complex.previous_positions()[v.value], complex.positions()[v.value]);
  EXPECT_EQ(complex.previous_positions()[0], complex.positions()[0] - (Vec3{0.5, 0.0, 0.0}));
  EXPECT_FALSE(report.map.created.empty());
}

TEST(ComplexEdit, WithoutACommitIsNothing) {
  CellComplex complex = one_box();
  const CellComplex before = complex;
  {
    ComplexEdit edit(complex);
    edit.place(split_edge(edit.topology(), any_dart(edit.map())).vertex, {0.0, 0.0, 0.0});
  }
  EXPECT_EQ(complex.map(), before.map());
  EXPECT_EQ(complex.positions().size(), before.positions().size());
}

TEST(ComplexEdit, RefusesPlacesThatAreNone) {
  CellComplex complex = one_box();
  ComplexEdit edit(complex);
  EXPECT_THROW(edit.place(Vertex(0), {0.0, 0.0, 0.0}), InvalidArgument);
  EXPECT_THROW(static_cast<void>(edit.position(Vertex(1000))), InvalidArgument);
  const Vertex v = split_edge(edit.topology(), any_dart(edit.map())).vertex;
  EXPECT_THROW(edit.place(v, {1e200, 0.0, 0.0}), InvalidArgument);
  EXPECT_THROW(edit.place(v, std::vector<Vertex>{Vertex(0)}, std::vector<double>{0.5, 0.5}), InvalidArgument);
  const auto mark = edit.savepoint();
  const Vertex w = split_edge(edit.topology(), any_dart(edit.map())).vertex;
  edit.place(w, {0.25, 0.0, 0.0});
  edit.roll_back(mark);
  EXPECT_THROW(edit.place(w, {0.25, 0.0, 0.0}), InvalidArgument);
}

// A quadrilateral wall of a warped cell, split along either diagonal.
TEST(ComplexEdit, ReportsHowFarAWarpedWallMoved) {
  BoxOptions o;
  o.cells = {1, 1, 1};
  o.blocked_layer = false;
  MeshData mesh = generate_box(o);
  mesh.points[7] += Vec3{0.0, 0.0, 0.125};
  CellComplex complex(mesh);
  const CombinatorialMap& map = complex.map();
  const Cell c = map.cells().front();
  int moved = 0;
  for (std::uint16_t f = 0; f < map.shape(c).face_count(); ++f) {
    for (const unsigned k : {0U, 1U}) {
      CellComplex copy = complex;
      ComplexEdit edit(copy);
      const auto first = static_cast<std::uint16_t>(map.shape(c).first_dart(f) + k);
      split_face(edit.topology(), {c, first}, {c, static_cast<std::uint16_t>(first + 2)});
      const double shift = edit.commit().boundary_shift;
      EXPECT_LE(shift, 0.125);
      moved += shift > 0.05 ? 1 : 0;
    }
  }
  EXPECT_EQ(moved, 1);  // the warped face, along the diagonal that it did not have
}

// Values at vertices follow: a linear function stays the same.
TEST(ComplexEdit, ValuesFollow) {
  CellComplex complex(test::edit_box(CellType::hexahedron));
  const auto linear = [](const Vec3& x) { return 3.0 * x.x - 2.0 * x.y + x.z + 1.0; };
  std::vector<double> values;
  for (const Vec3& x : complex.positions()) values.push_back(linear(x));
  Random random(7);
  for (int i = 0; i < 50; ++i) {
    ComplexEdit edit(complex);
    for (int k = 0; k < 3; ++k) {
      const auto cells = edit.map().cells();
      const Cell c = cells[random.below(static_cast<std::uint32_t>(cells.size()))];
      const Dart d{c, static_cast<std::uint16_t>(random.below(edit.map().shape(c).dart_count()))};
      const Vertex v = split_edge(edit.topology(), d).vertex;
      if (k > 0) continue;
      const CreatedVertex& created = edit.topology().created(edit.topology().created_count() - 1);
      edit.place(v, std::vector<Vertex>{created.from, created.other}, std::vector<double>{0.25, 0.75});
    }
    const ComplexEditReport report = edit.commit();
    update_after_edit(report, complex.point_count(), values);
    for (const PlacedVertex& p : report.placed)
      EXPECT_NEAR(values[p.vertex.value], linear(complex.positions()[p.vertex.value]), 1e-12);
  }
}

}  // namespace dartcast::complex_edit_test
