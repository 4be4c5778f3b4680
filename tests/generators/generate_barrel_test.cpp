#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "surface/check_surface.hpp"

namespace dartcast::generate_barrel_test {

// The volume of the solid that a closed surface of triangles and quadrilaterals bounds, if its faces look outwards.
double enclosed_volume(const MeshData& mesh) {
  double sum = 0.0;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const auto corners = mesh.cell(c);
    for (std::size_t k = 2; k < corners.size(); ++k) {
      sum += dot(mesh.points[corners[0]], cross(mesh.points[corners[k - 1]], mesh.points[corners[k]])) / 6.0;
    }
  }
  return sum;
}

TEST(GenerateBarrel, IsAClosedSurfaceThatNeedsNoRepair) {
  for (const BarrelOptions& o :
       {BarrelOptions{}, BarrelOptions{1.0, 0.3, 0.0, 3, 1, 1, {}}, BarrelOptions{2.0, 0.5, 0.2, 7, 5, 2, {3, 4, 5}}}) {
    MeshData mesh = generate_barrel(o);
    EXPECT_EQ(mesh.points.size(), std::size_t{o.staves} * (o.rows + 1) + 2 * (o.staves * (o.rings - 1) + 1));
    // Closed: as many points and faces as edges, but 2 (Euler); each edge is in two faces, once each way, or a repair
    // or a defect would be reported.
    EXPECT_EQ(mesh.points.size() + mesh.cell_count(), mesh.connectivity.size() / 2 + 2);
    const MeshReport report = check_and_repair_surface(mesh);
    EXPECT_TRUE(report.repairs.empty());
    EXPECT_TRUE(report.defects.empty());
  }
}

// The volume of a solid of revolution, up to the part that the flat faces cut off.
TEST(GenerateBarrel, HasTheVolumeOfABarrel) {
  BarrelOptions o;
  o.staves = 200;
  o.rows = 200;
  o.centre = {1.0, -2.0, 0.5};
  const double r = o.radius;
  const double b = o.bulge;
  const double exact = std::numbers::pi * o.height * (r * r + 4.0 / 3.0 * r * b + 8.0 / 15.0 * b * b);
  EXPECT_NEAR(enclosed_volume(generate_barrel(o)), exact, 1e-3 * exact);
}

TEST(GenerateBarrel, RefusesWhatIsNoBarrel) {
  const auto refused = [](auto change) {
    BarrelOptions o;
    change(o);
    EXPECT_THROW(generate_barrel(o), InvalidArgument);
  };
  refused([](BarrelOptions& o) { o.height = 0.0; });
  refused([](BarrelOptions& o) { o.radius = std::numeric_limits<double>::infinity(); });
  refused([](BarrelOptions& o) { o.bulge = -0.1; });
  refused([](BarrelOptions& o) { o.centre.x = std::numeric_limits<double>::quiet_NaN(); });
  refused([](BarrelOptions& o) { o.staves = 2; });
  refused([](BarrelOptions& o) { o.rows = 0; });
  refused([](BarrelOptions& o) { o.rings = 100'000; });
}

}  // namespace dartcast::generate_barrel_test
