// Meshes that are good but for some cells: these are found, and left out.
#include "complex/skip_bad_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "dartcast/audit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/validity.hpp"
#include "support/dyadic.hpp"
#include "support/generate_checks.hpp"
#include "support/meshes.hpp"

namespace dartcast::skip_bad_cells_test {

using Cells = std::set<std::uint32_t>;

MeshData box(CellType type) { return test::cubes(4, type); }

// By rationals: tetrahedra whose corners, in the order in the mesh, do not turn as a positive cell's.
Cells not_positive(const MeshData& mesh) {
  Cells cells;
  for (std::uint32_t c = 0; c < mesh.cell_count(); ++c) {
    const auto v = mesh.cell(c);
    const auto& p = mesh.points;
    if (test::exact_sign(p[v[0]], p[v[1]], p[v[2]], p[v[3]]) <= 0) cells.insert(c);
  }
  return cells;
}

std::size_t point_at(const MeshData& mesh, const Vec3& x) {
  return static_cast<std::size_t>(std::find(mesh.points.begin(), mesh.points.end(), x) - mesh.points.begin());
}

Cells left_out(const MeshData& before, const MeshData& after) {
  Cells cells;
  for (std::uint32_t c = 0; c < before.cell_count(); ++c) cells.insert(c);
  for (const std::uint32_t c : after.source) cells.erase(c);
  return cells;
}

void mirror_all(MeshData& mesh) {
  for (std::size_t c = 0; c < mesh.cell_count(); ++c)
    std::swap(mesh.connectivity[mesh.offsets[c]], mesh.connectivity[mesh.offsets[c] + 1]);
}

// The rest is an environment in which nobody is lost.
void expect_usable(const MeshData& mesh) {
  Environment environment(mesh);
  EXPECT_EQ(environment.validity().invalid_count, 0U);
  Particles particles;
  std::vector<Vec3> starts;
  for (int i = 0; i < 400; ++i) starts.push_back({0.37 + 0.011 * i, 0.13 + 0.009 * i, 3.9 - 0.0095 * i});
  if (mesh.dimension() == 2) {
    for (Vec3& x : starts) x.z = 0.0;
  }
  environment.add(particles, starts);
  ASSERT_GT(particles.size(), 50U);
  for (int step = 0; step < 20; ++step) {
    std::vector<Vec3> targets;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const double k = static_cast<double>(i);
      targets.push_back({2.0 + 3.0 * std::sin(k + step), 2.0 + 3.0 * std::cos(1.7 * k - step),
                         mesh.dimension() == 2 ? 0.0 : 2.0 + 3.0 * std::sin(0.3 * k + 2.0 * step)});
    }
    environment.advance(particles, targets);
    const Audit audited = audit(environment.complex(), particles);
    ASSERT_EQ(audited.failed, 0U) << audited.first;
  }
}

TEST(SkipBadCells, AGoodMeshStaysAsItIs) {
  for (const CellType type : {CellType::tetrahedron, CellType::hexahedron}) {
    MeshData mesh = box(type);
    const MeshData before = mesh;
    EXPECT_EQ(skip_bad_cells(mesh).count, 0U);
    EXPECT_EQ(mesh.connectivity, before.connectivity);
    EXPECT_EQ(mesh.points, before.points);
  }
}

// A vertex is pulled through the opposite faces of cells around it: these are inverted, and overlap others.
TEST(SkipBadCells, InvertedTetrahedraAreThoseThatTurnTheOtherWay) {
  for (const Vec3& to : {Vec3{3.2, 2.1, 2.05}, Vec3{2.0, 0.75, 2.5}, Vec3{0.5, 0.5, 0.5}, Vec3{2.0, 2.0, 3.0}}) {
    MeshData mesh = box(CellType::tetrahedron);
    mesh.points[point_at(mesh, {2, 2, 2})] = to;
    const Cells bad = not_positive(mesh);
    ASSERT_GT(bad.size(), 0U);
    for (const bool mirrored : {false, true}) {
      MeshData all = mesh;
      if (mirrored) mirror_all(all);
      EXPECT_THROW(Environment{all}, InvalidMesh);
      const MeshData before = all;
      const Finding found = skip_bad_cells(all);
      EXPECT_EQ(left_out(before, all), bad);
      EXPECT_EQ(found.count, bad.size());
      EXPECT_EQ(found.first.front(), *bad.begin());
      expect_usable(all);
    }
  }
}

TEST(SkipBadCells, ArraysRegionsAndPlacesGoAlong) {
  MeshData mesh = box(CellType::tetrahedron);
  mesh.points[point_at(mesh, {1, 2, 2})] = {1.0, 2.0, 3.2};
  const Cells bad = not_positive(mesh);
  ASSERT_GT(bad.size(), 0U);
  DataArray pairs{"pairs", 2, {}};
  for (std::uint32_t c = 0; c < mesh.cell_count(); ++c) {
    mesh.regions.push_back(static_cast<std::int32_t>(c % 7));
    mesh.free.push_back(c % 5 == 0 ? 0 : 1);
    mesh.source.push_back(10 + 3 * c);
    pairs.values.push_back(c);
    pairs.values.push_back(-1.0 * c);
  }
  mesh.cell_data.push_back(pairs);
  const Finding found = skip_bad_cells(mesh);
  EXPECT_EQ(found.count, bad.size());
  EXPECT_EQ(found.first.front(), 10 + 3 * *bad.begin());
  ASSERT_EQ(mesh.source.size(), mesh.cell_count());
  for (std::size_t i = 0; i < mesh.cell_count(); ++i) {
    const std::uint32_t c = (mesh.source[i] - 10) / 3;
    EXPECT_EQ(bad.count(c), 0U);
    EXPECT_EQ(mesh.regions[i], static_cast<std::int32_t>(c % 7));
    EXPECT_EQ(mesh.free[i], c % 5 == 0 ? 0 : 1);
    EXPECT_EQ(mesh.cell_data[0].values[2 * i], c);
    EXPECT_EQ(mesh.cell_data[0].values[2 * i + 1], -1.0 * c);
  }
}

// Hexahedra that no point sees, and flat ones.
TEST(SkipBadCells, HexahedraThatCannotBeDividedAreLeftOut) {
  MeshData mesh = box(CellType::hexahedron);
  mesh.points[point_at(mesh, {2, 2, 2})] = {3.4, 3.3, 3.2};
  EXPECT_THROW(Environment{mesh}, InvalidMesh);
  const Finding found = skip_bad_cells(mesh);
  EXPECT_GT(found.count, 0U);
  EXPECT_LE(found.count, 8U);
  EXPECT_EQ(mesh.cell_count() + found.count, 64U);
  expect_usable(mesh);
}

TEST(SkipBadCells, FlatCellsAreLeftOut) {
  MeshData mesh = box(CellType::tetrahedron);
  const std::size_t p = point_at(mesh, {2, 2, 2});
  const std::size_t q = point_at(mesh, {3, 2, 2});
  mesh.points[p] = mesh.points[q];
  const Cells bad = not_positive(mesh);
  ASSERT_GT(bad.size(), 0U);
  const MeshData before = mesh;
  EXPECT_EQ(skip_bad_cells(mesh).count, bad.size());
  EXPECT_EQ(left_out(before, mesh), bad);
  expect_usable(mesh);
}

TEST(SkipBadCells, InThePlaneToo) {
  RectangleOptions o;
  o.cells = {5, 5};
  o.size = {5.0, 5.0};
  for (const CellType type : {CellType::triangle, CellType::quadrilateral}) {
    o.type = type;
    MeshData mesh = generate_rectangle(o);
    mesh.points[point_at(mesh, {2, 2, 0})] = {3.2, 3.4, 0};
    EXPECT_THROW(Environment{mesh}, InvalidMesh);
    const std::size_t cells = mesh.cell_count();
    const Finding found = skip_bad_cells(mesh);
    EXPECT_GT(found.count, 0U);
    EXPECT_LE(found.count, 6U);
    EXPECT_EQ(mesh.cell_count() + found.count, cells);
    expect_usable(mesh);
  }
}

TEST(SkipBadCells, OtherDefectsAndMeshesOfBadCellsAloneAreRefused) {
  MeshData range = box(CellType::tetrahedron);
  range.connectivity[0] = 100000;
  EXPECT_THROW(skip_bad_cells(range), InvalidMesh);
  MeshData flat = box(CellType::tetrahedron);
  for (Vec3& x : flat.points) x.z = 0.25 * x.x;
  EXPECT_THROW(skip_bad_cells(flat), InvalidMesh);
}

}  // namespace dartcast::skip_bad_cells_test
