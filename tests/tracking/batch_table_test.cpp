// The batch in cells whose shapes have no table of exits (topology/exit_table.hpp).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "complex/simplex.hpp"
#include "dartcast/cell_complex.hpp"
#include "support/particle_checks.hpp"
#include "topology/exit_table.hpp"
#include "tracking/batch/batch.hpp"
#include "tracking/locate.hpp"
#include "tracking/step.hpp"

namespace dartcast::test::batch_table_test {

// A prism over a polygon of so many corners, and a hexahedron at one of its sides.
MeshData prism_with_a_door(std::uint32_t corners) {
  MeshData mesh;
  for (const double z : {0.0, 1.0}) {
    for (std::uint32_t i = 0; i < corners; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / corners;
      mesh.points.push_back({std::cos(angle), std::sin(angle), z});
    }
  }
  std::vector<std::uint32_t> faces = {corners + 2, corners};
  for (std::uint32_t i = corners; i > 0; --i) faces.push_back(i - 1);
  faces.push_back(corners);
  for (std::uint32_t i = 0; i < corners; ++i) faces.push_back(corners + i);
  for (std::uint32_t i = 0; i < corners; ++i) {
    const std::uint32_t j = (i + 1) % corners;
    faces.insert(faces.end(), {4, i, j, corners + j, corners + i});
  }
  mesh.add_cell(CellType::polyhedron, faces);
  const std::uint32_t outer = 2 * corners;
  for (const std::uint32_t i : {0U, 1U, corners + 1, corners}) mesh.points.push_back(mesh.points[i] + Vec3{0.5, 0, 0});
  mesh.add_cell(CellType::hexahedron,
                std::vector<std::uint32_t>{0, outer, outer + 1, 1, corners, outer + 3, outer + 2, corners + 1});
  return mesh;
}

// Shapes of many simplices have no table of exits: walks along lines are left to rounds there, and where they come to
// one.
TEST(FilteredBatch, ShapesWithoutATable) {
  constexpr std::uint32_t corners = 1500;
  const CellComplex complex(prism_with_a_door(corners));
  ASSERT_TRUE(complex.invalid_cells().empty());
  const Cell prism = complex.map().cells().back();
  const Cell door = complex.map().cells().front();
  ASSERT_TRUE(complex.map().shape(prism).exits().empty());
  ASSERT_FALSE(complex.map().shape(door).exits().empty());
  const double y = std::numbers::pi / corners;  // in the middle of the door
  const std::vector<Vec3> starts = {{1.3, y, 0.4}, {1.2, 0.9 * y, 0.3}, {-0.2, 0.3, 0.6}, {1.1, y, 0.7}};
  const std::vector<Vec3> targets = {
      {-0.7, 2.1 * y, 0.5}, {-1.7, 0.2, 0.4}, {-0.19, 0.31, 0.55}, {1.3, 1.001 * y, 0.6}};
  const Locator locator(complex);
  std::vector<ParticleState> states(starts.size());
  std::vector<detail::VertexNumbers> vertices;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const Location at = locator.locate(complex, starts[i]);
    ASSERT_EQ(at.place, Place::free);
    states[i].put(at.simplex, starts[i]);
    vertices.push_back(detail::vertex_numbers(complex, at.simplex));
  }
  std::vector<ParticleState> taken = states;
  std::vector<detail::StepStatus> status(starts.size());
  std::vector<StepState> partial;
  Counters counters;
  detail::SimplexCache caches;
  caches.resize(starts.size());
  detail::step_batch({&complex, false, false, StepOptions{}},
                     {taken, vertices, caches.from(0), targets, status, partial}, counters);
  const StepOptions options;
  const ContactCallback none;
  const Stepper stepper(complex, false, options, none);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    Weights unused{};
    ContactList contacts;
    Counters counts;
    ASSERT_NE(status[i], detail::step_untouched) << i;
    if (status[i] != detail::step_complete)
      stepper.step(static_cast<std::uint32_t>(i), taken[i], unused, targets[i], contacts, counts, partial[status[i]]);
    stepper.step(static_cast<std::uint32_t>(i), states[i], unused, targets[i], contacts, counts);
    EXPECT_TRUE(same_bits(taken[i], states[i])) << i;
  }
}

TEST(FilteredBatch, RangesAreCheckedToTheLastNumber) {
  const double good[] = {0.0, -1.0, smallest_magnitude, -largest_magnitude, 1.0};
  const double bad[] = {std::numeric_limits<double>::quiet_NaN(),
                        std::numeric_limits<double>::infinity(),
                        largest_magnitude * 1.0000000000000002,
                        -smallest_magnitude * 0.9999999999999999,
                        5e-324,
                        -0.0};  // counts as 0
  for (std::size_t count = 0; count < 9; ++count) {
    std::vector<Vec3> points(count, Vec3{good[count % 5], good[(count + 1) % 5], good[(count + 2) % 5]});
    EXPECT_TRUE(detail::all_as_decided(points));
    for (Vec3& p : points) {
      for (double* c : {&p.x, &p.y, &p.z}) {
        const double kept = *c;
        for (const double b : bad) {
          *c = b;
          EXPECT_FALSE(detail::all_as_decided(points)) << b;
        }
        *c = kept;
      }
    }
  }
}

}  // namespace dartcast::test::batch_table_test
