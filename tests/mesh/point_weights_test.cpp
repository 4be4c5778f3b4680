// Values brought from cells to points: against fields in closed form, and parts against the whole.
#include "mesh/point_weights.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "dartcast/generators.hpp"
#include "dartcast/mesh_part.hpp"
#include "support/expectations.hpp"
#include "support/meshes.hpp"
#include "support/tier.hpp"

namespace dartcast::point_weights_test {

BoxOptions box_of(unsigned kind, std::uint32_t n) {
  BoxOptions box;
  box.cells = {n, n, n};
  box.size = {1.0, 1.0, 1.0};
  box.jitter = 0.3;
  test::set_kind(box, static_cast<int>(kind));
  return box;
}

bool is_inside(const Vec3& x) {
  return x.x > 1e-9 && x.x < 1.0 - 1e-9 && x.y > 1e-9 && x.y < 1.0 - 1e-9 && x.z > 1e-9 && x.z < 1.0 - 1e-9;
}

template <class Field>
std::vector<double> from_cells(const MeshData& mesh, Field&& field) {
  std::vector<double> values;
  for (const Vec3& x : cell_centres(mesh)) values.push_back(field(x));
  return values_at_points(weights_of_cells(mesh), values, 1);
}

TEST(PointWeights, CentresAreThoseOfVolumes) {
  // A pyramid's centre is a quarter of its height above the base, not a fifth.
  MeshData mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 2}};
  mesh.add_cell(CellType::pyramid, std::vector<std::uint32_t>{0, 1, 2, 3, 4});
  test::expect_near(cell_centres(mesh)[0], {0.5, 0.5, 0.5}, 1e-15);
  // An L of three squares.
  MeshData plane;
  plane.points = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  plane.add_cell(CellType::polygon, std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5});
  test::expect_near(cell_centres(plane)[0], {5.0 / 6.0, 5.0 / 6.0, 0.0}, 1e-15);
}

TEST(PointWeights, SumTo1AndAreNotNegative) {
  for (unsigned kind = 0; kind < test::box_kinds.size(); ++kind) {
    const PointWeights w = weights_of_cells(generate_box(box_of(kind, 4)));
    for (std::size_t p = 0; p < w.points(); ++p) {
      double sum = 0.0;
      for (std::size_t k = w.offsets[p]; k < w.offsets[p + 1]; ++k) {
        EXPECT_GE(w.weights[k], 0.0);
        sum += w.weights[k];
      }
      EXPECT_NEAR(sum, 1.0, 1e-14);
    }
  }
}

// A point that the centres around it enclose has the value of a linear field. Few of them fall back to plain weights.
TEST(PointWeights, LinearFieldsAreExactInside) {
  const auto linear = [](const Vec3& x) { return 1.0 + 2.0 * x.x - 3.0 * x.y + 0.5 * x.z; };
  for (unsigned kind = 0; kind < test::box_kinds.size(); ++kind) {
    const MeshData mesh = generate_box(box_of(kind, 6));
    const std::vector<double> values = from_cells(mesh, linear);
    std::size_t inside = 0;
    std::size_t exact = 0;
    for (std::size_t p = 0; p < values.size(); ++p) {
      if (!is_inside(mesh.points[p])) continue;
      ++inside;
      exact += std::abs(values[p] - linear(mesh.points[p])) < 1e-13 ? 1 : 0;
    }
    EXPECT_GE(exact, inside - inside / 50) << "kind " << kind << ": " << exact << " of " << inside;
  }
  RectangleOptions rectangle;
  rectangle.cells = {6, 6};
  rectangle.size = {1.0, 1.0};
  rectangle.jitter = 0.3;
  const MeshData mesh = generate_rectangle(rectangle);
  const auto flat = [](const Vec3& x) { return 2.0 * x.x - 3.0 * x.y; };
  const std::vector<double> values = from_cells(mesh, flat);
  for (std::size_t p = 0; p < values.size(); ++p) {
    const Vec3& x = mesh.points[p];
    if (x.x > 1e-9 && x.x < 1.0 - 1e-9 && x.y > 1e-9 && x.y < 1.0 - 1e-9) EXPECT_NEAR(values[p], flat(x), 1e-13);
  }
}

// The mean error of a smooth field falls with the square of the cells' size, on all kinds of cells.
TEST(PointWeights, SecondOrder) {
  const auto smooth = [](const Vec3& x) { return std::sin(3.0 * x.x) * std::cos(2.0 * x.y) + x.z * x.z; };
  for (unsigned kind = 0; kind < test::box_kinds.size(); ++kind) {
    std::vector<double> errors;
    for (std::uint32_t n = 6; n <= (test::sanitized() ? 12U : 24U); n *= 2) {
      const MeshData mesh = generate_box(box_of(kind, n));
      const std::vector<double> values = from_cells(mesh, smooth);
      double sum = 0.0;
      double count = 0.0;
      for (std::size_t p = 0; p < values.size(); ++p) {
        if (!is_inside(mesh.points[p])) continue;
        sum += std::abs(values[p] - smooth(mesh.points[p]));
        count += 1.0;
      }
      errors.push_back(sum / count);
    }
    for (std::size_t k = 1; k < errors.size(); ++k) EXPECT_GT(std::log2(errors[k - 1] / errors[k]), 1.85) << kind;
  }
}

TEST(PointWeights, EqualValuesComeOutToTheBit) {
  const MeshData mesh = generate_box(box_of(0, 4));
  for (const double value : from_cells(mesh, [](const Vec3&) { return 0.1; })) EXPECT_EQ(value, 0.1);
}

// The points of a part's own cells have all their cells there.
TEST(PointWeights, PartsGiveTheBitsOfTheWhole) {
  for (unsigned kind = 0; kind < test::box_kinds.size(); ++kind) {
    const MeshData whole = generate_box(box_of(kind, 5));
    const auto field = [](const Vec3& x) { return std::sin(7.0 * x.x) + x.y * x.z; };
    const std::vector<double> expected = from_cells(whole, field);
    const std::vector<std::uint32_t> owners = partition(whole, 3);
    for (std::uint32_t rank = 0; rank < 3; ++rank) {
      const MeshPart part = mesh_part(whole, owners, 3, rank);
      const std::vector<double> values = from_cells(part.mesh, field);
      for (std::size_t c = 0; c < part.cells.size(); ++c) {
        if (part.owners[c] != rank) continue;
        for (const std::uint32_t p : part.mesh.cell(c)) EXPECT_EQ(values[p], expected[part.points[p]]);
      }
    }
  }
}

}  // namespace dartcast::point_weights_test
