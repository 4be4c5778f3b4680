#include <cstdlib>
#include <limits>
#include <numeric>
#include <set>

#include "base/random.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "support/generate_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::generate_vessel_test {

using test::all_faces;
using test::CornerNumbers;
using test::from_lowest;
using test::reversed;

const MeshData& vessel() {
  static const MeshData mesh = generate_vessel();
  return mesh;
}

CornerNumbers patch_face(const MeshData& mesh, std::size_t f) {
  return from_lowest(
      {mesh.patch_faces.data() + mesh.patch_offsets[f], mesh.patch_offsets[f + 1] - mesh.patch_offsets[f]});
}

Vec3 vector_at(const DataArray& array, std::uint32_t v) {
  return {array.values[3 * v], array.values[3 * v + 1], array.values[3 * v + 2]};
}

// Flux of the field through a face: over its fan, linear in each triangle.
double flux(const MeshData& mesh, const DataArray& field, std::span<const std::uint32_t> face) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < face.size(); ++i) {
    const Vec3 &a = mesh.points[face[0]], &b = mesh.points[face[i]], &c = mesh.points[face[i + 1]];
    const Vec3 mean =
        (vector_at(field, face[0]) + vector_at(field, face[i]) + vector_at(field, face[i + 1])) * (1.0 / 3);
    sum += 0.5 * dot(cross(b - a, c - a), mean);
  }
  return sum;
}

TEST(GenerateVessel, HasTheSizeTheIssueAsksFor) {
  const MeshData& mesh = vessel();
  EXPECT_EQ(mesh.cell_count(), 20948U);
  EXPECT_EQ(std::accumulate(mesh.free.begin(), mesh.free.end(), 0), 15012);
  EXPECT_EQ(std::count(mesh.types.begin(), mesh.types.end(), CellType::prism), 56);
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    ASSERT_EQ(mesh.region_names.at(mesh.regions[c]), mesh.free[c] == 1 ? "lumen" : "tissue");
  }
  const double lumen = 3e-3 * 3e-3 * 3.14159 * (30e-3 + 0.79 * 0.79 * 66e-3);
  const double thick = 4.5e-3 * 4.5e-3 * 3.14159 * 30e-3 + 3.87e-3 * 3.87e-3 * 3.14159 * 66e-3;
  EXPECT_NEAR(test::volume(mesh), thick, 0.15 * thick);
  MeshData inside;
  inside.points = mesh.points;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    if (mesh.free[c] == 1) inside.add_cell(mesh.types[c], mesh.cell(c));
  }
  EXPECT_NEAR(test::volume(inside), lumen, 0.05 * lumen);
}

TEST(GenerateVessel, ConformsAndIsClosed) { EXPECT_GT(test::expect_conforming(vessel()), 3000U); }

// Where the halves' tissue lies together it is joined, and where it is not joined it has parted: no two points lie
// (almost) at one place.
TEST(GenerateVessel, NoTwoPointsCoincide) {
  std::vector<Vec3> points = vessel().points;
  std::sort(points.begin(), points.end(), [](const Vec3& a, const Vec3& b) { return a.z < b.z; });
  double closest = 1.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < points.size() && points[j].z - points[i].z < closest; ++j) {
      closest = std::min(closest, norm(points[j] - points[i]));
    }
  }
  EXPECT_GT(closest, 4e-5);
}

// Under any numbering: loading a mesh may reorder its vertices, and each order gives other simplices.
TEST(GenerateVessel, EverySimplexIsPositiveUnderAnyNumbering) {
  EXPECT_EQ(test::count_not_positive(vessel(), vessel().points), 0U);
  Random random(7);
  for (int round = 0; round < 4; ++round) {
    std::vector<std::uint32_t> order(vessel().points.size());
    std::iota(order.begin(), order.end(), 0U);
    for (auto i = static_cast<std::uint32_t>(order.size()); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
    MeshData mesh = vessel();
    for (std::size_t v = 0; v < order.size(); ++v) mesh.points[order[v]] = vessel().points[v];
    for (auto& corner : mesh.connectivity) corner = order[corner];
    EXPECT_EQ(test::count_not_positive(mesh, mesh.points), 0U);
  }
}

TEST(GenerateVessel, OneInletAndTwoOutletsJoinedThroughTheLumen) {
  const MeshData& mesh = vessel();
  const auto faces = all_faces(mesh);
  std::map<std::string, std::set<std::size_t>> at_patch;
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const auto owner = faces.find(patch_face(mesh, f));
    ASSERT_NE(owner, faces.end()) << "not counterclockwise seen from the outside: patch face " << f;
    at_patch[mesh.patch_names.at(mesh.patch_tags[f])].insert(owner->second[0]);
  }
  std::vector<std::uint8_t> reached(mesh.cell_count(), 0);
  std::vector<std::size_t> front = {*at_patch["inlet"].begin()};
  reached[front[0]] = 1;
  while (!front.empty()) {
    const std::size_t c = front.back();
    front.pop_back();
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> face) {
      const auto other = faces.find(reversed(from_lowest(face)));
      if (other == faces.end() || mesh.free[other->second[0]] == 0 || reached[other->second[0]] == 1) return;
      reached[other->second[0]] = 1;
      front.push_back(other->second[0]);
    });
  }
  EXPECT_EQ(reached, mesh.free);
  EXPECT_EQ(at_patch["inlet"].size(), 216U);
  EXPECT_EQ(at_patch["outlet_left"].size(), 108U);
  EXPECT_EQ(at_patch["outlet_right"].size(), 108U);
}

TEST(GenerateVessel, PatchesCoverWallsAndBoundaryExactly) {
  const MeshData& mesh = vessel();
  const auto faces = all_faces(mesh);
  std::map<std::string, std::set<CornerNumbers>> expected, named;
  for (const auto& [face, cells] : faces) {
    const auto other = faces.find(reversed(face));
    const bool lumen = mesh.free[cells[0]] == 1;
    if (other == faces.end()) {
      expected[lumen ? "ends" : "outer"].insert(face);
    } else if (lumen && mesh.free[other->second[0]] == 0) {
      expected["wall"].insert(face);
    }
  }
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const std::string& name = mesh.patch_names.at(mesh.patch_tags[f]);
    EXPECT_TRUE(named[name == "wall" || name == "outer" ? name : "ends"].insert(patch_face(mesh, f)).second);
  }
  EXPECT_EQ(named, expected);
}

TEST(GenerateVessel, TheFlowKeepsToTheLumenAndSplits) {
  const MeshData& mesh = vessel();
  const DataArray& velocity = mesh.point_data[0];
  ASSERT_EQ(velocity.name, "velocity");
  ASSERT_EQ(velocity.values.size(), 3 * mesh.points.size());
  std::vector<std::uint8_t> inside(mesh.points.size(), 0);
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    for (const std::uint32_t v : mesh.cell(c)) inside[v] |= mesh.free[c];
  }
  double peak = 0;
  for (std::uint32_t v = 0; v < mesh.points.size(); ++v) {
    peak = std::max(peak, norm(vector_at(velocity, v)));
    EXPECT_TRUE(inside[v] == 1 || norm(vector_at(velocity, v)) == 0.0);
  }
  EXPECT_NEAR(peak, 0.3, 0.01);

  std::map<std::string, double> through;
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const CornerNumbers face = patch_face(mesh, f);
    const std::string& name = mesh.patch_names.at(mesh.patch_tags[f]);
    through[name] += flux(mesh, velocity, face);
    if (name != "wall") continue;
    for (const std::uint32_t v : face) EXPECT_EQ(norm(vector_at(velocity, v)), 0.0);
  }
  const double poiseuille = 0.5 * 0.3 * 3.14159265 * 3e-3 * 3e-3;
  EXPECT_NEAR(through["inlet"], -poiseuille, 0.02 * poiseuille);
  EXPECT_NEAR(through["outlet_left"], 0.5 * poiseuille, 0.01 * poiseuille);
  EXPECT_NEAR(through["outlet_right"], 0.5 * poiseuille, 0.01 * poiseuille);

  // The flow that does not leave a cell again, as a share of all flow that enters cells.
  double lost = 0, entered = 0;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    if (mesh.free[c] == 0) continue;
    double sum = 0;
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> face) {
      const double out = flux(mesh, velocity, from_lowest(face));
      sum += out;
      entered += std::max(0.0, -out);
    });
    lost += std::abs(sum);
  }
  EXPECT_LT(lost, 0.02 * entered);
}

TEST(GenerateVessel, PulseDirectionsPointFromTheCentreLine) {
  const MeshData& mesh = vessel();
  ASSERT_EQ(mesh.point_data[1].name, "pulse_direction");
  ASSERT_EQ(mesh.point_data[2].name, "path_length");
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const std::string& name = mesh.patch_names.at(mesh.patch_tags[f]);
    if (name != "wall") continue;
    for (const std::uint32_t v : patch_face(mesh, f)) {
      const double length = mesh.point_data[2].values[v], radius = norm(vector_at(mesh.point_data[1], v));
      const bool trunk = length < 20e-3;
      if (trunk || length > 45e-3) {
        EXPECT_NEAR(radius, trunk ? 3e-3 : 0.79 * 3e-3, 1e-8);
      }
    }
  }
}

TEST(GenerateVessel, IsValidOverTheWholeRangeOfItsOptions) {
  const unsigned stride = test::full_tier() ? 1 : test::sanitized() ? 85 : 5;
  for (unsigned bits = 0; bits < 256; bits += stride) {
    const auto pick = [&](unsigned bit, double low, double high) { return ((bits >> bit) & 1U) == 0 ? low : high; };
    VesselOptions o;
    o.radius = 1.0;
    o.trunk_length = pick(0, 4, 6);
    o.branch_lengths = {pick(1, 6, 9), 6};
    o.branch_radius = pick(2, 0.7, 0.85);
    o.branch_angle = pick(3, 0.4, 0.8);
    o.out_of_plane = pick(4, 0, 0.7);
    o.tissue_thickness = pick(5, 0.2, 0.8);
    o.step_length = pick(6, 0.1, 0.5);
    o.core = static_cast<std::uint32_t>(pick(7, 2, 5));
    o.rings = static_cast<std::uint32_t>(pick(7, 1, 4));
    o.tissue_layers = static_cast<std::uint32_t>(pick(7, 1, 3));
    const MeshData mesh = generate_vessel(o);
    ASSERT_EQ(test::count_not_positive(mesh, mesh.points), 0U) << "bits " << bits;
    if (bits % 15 == 0) test::expect_conforming(mesh);
  }
}

TEST(GenerateVessel, RefusesWhatItCannotBuild) {
  const auto refuses = [](auto&& change, const char* text) {
    VesselOptions o;
    change(o);
    try {
      generate_vessel(o);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const InvalidArgument& e) {
      EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
    }
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  refuses([](VesselOptions& o) { o.radius = 0; }, "radius");
  refuses([](VesselOptions& o) { o.trunk_length = nan; }, "trunk_length");
  refuses([](VesselOptions& o) { o.branch_lengths[1] = 1e-3; }, "branch_lengths");
  refuses([](VesselOptions& o) { o.branch_radius = 1; }, "branch_radius");
  refuses([](VesselOptions& o) { o.branch_angle = 2; }, "branch_angle");
  refuses([](VesselOptions& o) { o.out_of_plane = -1; }, "out_of_plane");
  refuses([](VesselOptions& o) { o.tissue_thickness = 0; }, "tissue_thickness");
  refuses([](VesselOptions& o) { o.core = 1; }, "core");
  refuses([](VesselOptions& o) { o.rings = 0; }, "rings");
  refuses([](VesselOptions& o) { o.tissue_layers = 0; }, "tissue_layers");
  refuses([](VesselOptions& o) { o.step_length = 1; }, "step_length");
  refuses([](VesselOptions& o) { o.peak_speed = nan; }, "peak_speed");
}

}  // namespace dartcast::generate_vessel_test
