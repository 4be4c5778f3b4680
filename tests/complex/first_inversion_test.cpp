// The first inversion of a scene is that of its simplices taken one by one. A motion followed until then stays valid.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "base/random.hpp"
#include "complex/steiner_points.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/validity.hpp"
#include "support/meshes.hpp"
#include "support/points.hpp"
#include "support/random_vectors.hpp"
#include "support/tier.hpp"

namespace dartcast::first_flattening_test {

using test::mapped;
using test::random_vector;

constexpr int mesh_kinds = 7;

// Hexahedra, tetrahedra, prisms, pyramids, all of them mixed, polyhedra, and hexahedra that need Steiner points.
MeshData mesh_of(int kind) {
  if (kind == 5) return generate_octahedra({.cells = {3, 3, 3}, .size = Vec3{3, 3, 3}});
  BoxOptions o;
  o.cells = {5, 4, 4};
  o.size = {5, 4, 4};
  o.jitter = kind == 6 ? 0.9 : 0.3;
  test::set_kind(o, kind);
  return generate_box(o);
}

std::vector<Vec3> moved(std::span<const Vec3> points, Random& random, double size) {
  std::vector<Vec3> result(points.begin(), points.end());
  for (Vec3& p : result) p += random_vector(random, size);
  return result;
}

struct Reference {
  SimplexId simplex;
  SimplexInversion how;
};

// All simplices one after another.
std::optional<Reference> reference(const CombinatorialMap& map, std::span<const Vec3> before,
                                   std::span<const Vec3> after, const std::vector<Cell>& cells) {
  std::optional<Reference> first;
  for (const Cell c : cells) {
    const CellView v = map.view(c);
    for (std::uint16_t s = 0; s < v.shape().simplices().size(); ++s) {
      Corners from, to;
      for (unsigned i = 0; i < 4; ++i) {
        from[i] = before[v.vertex(v.shape().simplices()[s].vertex[i]).value];
        to[i] = after[v.vertex(v.shape().simplices()[s].vertex[i]).value];
      }
      const auto how = find_inversion(from, to);
      if (how && (!first || how->safe_time < first->how.safe_time)) first = {{c, s}, *how};
    }
  }
  return first;
}

void expect_same(const CombinatorialMap& map, const std::optional<CellInversion>& found,
                 const std::optional<Reference>& truth) {
  ASSERT_EQ(found.has_value(), truth.has_value());
  if (!found) return;
  EXPECT_EQ(found->simplex, truth->simplex);
  EXPECT_EQ(found->how, truth->how);
  const CellView v = map.view(found->simplex.cell);
  for (unsigned i = 0; i < 4; ++i)
    EXPECT_EQ(found->vertices[i], v.vertex(v.shape().simplices()[found->simplex.simplex].vertex[i]));
}

TEST(FirstFlattening, IsThatOfAllSimplicesOneByOne) {
  int flattened = 0, none = 0;
  for (int kind = 0; kind < mesh_kinds; ++kind) {
    const MeshData mesh = mesh_of(kind);
    const CellComplex complex(mesh);
    const CombinatorialMap& map = complex.map();
    ASSERT_TRUE(complex.invalid_cells().empty());
    if (kind == 6) ASSERT_GT(complex.steiner_point_count(), 0U);
    Random random(static_cast<std::uint64_t>(kind) + 1);
    for (const double size : {0.01, 0.05, 0.15, 0.5, 3.0}) {
      const auto after = moved(complex.positions(), random, size);
      const auto found = first_inversion(map, complex.positions(), after, Threads{1});
      expect_same(map, found, reference(map, complex.positions(), after, map.cells()));
      (found ? flattened : none) += 1;
      for (const Cell c : map.cells()) {
        expect_same(map, first_inversion(map, complex.positions(), after, c),
                    reference(map, complex.positions(), after, {c}));
      }
    }
  }
  EXPECT_GT(flattened, 15);
  EXPECT_GT(none, 5);
}

TEST(FirstFlattening, IsNoneForMotionsThatInvertNothing) {
  for (int kind = 0; kind < mesh_kinds; ++kind) {
    const CellComplex complex(mesh_of(kind));
    const auto found = [&](const std::function<Vec3(const Vec3&)>& to) {
      return first_inversion(complex.map(), complex.positions(), mapped(complex.positions(), to));
    };
    EXPECT_FALSE(found([](const Vec3& p) { return p; }));
    EXPECT_FALSE(found([](const Vec3& p) { return p + Vec3{8, -1, 2}; }));
    EXPECT_FALSE(found([](const Vec3& p) { return Vec3{-p.y, p.x, p.z}; }));
    EXPECT_FALSE(found([](const Vec3& p) { return Vec3{p.x, 0.125 * p.y, 4 * p.z}; }));
    // About an axis by 150 degrees: coefficients are negative, the volume is not.
    EXPECT_FALSE(found([](const Vec3& p) { return Vec3{-0.866 * p.x - 0.5 * p.y, 0.5 * p.x - 0.866 * p.y, p.z}; }));
    // By 180 degrees every simplex is flat half way, and has turned nothing in the end.
    const auto half_turn = found([](const Vec3& p) { return Vec3{-p.x, -p.y, p.z}; });
    ASSERT_TRUE(half_turn);
    EXPECT_EQ(half_turn->how.safe_time, 0.5 - inversion_resolution);
    EXPECT_TRUE(check_validity(complex.map(),
                               mapped(complex.positions(),
                                      [](const Vec3& p) {
                                        return Vec3{-p.x, -p.y, p.z};
                                      }),
                               {}, 1)
                    .valid());
  }
}

// 13,824 cells: several chunks. Some simplices all invert at once, some one after another.
TEST(FirstFlattening, SameForAnyNumberOfThreadsAndFirstByCell) {
  BoxOptions o;
  o.cells = {24, 24, 24};
  o.size = {24, 24, 24};
  o.blocked_share = 0.3;
  const MeshData mesh = generate_box(o);
  const CombinatorialMap map(mesh);
  Random random(9);
  const auto some = moved(mesh.points, random, 0.3);
  const auto truth = reference(map, mesh.points, some, map.cells());
  ASSERT_TRUE(truth);
  const auto all = mapped(mesh.points, [](const Vec3& p) { return Vec3{p.x, p.y, -3.0 * p.z}; });
  for (const unsigned threads : {1U, 2U, 7U}) {
    expect_same(map, first_inversion(map, mesh.points, some, Threads{threads}), truth);
    const auto first = first_inversion(map, mesh.points, all, Threads{threads});
    ASSERT_TRUE(first);
    EXPECT_EQ(first->simplex, (SimplexId{Cell(1, 0), 0}));
    EXPECT_EQ(first->how.safe_time, 0.25 - inversion_resolution);
  }
}

TEST(FirstFlattening, BlockedCellsCount) {
  const MeshData plain = generate_box({.cells = {3, 3, 3}, .size = Vec3{3, 3, 3}});
  MeshData blocked = plain;
  blocked.free.assign(blocked.cell_count(), 0);
  std::vector<Vec3> after = plain.points;
  after[21] = {1.5, 1.5, 3.5};  // a corner of the cell in the middle goes through the whole of it, and beyond
  const auto one = first_inversion(CombinatorialMap(plain), plain.points, after);
  const auto other = first_inversion(CombinatorialMap(blocked), blocked.points, after);
  ASSERT_TRUE(one && other);
  EXPECT_EQ(one->how, other->how);
  EXPECT_EQ(one->message, other->message);
}

// One tetrahedron, seen from the outside as the mesh has it.
MeshData tetrahedron() {
  MeshData mesh = generate_box({.type = CellType::tetrahedron});
  mesh.source.resize(mesh.cell_count());
  for (std::uint32_t c = 0; c < mesh.cell_count(); ++c) mesh.source[c] = c + 5000;
  return mesh;
}

TEST(FirstFlattening, MessagesNameCellTimeAndVertices) {
  const MeshData mesh = tetrahedron();
  const CombinatorialMap map(mesh);
  const auto corners = mesh.cell(0);
  const auto text = [&](std::size_t corner, const Vec3& to) {
    std::vector<Vec3> after = mesh.points;
    after[corners[corner]] = to;
    const auto found = first_inversion(map, mesh.points, after, Cell(0, 0));
    return found ? found->message : std::string("nothing");
  };
  const auto number = [&](std::size_t corner) { return std::to_string(corners[corner]); };
  const Vec3 mean = (mesh.points[corners[1]] + mesh.points[corners[2]] + mesh.points[corners[3]]) * (1.0 / 3.0);
  const std::string through = text(0, 2.0 * mean - mesh.points[corners[0]]);
  EXPECT_NE(through.find("cell 5000: simplex 0 inverts at 0.49"), std::string::npos) << through;
  EXPECT_NE(through.find(": vertex " + number(0) + " meets face "), std::string::npos) << through;
  const std::string onto = text(1, mesh.points[corners[2]]);
  EXPECT_NE(onto.find("vertex "), std::string::npos) << onto;
  EXPECT_NE(onto.find(" meets vertex "), std::string::npos) << onto;
  EXPECT_NE(text(1, {std::nan(""), 0, 0}).find("not finite"), std::string::npos);
  EXPECT_EQ(text(1, mesh.points[corners[1]]), "nothing");
  std::vector<Vec3> flat = mesh.points;
  flat[corners[0]] = mean;
  flat[corners[1]] = mesh.points[corners[2]];
  const auto found = first_inversion(map, flat, mesh.points, Cell(0, 0));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->how.kind, InversionKind::from_the_start);
  EXPECT_NE(found->message.find("is flat or inverted before the motion"), std::string::npos);
}

TEST(FirstFlattening, OfTheLastMoveOfAComplex) {
  CellComplex complex(mesh_of(6));
  EXPECT_FALSE(first_inversion(complex));
  const std::span<Vec3> next = complex.next_positions();
  for (Vec3& p : next) p.z = -p.z;
  complex.commit_positions();
  const auto found = first_inversion(complex);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->how.safe_time, 0.5, 1e-9);  // Steiner points are rounded
}

TEST(FirstFlattening, RefusesPositionsThatAreNotAsManyAsVertices) {
  const MeshData mesh = mesh_of(0);
  const CombinatorialMap map(mesh);
  std::vector<Vec3> fewer(mesh.points.begin(), mesh.points.end() - 1);
  EXPECT_THROW(first_inversion(map, fewer, mesh.points), InvalidArgument);
  EXPECT_THROW(first_inversion(map, mesh.points, fewer), InvalidArgument);
  EXPECT_THROW(move_towards(map, {}, mesh.points, mesh.points, 1.0, fewer), InvalidArgument);
}

// A mesh with its Steiner points.
struct Scene {
  CombinatorialMap map;
  SteinerWeights weights;
  std::vector<Vec3> positions;

  explicit Scene(const MeshData& mesh) : map(mesh), positions(mesh.points) {
    std::vector<Cell> bad;
    for (const InvalidCell& c : check_validity(map, positions, {}, map.cell_count()).first) bad.push_back(c.cell);
    const SteinerSolution solution = find_steiner_points(mesh, map, bad);
    map = CombinatorialMap(mesh, solution.points);
    weights = solution.weights;
    place(positions);
  }

  void place(std::vector<Vec3>& points) const {
    points.resize(map.vertex_count());
    weights.compute(points);
  }
};

// As a mechanical system does: stop at the inversion, choose another motion there, and continue.
TEST(FollowUntil, LeavesAValidSceneCloseToTheInversion) {
  int stopped = 0, at_once = 0;
  for (int kind = 0; kind < mesh_kinds; ++kind) {
    Scene scene(mesh_of(kind));
    Random random(static_cast<std::uint64_t>(kind) + 40);
    for (int step = 0; step < test::scaled(40, 1000); ++step) {
      std::vector<Vec3> after = moved(scene.positions, random, 0.2);
      scene.place(after);
      const auto found = first_inversion(scene.map, scene.positions, after);
      const double safe = found ? found->how.safe_time : 1.0;
      std::vector<Vec3> reached(scene.positions.size());
      const double time = move_towards(scene.map, scene.weights, scene.positions, after, safe, reached);
      ASSERT_LE(time, safe);
      ASSERT_TRUE(check_validity(scene.map, reached, {}, 1).valid());
      ASSERT_FALSE(first_inversion(scene.map, scene.positions, reached));
      if (!found) EXPECT_EQ(reached, after);
      std::vector<Vec3> placed = reached;
      scene.place(placed);
      ASSERT_EQ(placed, reached);  // Steiner points are where their weights put them
      stopped += found ? 1 : 0;
      at_once += time == safe ? 1 : 0;
      EXPECT_GT(time, safe - 0x1p-20) << "mesh " << kind << ", step " << step;
      const double half = move_towards(scene.map, scene.weights, scene.positions, after, 0.5 * safe, reached);
      EXPECT_EQ(half, 0.5 * safe);
      ASSERT_TRUE(check_validity(scene.map, reached, {}, 1).valid());
      scene.positions = reached;
    }
  }
  EXPECT_GT(stopped, test::sanitized() ? 0 : test::scaled(200, 5000));
  EXPECT_GT(at_once, stopped / 2);
}

// Far from the origin rounding leaves no room at the inversion, and earlier times are taken. In a scene that leaves no
// room at all, nothing moves.
TEST(FollowUntil, GoesBackWhereRoundingInverts) {
  Scene scene(generate_box({.cells = {2, 2, 2}, .origin = {0x1p+40, 0, 0}, .size = Vec3{2, 2, 2}}));
  const auto after = mapped(scene.positions, [](const Vec3& p) {
    return Vec3{0x1p+40 - 0.7 * (p.x - 0x1p+40), p.y, p.z};
  });
  const auto found = first_inversion(scene.map, scene.positions, after);
  ASSERT_TRUE(found);
  std::vector<Vec3> reached(scene.positions.size());
  const double time = move_towards(scene.map, {}, scene.positions, after, found->how.safe_time, reached);
  EXPECT_LT(time, found->how.safe_time);
  EXPECT_GT(time, 0.9 * found->how.safe_time);
  EXPECT_TRUE(check_validity(scene.map, reached, {}, 1).valid());

  const auto spoilt = mapped(scene.positions, [](const Vec3& p) { return Vec3{p.x, std::nan(""), p.z}; });
  EXPECT_EQ(move_towards(scene.map, {}, scene.positions, spoilt, 1.0, reached), 0.0);
  EXPECT_EQ(reached, scene.positions);
}

}  // namespace dartcast::first_flattening_test
