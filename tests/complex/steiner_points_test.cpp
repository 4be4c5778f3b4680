// Steiner points: cells that the plain triangulation does not divide get some, keep them through moves, and conform.
#include "complex/steiner_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/random.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/validity.hpp"
#include "support/generate_checks.hpp"
#include "support/meshes.hpp"
#include "support/mixed_mesh.hpp"
#include "support/tier.hpp"

namespace dartcast::interior_test {

// Every fan triangle of a sewn face has the same vertices from both sides; and the map is whole.
void expect_conforming(const CellComplex& complex) {
  const CombinatorialMap& map = complex.map();
  EXPECT_TRUE(check_integrity(map).empty());
  for (const Cell c : map.cells()) {
    const CellView v = map.view(c);
    for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
      if (!v.neighbour(f).valid()) continue;
      const CellView w = map.view(v.neighbour(f));
      ASSERT_EQ(v.shape().triangle_count(f), w.shape().triangle_count(v.neighbour_face(f)));
      for (std::uint16_t t = 0; t < v.shape().triangle_count(f); ++t) {
        std::set<Vertex> here, there;
        for (const auto k : v.shape().triangle(f, t)) here.insert(v.vertex(k));
        for (const auto k : w.shape().triangle(v.neighbour_face(f), v.shape().triangle_from_other_side(f, t))) {
          there.insert(w.vertex(k));
        }
        ASSERT_EQ(here, there);
      }
    }
  }
}

// Sum of all simplices' volumes, times 6.
double volume6(const CellComplex& complex) {
  double sum = 0;
  for (const Cell c : complex.map().cells()) {
    for (std::uint16_t s = 0; s < complex.map().shape(c).simplices().size(); ++s) {
      const Corners v = complex.corners({c, s});
      sum += dot(cross(v[1] - v[0], v[2] - v[0]), v[3] - v[0]);
    }
  }
  return sum;
}

// An octree of two levels over a box of nx x ny x nz cubes of edge 2: a cube is one polyhedron, or cut into eight.
// Where a cut cube lies against a whole one, the whole one's side is four faces and its edges have a corner in their
// middle.
class Octree {
 public:
  Octree(std::array<int, 3> size, std::vector<bool> cut) : size_(size), cut_(std::move(cut)) {
    each([&](int x, int y, int z) {
      if (is_cut(x, y, z)) {
        for (int k = 0; k < 8; ++k) add_corners({2 * x + (k & 1), 2 * y + ((k >> 1) & 1), 2 * z + (k >> 2)}, 1);
      }
      add_corners({2 * x, 2 * y, 2 * z}, 2);
    });
    each([&](int x, int y, int z) {
      if (is_cut(x, y, z)) {
        for (int k = 0; k < 8; ++k) add_cell({2 * x + (k & 1), 2 * y + ((k >> 1) & 1), 2 * z + (k >> 2)}, 1);
      } else {
        add_cell({2 * x, 2 * y, 2 * z}, 2);
      }
    });
  }

  MeshData mesh;

 private:
  using Place = std::array<int, 3>;

  template <class Visit>
  void each(Visit&& visit) const {
    for (int z = 0; z < size_[2]; ++z) {
      for (int y = 0; y < size_[1]; ++y) {
        for (int x = 0; x < size_[0]; ++x) visit(x, y, z);
      }
    }
  }
  [[nodiscard]] bool is_cut(int x, int y, int z) const {
    if (x < 0 || y < 0 || z < 0 || x >= size_[0] || y >= size_[1] || z >= size_[2]) return false;
    return cut_[static_cast<std::size_t>(x + size_[0] * (y + size_[1] * z))];
  }
  void add_corners(const Place& low, int edge) {
    for (int k = 0; k < 8; ++k) {
      const Place p = {low[0] + edge * (k & 1), low[1] + edge * ((k >> 1) & 1), low[2] + edge * (k >> 2)};
      const auto [found, fresh] = number_.try_emplace(p, static_cast<std::uint32_t>(mesh.points.size()));
      if (fresh) mesh.points.push_back({1.0 * p[0], 1.0 * p[1], 1.0 * p[2]});
    }
  }

  // A square of the side `axis`, `high`, with every point of the mesh on its border as a corner.
  void add_face(std::vector<std::uint32_t>& faces, Place low, int edge, int axis, bool high) const {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    std::vector<std::uint32_t> corners;
    Place p = low;
    const auto run = [&](int along, int step) {
      for (int i = 0; i < edge; ++i) {
        if (const auto found = number_.find(p); found != number_.end()) corners.push_back(found->second);
        p[static_cast<std::size_t>(along)] += step;
      }
    };
    run(u, 1);
    run(v, 1);
    run(u, -1);
    run(v, -1);
    if (!high) std::reverse(corners.begin(), corners.end());
    faces.push_back(static_cast<std::uint32_t>(corners.size()));
    faces.insert(faces.end(), corners.begin(), corners.end());
    ++faces[0];
  }

  void add_cell(const Place& low, int edge) {
    std::vector<std::uint32_t> faces = {0};
    for (int axis = 0; axis < 3; ++axis) {
      for (const bool high : {false, true}) {
        Place at = low;
        at[static_cast<std::size_t>(axis)] += high ? edge : 0;
        Place beyond = {low[0] / 2, low[1] / 2, low[2] / 2};
        beyond[static_cast<std::size_t>(axis)] += high ? 1 : -1;
        if (edge == 1 || !is_cut(beyond[0], beyond[1], beyond[2])) {
          add_face(faces, at, edge, axis, high);
          continue;
        }
        for (int k = 0; k < 4; ++k) {
          Place quarter = at;
          quarter[static_cast<std::size_t>((axis + 1) % 3)] += k & 1;
          quarter[static_cast<std::size_t>((axis + 2) % 3)] += k >> 1;
          add_face(faces, quarter, 1, axis, high);
        }
      }
    }
    mesh.add_cell(CellType::polyhedron, faces);
  }

  std::array<int, 3> size_;
  std::vector<bool> cut_;
  std::map<Place, std::uint32_t> number_;
};

void expect_valid_and_whole(const MeshData& mesh, double volume) {
  const CellComplex complex(mesh);
  for (const InvalidCell& c : complex.invalid_cells()) ADD_FAILURE() << c.message;
  EXPECT_TRUE(check_validity(complex).valid());
  expect_conforming(complex);
  EXPECT_NEAR(volume6(complex), 6.0 * volume, 1e-9 * volume);
}

TEST(SteinerPoints, ACubeBesideSmallOnes) {
  const Octree octree({2, 1, 1}, {false, true});
  ASSERT_EQ(octree.mesh.cell_count(), 9U);
  ASSERT_EQ(octree.mesh.cell(0)[0], 9U);  // five squares and four quarters
  MeshData mesh = octree.mesh;
  EXPECT_TRUE(check_and_repair(mesh).valid());
  Random random(2);
  for (int i = 0; i < 60; ++i) {
    expect_valid_and_whole(test::renumbered(mesh, test::permutation(mesh.points.size(), random)), 16.0);
  }
}

TEST(SteinerPoints, RandomOctreesInRandomNumberings) {
  Random random(3);
  for (int i = 0; i < 40; ++i) {
    std::vector<bool> cut(3 * 3 * 2);
    for (std::size_t k = 0; k < cut.size(); ++k) cut[k] = random.below(3) == 0;
    const Octree octree({3, 3, 2}, cut);
    const MeshData mesh = test::renumbered(octree.mesh, test::permutation(octree.mesh.points.size(), random));
    expect_valid_and_whole(mesh, 3 * 3 * 2 * 8.0);
  }
}

TEST(SteinerPoints, MoveWithTheirCorners) {
  const Octree octree({2, 2, 1}, {false, true, false, false});
  CellComplex complex(octree.mesh);
  ASSERT_GT(complex.steiner_point_count(), 0U);
  const auto at_first = std::vector<Vec3>(complex.positions().begin(), complex.positions().end());
  Random random(4);
  for (int step = 1; step <= 20; ++step) {
    // A linear map of all space: a Steiner point, a combination of corners, moves with it.
    const double shear = 0.02 * step;
    const auto moved = [&](const Vec3& p) { return Vec3{p.x + shear * p.y, p.y * (1.0 + shear), p.z - shear * p.x}; };
    const auto next = complex.next_positions();
    ASSERT_EQ(next.size(), octree.mesh.points.size());
    for (std::size_t i = 0; i < next.size(); ++i) next[i] = moved(at_first[i]);
    complex.commit_positions();
    for (std::size_t i = 0; i < at_first.size(); ++i)
      EXPECT_LT(norm(complex.positions()[i] - moved(at_first[i])), 1e-13);
    EXPECT_TRUE(check_validity(complex).valid());
  }
  // Small random displacements of every corner. Faces with a corner on an edge stay, for each fan triangle, within a
  // cone.
  for (int step = 0; step < 20; ++step) {
    const auto next = complex.next_positions();
    for (std::size_t i = 0; i < next.size(); ++i) {
      next[i] =
          at_first[i] + Vec3{random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02)};
    }
    complex.commit_positions();
    for (const InvalidCell& c : check_validity(complex).first) ADD_FAILURE() << c.message;
  }
}

TEST(SteinerPoints, PreviousPositionsAreThoseOfTheLastMove) {
  const Octree octree({2, 1, 1}, {false, true});
  CellComplex complex(octree.mesh);
  EXPECT_EQ(complex.previous_positions().data(), complex.positions().data());
  const std::vector<Vec3> before(complex.positions().begin(), complex.positions().end());
  const auto next = complex.next_positions();
  for (Vec3& p : next) p = p * 1.5;
  complex.commit_positions();
  EXPECT_EQ(std::vector<Vec3>(complex.previous_positions().begin(), complex.previous_positions().end()), before);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(complex.positions()[i], before[i] * 1.5);
}

// The best point of a cell by a search that knows nothing of the library: the largest least distance to its fan
// triangles, from many starts. Returns whether a point was found that is strictly behind all of them.
bool has_kernel(const MeshData& mesh, std::size_t c, Random& random) {
  struct Plane {
    Vec3 a, inward;
  };
  std::vector<Plane> planes;
  std::set<std::uint32_t> corners;
  for_each_face(mesh, c, [&](std::span<const std::uint32_t> f) {
    const auto fan = test::from_lowest(f);
    corners.insert(f.begin(), f.end());
    for (std::size_t i = 1; i + 1 < fan.size(); ++i) {
      const Vec3& a = mesh.points[fan[0]];
      const Vec3 n = cross(mesh.points[fan[i + 1]] - a, mesh.points[fan[i]] - a);
      planes.push_back({a, n * (1.0 / norm(n))});
    }
  });
  const std::vector<std::uint32_t> list(corners.begin(), corners.end());
  for (int start = 0; start < 300; ++start) {
    Vec3 x;
    double sum = 0;
    for (const std::uint32_t v : list) {
      const double w = -std::log(1.0 - random.uniform());
      x += mesh.points[v] * w;
      sum += w;
    }
    x *= 1.0 / sum;
    for (int k = 0; k < 60; ++k) {  // projections on the planes violated, a little beyond
      bool inside = true;
      for (const Plane& p : planes) {
        const double d = dot(p.inward, x - p.a);
        if (d > 1e-9) continue;
        inside = false;
        x += p.inward * (1e-6 - 1.3 * d);
      }
      if (inside) return true;
    }
  }
  return false;
}

// A unit cube whose corners are moved by up to `most` along each axis.
MeshData warped_cube(std::uint64_t seed, double most) {
  MeshData mesh = generate_box({});
  Random random(seed);
  for (Vec3& p : mesh.points) {
    p += Vec3{random.uniform(-most, most), random.uniform(-most, most), random.uniform(-most, most)};
  }
  return mesh;
}

TEST(SteinerPoints, WarpedHexahedraWithAKernelGetThem) {
  for (const double most : {0.4, 0.55}) {
    int plain = 0, bad = 0, with_kernel = 0, with_kernel_mended = 0, mended = 0;
    for (std::uint64_t seed = 1; seed <= 1500; seed += test::sanitized() ? 3 : 1) {
      const MeshData mesh = warped_cube(seed, most);
      const CellComplex complex(mesh);
      const bool valid = complex.invalid_cells().empty();
      EXPECT_EQ(check_validity(complex).valid(), valid);
      if (test::count_not_positive(mesh, mesh.points) == 0) {
        ++plain;
        EXPECT_EQ(complex.steiner_point_count(), 0U);
        EXPECT_TRUE(valid);
        continue;
      }
      ++bad;
      mended += valid ? 1 : 0;  // also some whose fans have no kernel: with points, faces bend less
      Random random(seed);
      if (!has_kernel(mesh, 0, random)) continue;
      ++with_kernel;
      with_kernel_mended += valid ? 1 : 0;
    }
    SCOPED_TRACE(std::to_string(plain) + " plain, " + std::to_string(with_kernel_mended) + " of " +
                 std::to_string(with_kernel) + " with a kernel, " + std::to_string(mended) + " of " +
                 std::to_string(bad) + " in all");
    EXPECT_GT(plain, (most < 0.5 ? 1350 : 800) / (test::sanitized() ? 3 : 1));
    EXPECT_GT(with_kernel, 20 / (test::sanitized() ? 3 : 1));
    EXPECT_GE(with_kernel_mended * 100, with_kernel * 95);
    EXPECT_GE(mended * 100, bad * (most < 0.5 ? 98 : 80));
  }
}

TEST(SteinerPoints, WarpedMeshesStayConforming) {
  for (int which = 0; which < 5; ++which) {
    BoxOptions o;
    o.cells = {5, 4, 4};
    o.size = {5, 4, 4};
    o.jitter = 0.75;
    o.seed = 21;
    test::set_kind(o, which);
    const MeshData mesh = generate_box(o);
    const CellComplex complex(mesh);
    expect_conforming(complex);
    EXPECT_NEAR(volume6(complex), 6.0 * 5 * 4 * 4, 1e-9);
    EXPECT_EQ(complex.invalid_cells().size(), check_validity(complex, {}, 0).invalid_count);
    EXPECT_LE(complex.invalid_cells().size(), test::count_not_positive(mesh, mesh.points));
  }
}

TEST(SteinerPoints, AHopelessCellIsReported) {
  BoxOptions o;
  o.cells = {3, 1, 1};
  o.size = {3, 1, 1};
  MeshData mesh = generate_box(o);
  mesh.source = {100, 200, 300};
  // The far end of the last cube turned by a half turn: a bow tie.
  std::swap(mesh.points[3], mesh.points[15]);
  std::swap(mesh.points[7], mesh.points[11]);
  const CellComplex complex(mesh);
  ASSERT_EQ(complex.invalid_cells().size(), 1U);
  EXPECT_EQ(complex.map().source(complex.invalid_cells()[0].cell), 300U);
  EXPECT_NE(complex.invalid_cells()[0].message.find("cell 300"), std::string::npos);
}

TEST(SteinerPoints, ScaleWithTheMesh) {
  int with_points = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const MeshData mesh = warped_cube(seed, 0.6);
    const CellComplex original(mesh);
    with_points += original.steiner_point_count() > 0 && original.invalid_cells().empty() ? 1 : 0;
    for (const int k : {-280, 280}) {
      MeshData scaled = mesh;
      for (Vec3& p : scaled.points) p *= std::ldexp(1.0, k);
      const CellComplex complex(scaled);
      ASSERT_EQ(complex.invalid_cells().size(), original.invalid_cells().size()) << "seed " << seed << ", 2^" << k;
      ASSERT_EQ(complex.positions().size(), original.positions().size()) << "seed " << seed << ", 2^" << k;
    }
  }
  EXPECT_GT(with_points, 50);
}

}  // namespace dartcast::interior_test
