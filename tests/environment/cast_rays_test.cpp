// Rays against all walls of a scene, exactly; and what they refuse.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/random.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "oracle/checked_scene.hpp"
#include "support/random_vectors.hpp"
#include "support/seeds.hpp"
#include "support/tier.hpp"
#include "tracking/place_in_simplex.hpp"

namespace dartcast::test::cast_rays_test {

constexpr double inf = std::numeric_limits<double>::infinity();

// Where a ray ends, rounded as cast_rays() does: in the scene's box, which is made longer, or at its greatest distance.
Vec3 end_of(const Vec3& p, const Vec3& direction, std::span<const Vec3> points, double most) {
  Vec3 low{inf, inf, inf};
  Vec3 high{-inf, -inf, -inf};
  for (const Vec3& x : points) {
    low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
  }
  const Vec3 size = high - low;
  return p + unit_of(direction) * std::min(most, 2.0 * (size.x + size.y + size.z));
}

struct Rays {
  std::vector<Vec3> origins;
  std::vector<Vec3> directions;
};

// From points of free simplices; on lattices some lie on facets, and some go along axes and diagonals.
Rays any_rays(const CheckedScene& scene, Random& random, bool lattice) {
  Rays rays;
  const auto& simplices = scene.free_simplices();
  for (int i = 0; i < 40; ++i) {
    const std::uint32_t s = simplices[random.below(static_cast<std::uint32_t>(simplices.size()))];
    const dartcast::Corners v = scene.complex().corners(scene.library_simplex(s));
    Vec3 p = (v[0] + v[1] + v[2] + v[3]) * 0.25;
    if (lattice && random.below(2) == 0) p = (v[0] + v[1]) * 0.5;
    if (!scene.oracle().contains(s, p)) continue;
    const auto step = [&] { return static_cast<double>(random.below(3)) - 1.0; };
    const double x = step();
    const double y = step();
    Vec3 d = lattice && random.below(2) == 0 ? Vec3{x, y, 1.0} : random_vector(random);
    rays.origins.push_back(p);
    rays.directions.push_back(d * std::exp2(random.uniform(-30.0, 30.0)));
  }
  return rays;
}

// The first mistake of a ray that begins in a free cell, or nothing. q: where it ends.
std::string check_ray(const CheckedScene& scene, const RayHit& hit, const Vec3& p, const Vec3& q) {
  if (hit.origin != Place::free) return "does not begin in a free cell";
  const oracle::Trace trace = scene.oracle().trace(p, q);
  const bool ends_on = !scene.oracle().walls_at(q).empty();
  if (!hit.hit) return trace.leaves || ends_on ? "misses a wall" : "";
  // A ray that only grazes an edge or a vertex may meet it (docs/method.md); it never goes on where it leaves.
  const std::uint32_t wall = scene.oracle_wall(WallHit{hit.face, hit.triangle, hit.patch, hit.normal});
  const double time = hit.distance / norm(q - p);
  const auto is_met = [&](const oracle::Touch& t) {
    const bool in_time = !trace.leaves || t.rank <= trace.exit_rank;
    return t.wall == wall && in_time && (std::abs(t.time - time) < 1e-9 || (ends_on && time > 1.0 - 1e-9));
  };
  if (std::none_of(trace.touches.begin(), trace.touches.end(), is_met)) return "another wall, or at another distance";
  return dot(hit.normal, q - p) > 1e-9 * norm(q - p) && hit.kind == Kind::face ? "a normal that looks away" : "";
}

// The cells that a ray passes: one after another, joined by a face, or at the start by what holds the origin.
std::string check_cells(const CombinatorialMap& map, std::span<const Cell> cells, const RayHit& hit) {
  if (cells.empty()) return "passes no cell";
  if (hit.hit && cells.back() != hit.face.cell && hit.kind == Kind::face) return "ends in another cell";
  for (std::size_t i = 0; i + 1 < cells.size(); ++i) {
    bool joined = false;
    for (std::uint16_t f = 0; f < map.shape(cells[i]).face_count(); ++f)
      joined = joined || map.view(cells[i]).neighbour(f) == cells[i + 1];
    if (!joined) return "passes cells that have no face in common";
  }
  return "";
}

// The lengths of a ray in cells, against the exact parts of the segment in all simplices. A part along a facet is one
// cell's: of those that it is in.
std::string check_lengths(const CheckedScene& scene, std::span<const Cell> cells, std::span<const double> lengths,
                          const Vec3& p, const Vec3& q, double end) {
  std::map<Cell, std::pair<double, double>> truth;  // the least and the most
  for (const std::uint32_t s : scene.free_simplices()) {
    const auto [first, last, inside] = scene.oracle().passed(s, p, q);
    const double part = std::max(std::min(last, end) - std::min(first, end), 0.0);
    auto& [least, most] = truth[scene.library_simplex(s).cell];
    least += inside ? part : 0.0;
    most += part;
  }
  std::map<Cell, double> found;
  double sum = 0.0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    found[cells[i]] += lengths[i] / norm(q - p);
    sum += lengths[i] / norm(q - p);
  }
  if (std::abs(sum - end) > 1e-9) return "has lengths that do not add up to its own";
  for (const auto& [cell, range] : truth) {
    if (found[cell] < range.first - 1e-9) return "has too short a length in a cell";
    if (found[cell] > range.second + 1e-9) return "has too long a length in a cell";
  }
  return "";
}

std::string check_scene(MeshData mesh, std::uint64_t seed, bool lattice, std::atomic<int>& hits) {
  const CheckedScene scene(mesh);
  if (!scene.valid()) return "";
  Environment environment(std::move(mesh), Threads{1});
  Random random(seed, 11);
  const Rays rays = any_rays(scene, random, lattice);
  const double size = norm(scene.mesh().points[0] - scene.mesh().points.back());
  for (const double most : {inf, 0.3 * size}) {
    RayCells passed;
    const std::vector<RayHit> all = environment.cast_rays(rays.origins, rays.directions, most, &passed);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Vec3 q = end_of(rays.origins[i], rays.directions[i], scene.complex().positions(), most);
      std::string wrong = check_ray(scene, all[i], rays.origins[i], q);
      const std::span<const Cell> cells(passed.cells.data() + passed.first[i], passed.first[i + 1] - passed.first[i]);
      if (wrong.empty()) wrong = check_cells(environment.map(), cells, all[i]);
      const double end = all[i].hit ? all[i].distance / norm(q - rays.origins[i]) : 1.0;
      const auto lengths = std::span(passed.lengths).subspan(passed.first[i], cells.size());
      if (wrong.empty()) wrong = check_lengths(scene, cells, lengths, rays.origins[i], q, end);
      if (!wrong.empty()) return fmt::format("seed {}, ray {} of {}: {}", seed, i, most, wrong);
      hits += all[i].hit ? 1 : 0;
    }
  }
  return "";
}

TEST(CastRays, MeetTheFirstOfAllWalls) {
  std::atomic<int> hits{0};
  for (int kind = 0; kind < oracle::scene_kinds; ++kind) {
    const auto scene = static_cast<oracle::SceneKind>(kind);
    for (const bool lattice : {false, true}) {
      const auto complaints = run_seeds(scaled(6, 600), [&](std::uint64_t seed) {
        return check_scene(lattice ? oracle::lattice_scene(scene, seed) : oracle::random_scene(scene, seed, 0.5), seed,
                           lattice, hits);
      });
      for (const std::string& wrong : complaints) ADD_FAILURE() << oracle::name_of(scene) << ": " << wrong;
    }
  }
  if (!sanitized()) EXPECT_GT(hits.load(), 1000);
}

MeshData room() {
  BoxOptions box;
  box.cells = {4, 4, 4};
  box.size = {4, 4, 4};
  box.blocked_layer = true;
  return generate_box(box);
}

TEST(CastRays, SayWhatStandsInTheWay) {
  Environment environment(room(), Threads{1});
  const std::vector<Vec3> origins = {{2.3, 1.7, 2.2}, {2.3, 1.7, 2.2}, {-9, 0, 0}, {0.5, 0.5, 0.5}};
  const std::vector<Vec3> directions = {{2, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, 0, 0}};
  RayCells passed;
  const std::vector<RayHit> hits = environment.cast_rays(origins, directions, inf, &passed);
  const std::vector<RayHit> near = environment.cast_rays(origins, directions, 0.5);
  EXPECT_TRUE(hits[0].hit);
  EXPECT_EQ(hits[0].kind, Kind::face);
  EXPECT_NEAR(hits[0].distance, hits[0].point.x - 2.3, 1e-12);
  EXPECT_EQ(hits[0].normal, (Vec3{-1, 0, 0}));
  EXPECT_FALSE(near[0].hit);
  EXPECT_EQ(near[0].distance, inf);
  EXPECT_EQ(hits[2].origin, Place::outside);
  EXPECT_EQ(hits[3].origin, Place::blocked);
  EXPECT_FALSE(hits[2].hit || hits[3].hit);
  ASSERT_EQ(passed.first.size(), 5U);
  EXPECT_GT(passed.first[1], passed.first[0]);
  EXPECT_EQ(passed.first[4], passed.first[2]);
}

TEST(CastRays, AreTheSameForAnyNumberOfThreads) {
  BoxOptions box;
  box.cells = {8, 8, 8};
  box.size = {8, 8, 8};
  box.blocked_share = 0.2;
  Environment environment(generate_box(box), Threads{1});
  Random random(3);
  std::vector<Vec3> origins;
  std::vector<Vec3> directions;
  for (int i = 0; i < 5000; ++i) {
    origins.push_back(
        {4.0 + random.uniform(-3.9, 3.9), 4.0 + random.uniform(-3.9, 3.9), 4.0 + random.uniform(-3.9, 3.9)});
    directions.push_back(random_vector(random));
  }
  RayCells one;
  RayCells four;
  const std::vector<RayHit> by_one = environment.cast_rays(origins, directions, inf, &one);
  environment.set_threads(Threads{4});
  const std::vector<RayHit> by_four = environment.cast_rays(origins, directions, inf, &four);
  EXPECT_EQ(one.cells, four.cells);
  EXPECT_EQ(one.lengths, four.lengths);
  EXPECT_EQ(one.first, four.first);
  for (std::size_t i = 0; i < by_one.size(); ++i) {
    EXPECT_EQ(by_one[i].face, by_four[i].face);
    EXPECT_EQ(by_one[i].distance, by_four[i].distance);
  }
}

TEST(CastRays, InThePlane) {
  RectangleOptions squares;
  squares.cells = {4, 4};
  squares.size = {4, 4};
  Environment environment(generate_rectangle(squares), Threads{1});
  const std::vector<Vec3> origin = {{1.3, 2.2, 0}};
  RayCells passed;
  const auto hits = environment.cast_rays(origin, std::vector<Vec3>{{0, -3, 0}}, inf, &passed);
  ASSERT_TRUE(hits[0].hit);
  EXPECT_EQ(hits[0].kind, Kind::edge);
  EXPECT_NEAR(hits[0].distance, 2.2, 1e-12);
  EXPECT_EQ(passed.cells.size(), 3U);
  EXPECT_THROW((void)environment.cast_rays(origin, std::vector<Vec3>{{0, -3, 1}}), InvalidArgument);
}

TEST(CastRays, RefuseWhatIsNoRay) {
  Environment environment(room(), Threads{1});
  const std::vector<Vec3> origin = {{2.3, 1.7, 2.2}};
  const std::vector<Vec3> none = {{0, 0, 0}};
  const std::vector<Vec3> nowhere = {{std::nan(""), 0, 0}};
  const std::vector<Vec3> good = {{1, 0, 0}};
  EXPECT_THROW((void)environment.cast_rays(origin, none), InvalidArgument);
  EXPECT_THROW((void)environment.cast_rays(origin, nowhere), InvalidArgument);
  EXPECT_THROW((void)environment.cast_rays(nowhere, good), InvalidArgument);
  EXPECT_THROW((void)environment.cast_rays(origin, std::vector<Vec3>{}), InvalidArgument);
  EXPECT_THROW((void)environment.cast_rays(origin, good, -1.0), InvalidArgument);
  EXPECT_THROW((void)environment.cast_rays(origin, good, std::nan("")), InvalidArgument);
  EXPECT_TRUE(environment.cast_rays({}, {}).empty());
}

}  // namespace dartcast::test::cast_rays_test
