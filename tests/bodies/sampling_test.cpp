// Points sampled on and in surfaces: exact decisions against rational arithmetic, spacing and cover against all pairs.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "base/random.hpp"
#include "dartcast/bodies.hpp"
#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "support/closed_surfaces.hpp"
#include "support/dyadic.hpp"
#include "support/shared_data.hpp"
#include "support/tier.hpp"
#include "surface/inside.hpp"

namespace dartcast::sampling_test {

using test::cross;
using test::dot;
using test::Dyadic;
using test::exact;
using test::minus;
using Exact3 = test::Exact3<Dyadic>;

// A triangle, and its edges and normal.
struct Facet {
  std::array<Exact3, 3> t;
  Exact3 e, f, n;

  explicit Facet(const std::array<Exact3, 3>& corners)
      : t(corners), e(minus(t[1], t[0])), f(minus(t[2], t[0])), n(cross(e, f)) {}

  // For scale (> 0) times a point of its plane, relative to the first corner: 1 inside, 0 on the border, -1 outside.
  [[nodiscard]] int place(const Exact3& r, const Dyadic& scale) const {
    const Dyadic v = dot(cross(e, r), n);
    const Dyadic u = dot(cross(r, f), n);
    const Dyadic w = dot(n, n) * scale - u - v;
    if (u < 0 || v < 0 || w < 0) return -1;
    return u == 0 || v == 0 || w == 0 ? 0 : 1;
  }
};

// Where a ray meets a triangle, by solving for its parameters exactly: 1 inside of it and ahead, 0 not at all, -1
// on its border or in its plane (ask again with another ray); 2 where the ray starts on it.
int ray_meets(const Exact3& x, const Exact3& d, const Facet& facet) {
  const Exact3 from = minus(x, facet.t[0]);
  const Dyadic speed = dot(facet.n, d);
  const Dyadic height = dot(facet.n, from);
  if (height == 0 && facet.place(from, 1) >= 0) return 2;
  if (speed == 0) return height == 0 ? -1 : 0;
  if ((height > 0) == (speed > 0) || height == 0) return 0;
  // Where it meets the plane: from - d height / speed, times |speed|.
  const Dyadic scale = speed > 0 ? speed : Dyadic(-speed);
  const Dyadic gone = speed > 0 ? Dyadic(-height) : height;
  const Exact3 r = {from[0] * scale + d[0] * gone, from[1] * scale + d[1] * gone, from[2] * scale + d[2] * gone};
  const int where = facet.place(r, scale);
  return where < 0 ? 0 : where == 0 ? -1 : 1;
}

// The truth: parity along rays of random directions, until one meets no border.
class Truth {
 public:
  explicit Truth(const MeshData& mesh) {
    for (const SurfaceTriangle& t : surface_triangles(mesh))
      triangles_.emplace_back(std::array{exact(mesh.points[t[0]]), exact(mesh.points[t[1]]), exact(mesh.points[t[2]])});
  }

  PointSide side(const Vec3& x) {
    while (true) {
      const Exact3 d = {double(random_.below(2001)) - 1000, double(random_.below(2001)) - 1000,
                        double(random_.below(2001)) - 1000};
      int layers = 0;
      bool tie = false;
      for (const Facet& t : triangles_) {
        const int meets = ray_meets(exact(x), d, t);
        if (meets == 2) return PointSide::on;
        tie = tie || meets < 0;
        layers += meets == 1 ? 1 : 0;
      }
      if (!tie) return layers % 2 == 1 ? PointSide::inside : PointSide::outside;
    }
  }

 private:
  std::vector<Facet> triangles_;
  Random random_{99};
};

MeshData both(const MeshData& a, const MeshData& b) {
  MeshData mesh = a;
  const auto first = static_cast<std::uint32_t>(a.points.size());
  mesh.points.insert(mesh.points.end(), b.points.begin(), b.points.end());
  for (std::size_t c = 0; c < b.cell_count(); ++c) {
    std::vector<std::uint32_t> corners;
    for (const std::uint32_t v : b.cell(c)) corners.push_back(v + first);
    mesh.add_cell(b.types[c], corners);
  }
  return mesh;
}

// An L of cubes with a step: its faces, edges and corners line up in every direction.
const std::vector<std::array<int, 3>> steps = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0},
                                               {0, 2, 0}, {0, 0, 1}, {0, 0, 2}};

TEST(InsideTest, AgreesWithRationalsOnALattice) {
  const MeshData mesh = test::lattice_solid(steps);
  const InsideTest inside(mesh);
  Truth truth(mesh);
  Random random(4);
  int on = 0;
  int in = 0;
  for (int i = 0; i < test::scaled(400, 20000); ++i) {
    const Vec3 x = {0.25 * random.below(14) - 0.25, 0.25 * random.below(14) - 0.25, 0.25 * random.below(14) - 0.25};
    const PointSide expected = truth.side(x);
    ASSERT_EQ(inside.side(x), expected) << x.x << " " << x.y << " " << x.z;
    on += expected == PointSide::on ? 1 : 0;
    in += expected == PointSide::inside ? 1 : 0;
  }
  EXPECT_GT(on, 0);
  EXPECT_GT(in, 0);
}

TEST(InsideTest, AgreesWithRationalsAnywhereAndBesideTheSurface) {
  const MeshData mesh = test::torus(1.0, 0.4, 10, 6);
  const InsideTest inside(mesh);
  Truth truth(mesh);
  Random random(3);
  const std::vector<SurfaceTriangle> triangles = surface_triangles(mesh);
  int in = 0;
  for (int i = 0; i < test::scaled(60, 20000); ++i) {
    const auto& t = triangles[random.below(static_cast<std::uint32_t>(triangles.size()))];
    const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
    const double u = random.uniform();
    Vec3 x = random.below(2) == 0 ? (a + b) * 0.5 : a * (u * 0.5) + b * (0.5 - u * 0.5) + c * 0.5;
    if (random.below(4) == 0) x = {random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), random.uniform(-0.5, 0.5)};
    if (random.below(4) == 0) x = a;
    const PointSide expected = truth.side(x);
    ASSERT_EQ(inside.side(x), expected);
    in += expected == PointSide::inside ? 1 : 0;
  }
  EXPECT_GT(in, 0);
}

// A shell within another is a cavity, whichever way it is oriented.
TEST(InsideTest, ACavityIsOutside) {
  const InsideTest inside(both(test::cuboid({0, 0, 0}, {4, 4, 4}), test::cuboid({1, 1, 1}, {3, 3, 3})));
  EXPECT_EQ(inside.side({2, 2, 2}), PointSide::outside);
  EXPECT_EQ(inside.side({0.5, 2, 2}), PointSide::inside);
  EXPECT_EQ(inside.side({1, 2, 2}), PointSide::on);
  EXPECT_EQ(inside.side({4, 4, 4}), PointSide::on);
  EXPECT_EQ(inside.side({4, 4, 5}), PointSide::outside);
  EXPECT_THROW(static_cast<void>(inside.side({std::numeric_limits<double>::quiet_NaN(), 0, 0})), InvalidArgument);
}

TEST(InsideTest, RefusesWhatHasNoInside) {
  MeshData open = test::cuboid({0, 0, 0}, {1, 1, 1});
  open.types.pop_back();
  open.offsets.pop_back();
  open.connectivity.resize(open.offsets.back());
  try {
    const InsideTest inside(open);
    FAIL();
  } catch (const InvalidMesh& e) {
    EXPECT_NE(std::string(e.what()).find("hole"), std::string::npos) << e.what();
  }
  // A Moebius strip.
  MeshData strip;
  const std::uint32_t n = 12;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n;
    for (const double s : {-0.3, 0.3})
      strip.points.push_back(
          {(1 + s * std::cos(a / 2)) * std::cos(a), (1 + s * std::cos(a / 2)) * std::sin(a), s * std::sin(a / 2)});
  }
  for (std::uint32_t i = 0; i + 1 < n; ++i) test::add_face(strip, {2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2});
  test::add_face(strip, {2 * n - 2, 2 * n - 1, 0, 1});
  EXPECT_THROW(sample_volume(strip, {0.1}), InvalidMesh);
  EXPECT_THROW(sample_surface(strip, {0.1}), InvalidMesh);
  EXPECT_THROW(sample_surface(MeshData{}, {0.1}), InvalidMesh);
}

double nearest(const Vec3& x, const std::vector<Vec3>& samples) {
  double best = std::numeric_limits<double>::max();
  for (const Vec3& s : samples) best = std::min(best, norm(s - x));
  return best;
}

void expect_apart(const std::vector<Vec3>& samples, double spacing) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) ASSERT_GE(norm(samples[i] - samples[j]), spacing);
  }
}

void expect_covered(const MeshData& mesh, const std::vector<Vec3>& samples, double distance, std::uint64_t seed) {
  Random random(seed);
  const std::vector<SurfaceTriangle> triangles = surface_triangles(mesh);
  for (int i = 0; i < test::scaled(2000, 100000); ++i) {
    const auto& t = triangles[random.below(static_cast<std::uint32_t>(triangles.size()))];
    const double u = random.uniform();
    const double v = random.uniform() * (1 - u);
    const Vec3 x = mesh.points[t[0]] * u + mesh.points[t[1]] * v + mesh.points[t[2]] * (1 - u - v);
    ASSERT_LE(nearest(x, samples), distance);
  }
}

TEST(Sampling, KeepsItsSpacingAndCoversTheSurface) {
  for (const double spacing : {0.15, 0.6, 5.0}) {
    for (const MeshData& mesh :
         {test::torus(1.0, 0.4), test::cuboid({0, 0, 0}, {3, 0.01, 1}), test::lattice_solid(steps)}) {
      const std::vector<Vec3> samples = sample_surface(mesh, {spacing, 7});
      ASSERT_GE(samples.size(), 1U);
      expect_apart(samples, spacing);
      expect_covered(mesh, samples, surface_cover * spacing, 5);
    }
  }
}

TEST(Sampling, FillsAVolume) {
  const double spacing = 0.2;
  const MeshData mesh = test::lattice_solid(steps);
  const InsideTest inside(mesh);
  const std::vector<Vec3> volume = sample_volume(mesh, {spacing, 3});
  const SolidSamples solid = sample_solid(mesh, {spacing, 3});
  expect_apart(volume, spacing);
  expect_apart(solid.points, spacing);
  for (const Vec3& x : volume) EXPECT_EQ(inside.side(x), PointSide::inside);
  for (std::size_t i = solid.on_surface; i < solid.points.size(); ++i)
    EXPECT_EQ(inside.side(solid.points[i]), PointSide::inside);
  const std::vector<Vec3> on_surface(solid.points.begin(),
                                     solid.points.begin() + static_cast<std::ptrdiff_t>(solid.on_surface));
  EXPECT_EQ(on_surface, sample_surface(mesh, {spacing, 3}));
  expect_covered(mesh, solid.points, solid_cover * spacing, 8);
  Random random(17);
  int deep = 0;
  for (int i = 0; i < test::scaled(4000, 100000); ++i) {
    const Vec3 x = {random.uniform(0, 3), random.uniform(0, 3), random.uniform(0, 3)};
    if (inside.side(x) != PointSide::inside) continue;
    ASSERT_LE(nearest(x, solid.points), solid_cover * spacing);
    // One cube of the L holds its middle deeper than the diagonal.
    const Vec3 m = {std::floor(x.x) + 0.5, std::floor(x.y) + 0.5, std::floor(x.z) + 0.5};
    const double depth = 0.5 - std::max({std::abs(x.x - m.x), std::abs(x.y - m.y), std::abs(x.z - m.z)});
    if (depth <= cell_diagonal * spacing) continue;
    ++deep;
    ASSERT_LE(nearest(x, volume), volume_cover * spacing);
  }
  EXPECT_GT(deep, 0);
}

TEST(Sampling, DependsOnTheSeedAlone) {
  const MeshData mesh = test::torus(1.0, 0.4);
  EXPECT_EQ(sample_solid(mesh, {0.2, 4}).points, sample_solid(mesh, {0.2, 4}).points);
  EXPECT_NE(sample_solid(mesh, {0.2, 4}).points, sample_solid(mesh, {0.2, 5}).points);
}

TEST(Sampling, OfABodySmallerThanTheSpacing) {
  const MeshData mesh = test::cuboid({0, 0, 0}, {1e-3, 1e-3, 1e-3});
  EXPECT_EQ(sample_surface(mesh, {1.0}).size(), 1U);
  EXPECT_LE(sample_volume(mesh, {1.0}).size(), 1U);
}

TEST(Sampling, RefusesWhatItCannotTake) {
  const MeshData mesh = test::cuboid({0, 0, 0}, {1, 1, 1});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {0.0, -1.0, nan, std::numeric_limits<double>::infinity(), 1e-12, 1e-7})
    EXPECT_THROW(sample_solid(mesh, {bad}), InvalidArgument) << bad;
  EXPECT_THROW(sample_surface(mesh, {1e-7, 1, 1000}), InvalidArgument);
  EXPECT_THROW(sample_volume(mesh, {1e-3, 1, 1000}), InvalidArgument);
  EXPECT_THROW(sample_surface(mesh, {0.1, 1, 50}), InvalidArgument);
  EXPECT_THROW(sample_surface(test::cuboid({1e9, 0, 0}, {1e9 + 1, 1, 1}), {0.1}), InvalidArgument);
  MeshData broken = mesh;
  broken.points[3].x = nan;
  EXPECT_THROW(sample_surface(broken, {0.1}), InvalidMesh);
  broken = mesh;
  broken.connectivity[0] = 77;
  EXPECT_THROW(sample_solid(broken, {0.1}), InvalidMesh);
}

TEST(Sampling, OfRealSurfaces) {
  NEED_DATA("sampling of a liver, a hand and carotid arteries");
  const auto folder = test::data_folder() / "surfaces";
  for (const char* name : {"sofa/liver.obj", "cgal/cow.off"}) {
    const MeshData mesh = read_surface(folder / name).mesh;
    Vec3 low = mesh.points.front();
    Vec3 high = low;
    for (const Vec3& p : mesh.points) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    const double spacing = norm(high - low) / 20;
    const SolidSamples solid = sample_solid(mesh, {spacing, 1});
    EXPECT_GT(solid.on_surface, 50U) << name;
    EXPECT_GT(solid.points.size(), solid.on_surface) << name;
    expect_apart(solid.points, spacing);
    expect_covered(mesh, solid.points, surface_cover * spacing, 2);
  }
}

}  // namespace dartcast::sampling_test
