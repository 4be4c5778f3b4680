// Sections of meshes of every cell type: exact volumes along dyadic planes, and random planes.
#include <algorithm>
#include <cmath>

#include "base/random.hpp"
#include "dartcast/cutting.hpp"
#include "dartcast/error.hpp"
#include "support/expectations.hpp"
#include "support/surgery_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::section_test {

using test::Before;
using test::Dyadic;
using test::volume6;

struct Bounds {
  Vec3 low, high;
};

Bounds bounds_of(const CellComplex& complex) {
  Bounds b = {complex.positions()[0], complex.positions()[0]};
  for (const Vec3& x : complex.positions()) {
    b.low = {std::min(b.low.x, x.x), std::min(b.low.y, x.y), std::min(b.low.z, x.z)};
    b.high = {std::max(b.high.x, x.x), std::max(b.high.y, x.y), std::max(b.high.z, x.z)};
  }
  return b;
}

Plane random_plane(const CellComplex& complex, Random& random) {
  const Bounds b = bounds_of(complex);
  const Vec3 x = {random.uniform(b.low.x, b.high.x), random.uniform(b.low.y, b.high.y),
                  random.uniform(b.low.z, b.high.z)};
  return plane_through(x, {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)});
}

// Six times the volume of a tetrahedron's part below a plane, by similar tetrahedra: the truth for sections of cells
// with planar faces.
double below6(Corners v, const Plane& plane) {
  std::array<double, 4> h;
  std::sort(v.begin(), v.end(), [&](const Vec3& a, const Vec3& b) { return plane.height(a) < plane.height(b); });
  for (unsigned i = 0; i < 4; ++i) h[i] = plane.height(v[i]);
  const double all = std::abs(dot(cross(v[1] - v[0], v[2] - v[0]), v[3] - v[0]));
  if (h[0] >= 0.0) return 0.0;
  if (h[3] <= 0.0) return all;
  const auto share = [&](unsigned i, unsigned k) { return h[i] / (h[i] - h[k]); };
  if (h[1] >= 0.0) return all * share(0, 1) * share(0, 2) * share(0, 3);
  if (h[2] <= 0.0) return all * (1.0 - share(3, 0) * share(3, 1) * share(3, 2));
  // Two below, two above: a wedge, as the sum of three tetrahedra.
  const double a = share(0, 2), b = share(0, 3), c = share(1, 2), d = share(1, 3);
  return all * (a * b * (1.0 - c) * 1.0 + b * c * (1.0 - d) + c * d);
}

double below6(const CellComplex& complex, const Plane& plane) {
  double sum = 0.0;
  for (const Cell c : complex.map().cells()) {
    for (std::uint16_t s = 0; s < complex.map().shape(c).simplices().size(); ++s)
      sum += below6(complex.corners({c, s}), plane);
  }
  return sum;
}

double farthest(const CellComplex& complex, std::span<const Cell> cells, const Plane& plane) {
  double far = 0.0;
  for (const Cell c : cells) {
    const CellView v = complex.map().view(c);
    for (std::uint16_t k = 0; k < v.shape().corner_count(); ++k)
      far = std::max(far, plane.height(complex.positions()[v.vertex(k).value]));
  }
  return far;
}

void update(Section& section, const ComplexEditReport& report) {
  section.below = test::now(report, section.below);
  section.above = test::now(report, section.above);
}

class Sections : public testing::TestWithParam<test::EditMesh> {};
INSTANTIATE_TEST_SUITE_P(Surgery, Sections, testing::ValuesIn(test::edit_meshes()),
                         [](const auto& i) { return std::string(i.param.name); });

// Where the truth is of few digits, nothing is rounded: planes across the axes at quarters of the cells.
TEST_P(Sections, PartAxisAlignedVolumesExactly) {
  MeshData mesh = GetParam().make();
  for (Vec3& x : mesh.points)
    x = {std::nearbyint(x.x * 48.0) / 4.0, std::nearbyint(x.y * 48.0) / 4.0, std::nearbyint(x.z * 48.0) / 4.0};
  for (const Vec3& normal : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, -1}}) {
    CellComplex complex(mesh);
    const Bounds b = bounds_of(complex);
    const Plane plane = plane_through(b.low + (b.high - b.low) * 0.375, normal);
    const Dyadic before = volume6(complex);
    const double below = below6(complex, plane);
    ComplexEdit edit(complex);
    Section section = split_by_plane(edit, complex.map().cells(), plane, {SectionOptions::min_snap});
    update(section, edit.commit());
    test::expect_sound(complex);
    ASSERT_FALSE(HasFatalFailure());
    EXPECT_TRUE(section.whole.empty());
    EXPECT_EQ(section.below.size() + section.above.size(), complex.map().cell_count());
    EXPECT_TRUE(volume6(complex) == before);
    EXPECT_TRUE(test::near(volume6(complex, section.below), Dyadic(below), 1e-9));
    EXPECT_TRUE(volume6(complex, section.below) + volume6(complex, section.above) == before);
    EXPECT_LE(farthest(complex, section.below, plane), 0.0);
    EXPECT_LE(farthest(complex, section.above, plane.turned()), 0.0);
  }
}

TEST_P(Sections, PartRandomly) {
  const MeshData mesh = GetParam().make();
  Random random(5);
  for (int i = 0; i < std::max(1, test::scaled(4, 400)); ++i) {
    SCOPED_TRACE(i);
    CellComplex complex(mesh);
    const Plane plane = random_plane(complex, random);
    const SectionOptions options = {i % 2 == 0 ? SectionOptions::min_snap : SectionOptions{}.snap};
    const Dyadic before = volume6(complex);
    const double below = below6(complex, plane);
    const double size = norm(bounds_of(complex).high - bounds_of(complex).low);
    ComplexEdit edit(complex);
    Section section = split_by_plane(edit, complex.map().cells(), plane, options);
    const ComplexEditReport report = edit.commit();
    update(section, report);
    test::expect_sound(complex);
    ASSERT_FALSE(HasFatalFailure());
    EXPECT_TRUE(section.whole.empty());
    // Each corner of the hull is off by a few units in the last place of the size at most.
    EXPECT_TRUE(test::near(volume6(complex), before, 0x1p-40 * size * size * size));
    EXPECT_LE(report.boundary_shift, 0x1p-48 * size);
    const double off = options.snap * size * size * size;
    EXPECT_TRUE(test::near(volume6(complex, section.below), Dyadic(below), 6.0 * off));
    EXPECT_LE(farthest(complex, section.below, plane), (options.snap + 0x1p-45) * size);
    EXPECT_LE(farthest(complex, section.above, plane.turned()), (options.snap + 0x1p-45) * size);
  }
}

// A few cells in the middle are split; those around take the new vertices into their faces and stay whole.
TEST_P(Sections, EndAtCellsThatAreNotNamed) {
  CellComplex complex(GetParam().make());
  Random random(6);
  for (int i = 0; i < std::max(1, test::scaled(4, 200)); ++i) {
    SCOPED_TRACE(i);
    const std::vector<Cell> all = complex.map().cells();
    std::vector<Cell> some;
    for (const Cell c : all) {
      if (random.below(4) == 0) some.push_back(c);
    }
    const Dyadic before = volume6(complex);
    const std::size_t free = static_cast<std::size_t>(
        std::count_if(all.begin(), all.end(), [&](Cell c) { return complex.map().is_free(c); }));
    ComplexEdit edit(complex);
    try {
      const Section section = split_by_plane(edit, some, random_plane(complex, random));
      EXPECT_EQ(edit.map().cell_count(), all.size() - some.size() + section.below.size() + section.above.size());
      edit.commit();
    } catch (const EditRefused&) {
      continue;
    }
    test::expect_sound(complex);
    ASSERT_FALSE(HasFatalFailure());
    EXPECT_TRUE(test::near(volume6(complex), before, 1e-9));
    EXPECT_GE(complex.map().cell_count(), all.size());
    EXPECT_GE(complex.map().cell_count(), free);
    if (complex.map().cell_count() > 4 * all.size() || i % 5 == 4) complex = CellComplex(GetParam().make());
  }
}

// Tilted so little against a layer of faces that some of its vertices count as on the plane and some do not.
TEST_P(Sections, PartAlmostAlongFaces) {
  const MeshData mesh = GetParam().make();
  Random random(8);
  for (int i = 0; i < std::max(1, test::scaled(12, 400)); ++i) {
    SCOPED_TRACE(i);
    CellComplex complex(mesh);
    const Vec3 x = complex.positions()[random.below(static_cast<std::uint32_t>(complex.positions().size()))];
    Vec3 normal = {random.uniform(-0.05, 0.05), random.uniform(-0.05, 0.05), i % 2 == 0 ? 1.0 : -1.0};
    if (i % 3 == 1) normal = {normal.z, normal.x, normal.y};
    const Plane plane = plane_through(x + normal * random.uniform(-0.01, 0.01), normal);
    const Dyadic before = volume6(complex);
    ComplexEdit edit(complex);
    EXPECT_TRUE(split_by_plane(edit, complex.map().cells(), plane, {1.0 / 32.0}).whole.empty());
    edit.commit();
    test::expect_sound(complex);
    ASSERT_FALSE(HasFatalFailure());
    EXPECT_TRUE(test::near(volume6(complex), before, 1e-9));
  }
}

TEST(Section, SplitsNothingAlongFaces) {
  CellComplex complex(test::edit_box(CellType::hexahedron));
  const Before before(complex);
  ComplexEdit edit(complex);
  // Half a hundredth of an edge beside the faces: within the snap.
  const Section section = split_by_plane(edit, complex.map().cells(), plane_through({0, 0, 0.50125}, {0, 0, 1}));
  EXPECT_EQ(section.below.size(), 32U);
  EXPECT_EQ(section.above.size(), 32U);
  edit.commit();
  EXPECT_EQ(complex.map().cell_count(), 64U);
}

TEST(Section, SplitsWarpedCells) {
  BoxOptions o;
  o.cells = {5, 5, 5};
  o.size = {1.0, 1.0, 1.0};
  o.jitter = 0.4;
  Random random(9);
  std::size_t refused = 0;
  const int count = test::scaled(10, 500);
  for (int i = 0; i < count; ++i) {
    SCOPED_TRACE(i);
    o.seed = static_cast<std::uint64_t>(i);
    CellComplex complex(generate_box(o));
    if (!complex.invalid_cells().empty()) continue;
    ComplexEdit edit(complex);
    try {
      split_by_plane(edit, complex.map().cells(), random_plane(complex, random));
      edit.commit();
    } catch (const EditRefused&) {
      ++refused;
      continue;
    }
    test::expect_sound(complex);
    ASSERT_FALSE(HasFatalFailure());
    EXPECT_TRUE(test::near(volume6(complex), Dyadic(6.0), 1e-12));  // the outside is not warped
  }
  EXPECT_LE(refused, static_cast<std::size_t>(count / 10));
  RecordProperty("refused", static_cast<int>(refused));
}

TEST(Section, RefusesWithoutAChange) {
  CellComplex complex(test::edit_box(CellType::hexahedron));
  { ComplexEdit first(complex); }
  const Before before(complex);
  const Plane plane = plane_through({0.4, 0.4, 0.4}, {1, 2, 3});
  ComplexEdit edit(complex);
  const std::vector<Cell> cells = complex.map().cells();
  test::expect_parts(test::refusal([&] {
                       split_by_plane(edit, std::vector<Cell>{cells[0], cells[0]}, plane);
                     }),
                     {"invalid", "cell 0", "twice"});
  test::expect_parts(test::refusal([&] { split_by_plane(edit, std::vector<Cell>{Cell(1, 4000)}, plane); }),
                     {"invalid", "no such cell"});
  test::expect_parts(test::refusal([&] { split_by_plane(edit, cells, plane, {0.5}); }), {"invalid", "snap"});
  test::expect_parts(test::refusal([&] { plane_through({}, {}); }), {"invalid", "normal"});
  test::expect_parts(test::refusal([&] { plane_through({}, {NAN, 0, 1}); }), {"invalid", "finite"});
  before.expect_unchanged();
}

}  // namespace dartcast::section_test
