// Walks through whole hexahedra: where a cell is called decided, the line leaves it as the exact walk from simplex to
// simplex does, and its target is beyond.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "base/random.hpp"
#include "complex/simplex.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"
#include "support/random_vectors.hpp"
#include "support/tier.hpp"
#include "topology/exit_table.hpp"
#include "tracking/batch/batch_cell_lanes.inl"

namespace dartcast::test::cell_walk_test {

using namespace detail;            // NOLINT(google-build-using-namespace)
using namespace detail::portable;  // NOLINT(google-build-using-namespace)

struct Cube {
  std::array<Vec3, 8> corner;
  double size;
};

// A cube that is bent, turned by its numbers, of any size, anywhere. Often its faces are far from flat.
Cube any_cube(Random& random) {
  Cube cube{{}, std::exp2(random.uniform(-30.0, 30.0))};
  const double bent = random.below(2) == 0 ? 0.1 : 0.45;
  const double thin = std::exp2(-random.uniform(0.0, 1.0) * (random.below(4) == 0 ? 24.0 : 2.0));
  const Vec3 away = random_vector(random) * (random.below(2) == 0 ? 0.0 : std::exp2(random.uniform(0.0, 20.0)));
  for (unsigned i = 0; i < 8; ++i) {
    const Vec3 x = Vec3{double(i & 1U), double((i >> 1U) & 1U), double(i >> 2U)} + random_vector(random) * bent;
    cube.corner[i] = (Vec3{x.x, x.y, x.z * thin} + away) * cube.size;
  }
  return cube;
}

// Its points in any order, so that faces have any diagonals, and cells any shape.
MeshData mesh_of(const Cube& cube, Random& random) {
  std::array<std::uint32_t, 8> number{};
  std::iota(number.begin(), number.end(), 0U);
  for (std::uint32_t i = 7; i > 0; --i) std::swap(number[i], number[random.below(i + 1)]);
  MeshData mesh;
  mesh.points.resize(8);
  for (unsigned i = 0; i < 8; ++i) mesh.points[number[i]] = cube.corner[i];
  mesh.add_cell(CellType::hexahedron, std::vector<std::uint32_t>{number[0], number[1], number[3], number[2], number[4],
                                                                 number[5], number[7], number[6]});
  return mesh;
}

// Whether the line from p to q passes a triangle inside, in the direction that its corners turn around.
bool passes(const std::array<Vec3, 3>& triangle, const Vec3& p, const Vec3& q) {
  bool inside = true;
  for (unsigned i = 0; i < 3; ++i)
    inside = inside && orient3d(p, triangle[i], triangle[(i + 1) % 3], q) == Sign::positive;
  return inside;
}

class OneCell {
 public:
  explicit OneCell(const MeshData& mesh)
      : complex_(mesh), view_(complex_.map().view(complex_.map().cells().front())), shape_(view_.shape()) {}

  // Bent too far, it is invalid, or has Steiner points.
  [[nodiscard]] bool usable() const { return complex_.invalid_cells().empty() && shape_.point_count() == 8; }

  // How the line enters by a face: its triangle and simplex there. Nothing where it does not.
  [[nodiscard]] std::optional<Across> entry(std::uint16_t face, const Vec3& p, const Vec3& q) const {
    for (std::uint16_t t = 0; t < 2; ++t) {
      const auto local = shape_.triangle(face, t);
      if (passes({at(local[0]), at(local[2]), at(local[1])}, p, q)) return shape_.entry(face, t);
    }
    return std::nullopt;
  }

  // The triangle of a face that the walk leaves by; nothing where it ends before, or meets an edge.
  [[nodiscard]] std::optional<Across> exit(Across entry, const Vec3& p, const Vec3& q) const {
    for (std::size_t passed = 0; passed <= shape_.simplices().size(); ++passed) {
      const ImplicitSimplex& s = shape_.simplices()[entry.index];
      const dartcast::Corners v = {at(s.vertex[0]), at(s.vertex[1]), at(s.vertex[2]), at(s.vertex[3])};
      unsigned left = 4;
      for (unsigned f = 0; f < 4; ++f) {
        const auto corners = exit_corners(f);
        if (f != entry.place && passes({v[corners[0]], v[corners[1]], v[corners[2]]}, p, q)) left = f;
      }
      if (left == 4 || orient_facet(v, left, q) != Sign::negative) return std::nullopt;
      if (s.across[left].outer()) return s.across[left];
      entry = s.across[left];
    }
    return std::nullopt;
  }

  [[nodiscard]] const CellRow& row(unsigned number) const { return shape_.exits().cell_rows()[number]; }
  [[nodiscard]] const Vec3& at(std::uint16_t local) const { return complex_.positions()[view_.vertex(local).value]; }
  // Seen from outside, from the first one of the face's fan on.
  [[nodiscard]] const Vec3& corner_of(std::uint16_t face, unsigned i) const { return at(shape_.corners(face)[i]); }
  [[nodiscard]] Vec3 somewhere(Random& random) const {
    Vec3 sum;
    double weights = 0.0;
    for (std::uint16_t i = 0; i < 8; ++i) {
      const double w = random.below(3) == 0 ? 0.0 : random.uniform();
      sum += (at(i) - at(0)) * w;
      weights += w;
    }
    return at(0) + sum * (1.0 / (weights + 1e-300));
  }

 private:
  CellComplex complex_;
  CellView view_;
  const Shape& shape_;
};

Vec3x4 in_all_lanes(const Vec3& x) { return load_vec3x4(x, x, x, x); }

// The walk through the cell, from the row on, in all lanes. `reached`: whether all corners are, so that it may decide.
CellWalks8 walk_through(const OneCell& cell, const CellRow& row, const Vec3& p, const Vec3& q, double reach,
                        bool& reached) {
  CellStarts4 starts;
  starts.line = Lines4(in_all_lanes(p), in_all_lanes(q));
  FarCorners8 far;
  far.diagonals = splat_int(static_cast<int>(row.diagonals));
  Double4 most{};
  for (unsigned i = 0; i < 4; ++i) {
    starts.near[i] = starts.line.project(in_all_lanes(cell.at(row.near[i])));
    most = larger(most, largest(magnitude(starts.near[i])));
    std::fill_n(far.at[i], 8, &cell.at(row.far[i]));
  }
  starts.line.set_reach(most);
  starts.line.reach_to(starts.line.reach * reach);
  for (const std::uint8_t corner : row.far)
    most = larger(most, largest(magnitude(starts.line.project(in_all_lanes(cell.at(corner))))));
  reached = most[0] <= starts.line.reach[0];
  CellWalks8 walk;
  for (unsigned l = 0; l < 8; ++l) walk.begin(l, starts, l % 4);
  if (!in_range_of_floats(starts.line, 0)) walk.side_bound += std::numeric_limits<float>::infinity();
  walk.pass(far);
  return walk;
}

struct Tally {
  int entered = 0;
  int decided = 0;
  int far_face = 0;
  int undecided = 0;
};

// The first mistake on a line, or nothing.
std::string check(const OneCell& cell, const Vec3& p, const Vec3& q, Random& random, Tally& tally) {
  for (std::uint16_t face = 0; face < 6; ++face) {
    const std::optional<Across> entry = cell.entry(face, p, q);
    if (!entry) continue;
    ++tally.entered;
    const CellRow& row = cell.row(4U * face + random.below(4));
    bool reached = false;
    const CellWalks8 walk = walk_through(cell, row, p, q, random.below(16) == 0 ? 0x1p-3 : 1.0, reached);
    if (walk.undecided != 0 && walk.undecided != 255) return "lanes differ";
    tally.undecided += walk.undecided != 0 ? 1 : 0;
    if (walk.undecided != 0 || walk.near_end != 0) continue;
    ++tally.decided;
    if (!reached) return "a corner out of reach";
    const std::optional<Across> exit = cell.exit(*entry, p, q);
    if (!exit) return fmt::format("face {}: passes a cell that the walk does not leave", face);
    const CellWay& way = row.ways[static_cast<std::size_t>(walk.exit[7])];
    if (way.face != exit->face() || way.triangle != exit->place)
      return fmt::format("face {}: leaves by triangle {} of face {}, not {} of {}", face, way.triangle, way.face,
                         exit->place, exit->face());
    tally.far_face += walk.exit[7] >= 8 ? 1 : 0;
    // The next row begins where the face's fan does.
    for (unsigned i = 0; i < 4; ++i) {
      const LineCorner8& next = walk.near[(way.beyond + i) % 4];
      const Vec3x4 corner = walk.line[1].project(in_all_lanes(cell.corner_of(way.face, i)));
      if (next.u[7] != static_cast<float>(corner.x[3]) || next.z[7] != static_cast<float>(corner.z[3]))
        return fmt::format("face {}: corner {} of the next row is another", face, i);
    }
  }
  return "";
}

TEST(CellWalks, DecideOnlyWhatIsSo) {
  Random random(20261128);
  Tally tally;
  const int rounds = scaled(40000, 2000000);
  for (int round = 0; round < rounds; ++round) {
    const OneCell cell(mesh_of(any_cube(random), random));
    if (!cell.usable()) continue;
    // Through the cell, from near or far; some lines end in it, some pass a corner closely.
    const Vec3 inside = cell.somewhere(random);
    const Vec3 aim =
        random.below(4) == 0 ? cell.at(static_cast<std::uint16_t>(random.below(8))) : cell.somewhere(random);
    const Vec3 way = (aim - inside) * std::exp2(random.uniform(-1.0, random.below(2) == 0 ? 3.0 : 8.0));
    const Vec3 p = inside - way * random.uniform(0.0, 2.0);
    const Vec3 q = inside + way * random.uniform(0.0, 2.0);
    const std::string wrong = check(cell, p, q, random, tally);
    ASSERT_EQ(wrong, "") << "round " << round;
  }
  EXPECT_GT(tally.entered, rounds / 4);
  EXPECT_GT(tally.decided, rounds / 8);
  EXPECT_GT(tally.far_face, tally.decided / 16);
  EXPECT_GT(tally.undecided, rounds / 1000);
}

TEST(CellWalks, KnowTheSizeOfRecords) {
  const CombinatorialMap map;
  EXPECT_EQ(map.record_stride(hexahedra), words_of_hexahedron);
}

// Through more cells than 16 bits have room for tests.
TEST(CellWalks, CountTheTestsOfVeryLongSteps) {
  constexpr std::uint32_t cells = 5000;
  BoxOptions row;
  row.cells = {1, 1, cells};
  row.size = {1.0, 1.0, cells};
  Environment environment(generate_box(row));
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{0.4, 0.3, 0.2}});
  const StepReport report = environment.advance(particles, std::vector<Vec3>{{0.6, 0.55, cells - 0.3}});
  EXPECT_TRUE(report.contacts.contacts.empty());
  EXPECT_EQ(particles[0].cell.index(), cells - 1);
  EXPECT_GT(report.counters.orientation.tests, std::uint64_t{CellWalks8::sides_asked} * (cells - 100));
}

}  // namespace dartcast::test::cell_walk_test
