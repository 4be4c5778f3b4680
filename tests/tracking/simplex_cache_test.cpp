// The claims of cached barycentric coordinates, against exact signs.
#include "tracking/batch/simplex_cache.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/random.hpp"
#include "complex/simplex.hpp"
#include "dartcast/environment.hpp"
#include "support/random_vectors.hpp"
#include "support/tier.hpp"
#include "tracking/batch/batch.hpp"
#include "tracking/batch/coordinate_bounds.hpp"
#include "tracking/carry.hpp"

namespace dartcast::test::simplex_cache_test {

// One tetrahedron: of any shape, at any distance from the origin, of any size.
std::optional<CellComplex> any_tetrahedron(Random& random) {
  const double size = std::exp2(random.uniform(-40.0, 40.0));
  const double flat = std::exp2(random.uniform(-6.0, 0.0));
  const Vec3 away = random_vector(random) * (size * std::exp2(random.uniform(-2.0, 44.0)));
  MeshData mesh;
  for (unsigned i = 0; i < 4; ++i) {
    Vec3 v = random_vector(random) * size;
    v.z *= flat;
    mesh.points.push_back(Vec3{v.y, v.z, v.x} + away);
  }
  if (volume_sign({mesh.points[0], mesh.points[1], mesh.points[2], mesh.points[3]}) == Sign::negative)
    std::swap(mesh.points[0], mesh.points[1]);
  mesh.add_cell(CellType::tetrahedron, std::array<std::uint32_t, 4>{0, 1, 2, 3});
  CellComplex complex(mesh);
  if (!complex.invalid_cells().empty()) return std::nullopt;
  return complex;
}

Vec3 combined(const Corners& v, const std::array<double, 4>& weights) {
  const double sum = (weights[0] + weights[1]) + (weights[2] + weights[3]);
  Vec3 x;
  for (unsigned i = 0; i < 4; ++i) x += v[i] * (weights[i] / sum);
  return x;
}

// The cache entry after a step that does not move.
detail::SimplexCacheEntry cache_at(const CellComplex& complex, SimplexId at, const Vec3& p) {
  std::vector<ParticleState> states(1);
  states[0].put(at, p);
  std::vector<detail::VertexNumbers> vertices = {detail::vertex_numbers(complex, at)};
  detail::SimplexCache caches;
  caches.resize(1);
  const std::vector<Vec3> targets = {p};
  std::vector<detail::StepStatus> taken(1);
  std::vector<StepState> partial;
  Counters counters;
  detail::step_batch({&complex, false, false, StepOptions{}},
                     {states, vertices, caches.from(0), targets, taken, partial}, counters);
  return caches[0];
}

// As the batch computes them.
std::array<double, 4> coordinates(const detail::SimplexCacheEntry& m, const Vec3& q) {
  std::array<double, 4> c{};
  for (unsigned i = 0; i < 4; ++i)
    c[i] = ((double{m.x[i]} * q.x + double{m.y[i]} * q.y) + double{m.z[i]} * q.z) + m.w[i];
  return c;
}

// Near a facet, near the simplex, or far away, also along a facet.
Vec3 any_point(Random& random, const Corners& v) {
  std::array<double, 4> weights{};
  for (double& w : weights) w = random.uniform();
  const std::uint32_t kind = random.below(5);
  const std::uint32_t facet = random.below(4);
  if (kind == 0 || kind == 4) weights[facet] = random.uniform(-1, 1) * std::exp2(random.uniform(-20.0, -8.0));
  if (kind == 1) weights[facet] = random.uniform(-1, 0);
  const Vec3 x = combined(v, weights);
  const Vec3 corner = v[kind == 4 ? (facet + 1 + random.below(3)) % 4 : random.below(4)];
  return kind >= 3 ? x + (corner - x) * std::exp2(random.uniform(0.0, kind == 3 ? 60.0 : 20.0)) : x;
}

struct Tally {
  std::uint64_t inside = 0;
  std::uint64_t beyond = 0;
  std::uint64_t near = 0;  // of both, within twice the margin
  std::uint64_t none = 0;
};

// The first wrong claim about q.
std::string wrong_about(const std::array<double, 4>& c, const Corners& v, const Vec3& q, Tally& tally) {
  using detail::coordinate_margin;
  const auto above = [](double x) { return x > coordinate_margin; };
  const auto known = [](double x) { return std::abs(x) > coordinate_margin && std::abs(x) <= detail::max_for_sign; };
  const bool inside = std::ranges::all_of(c, above);
  if (!inside && !std::ranges::all_of(c, known)) return {};
  ++(inside ? tally.inside : tally.beyond);
  tally.near += std::ranges::any_of(c, [](double x) { return std::abs(x) < 2.0 * coordinate_margin; }) ? 1 : 0;
  std::uint64_t exact = 0;
  const Determinants d(v, q);
  for (unsigned i = 0; i < 4; ++i) {
    const Sign expected = c[i] > 0.0 ? Sign::positive : Sign::negative;
    if (sign_of(d, i, v, q, exact) != expected) return fmt::format("coordinate {} is {}, with the other sign", i, c[i]);
  }
  return {};
}

TEST(SimplexCacheEntry, CoordinatesClaimNothingWrong) {
  Tally tally;
  const auto count = static_cast<std::uint64_t>(scaled(4000, 400000));
  for (std::uint64_t seed = 0; seed < count; ++seed) {
    Random random(seed, 31);
    const auto complex = any_tetrahedron(random);
    if (!complex) continue;
    const SimplexId at{complex->map().cells().front(), 0};
    const Corners v = complex->corners(at);
    const Vec3 p = combined(v, {random.uniform(), random.uniform(), random.uniform(), random.uniform()});
    if (!detail::in_closed_simplex(v, p)) continue;
    const detail::SimplexCacheEntry entry = cache_at(*complex, at, p);
    if (entry.w[0] == detail::proves_nothing) ++tally.none;
    for (int i = 0; i < 20; ++i) {
      const Vec3 q = any_point(random, v);
      ASSERT_EQ(wrong_about(coordinates(entry, q), v, q, tally), "") << "seed " << seed;
    }
  }
  EXPECT_GT(tally.inside, scaled(8000, 800000));
  EXPECT_GT(tally.beyond, scaled(5000, 500000));
  EXPECT_GT(tally.near, scaled(50, 5000));
  EXPECT_GT(tally.none, scaled(100, 10000));
}

// Corners at the edge of the range, and numbers that floats don't hold: nothing is claimed.
TEST(SimplexCacheEntry, CoordinatesAreNotMadeOutOfTheirRange) {
  for (const double size : {0x1p-290, 0x1p-150, 0x1p+101, 0x1p+290}) {
    MeshData mesh;
    mesh.points = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}};
    mesh.add_cell(CellType::tetrahedron, std::array<std::uint32_t, 4>{0, 1, 2, 3});
    const CellComplex complex(mesh);
    const Vec3 p = Vec3{0.25, 0.25, 0.25} * size;
    const detail::SimplexCacheEntry entry = cache_at(complex, {complex.map().cells().front(), 0}, p);
    EXPECT_EQ(entry.w[0], detail::proves_nothing) << size;
    for (const double c : coordinates(entry, p)) EXPECT_FALSE(c > detail::coordinate_margin) << size;
  }
}

// Two tetrahedra share a face x + y + z = 2. Particles on it, known to be, go beside it, to points of few bits each
// whose sum rounds to 2.
TEST(SimplexCacheEntry, ZerosAreProvedOnlyWhereNothingIsRounded) {
  for (const bool in_x : {false, true}) {
    const Vec3 shift = in_x ? Vec3{0, 0, 2} : Vec3{2, 0, 0};
    MeshData mesh;
    for (const Vec3& p : {Vec3{4, 0, -4}, Vec3{-4, 0, 4}, Vec3{0, 4, -4}, Vec3{-4, 0, 0}, Vec3{4, 0, 0}})
      mesh.points.push_back(p + shift);
    mesh.add_cell(CellType::tetrahedron, std::array<std::uint32_t, 4>{0, 1, 2, 3});
    mesh.add_cell(CellType::tetrahedron, std::array<std::uint32_t, 4>{0, 2, 1, 4});
    for (const Vec3& from : {Vec3{-1, 1, -1}, Vec3{1, 1, -1}}) {
      for (const double off : {0x1p-52, -0x1p-53, 0x1p-60, -0x1p-60, 0x1p-100}) {
        const Vec3 beside = in_x ? Vec3{off, 1, 1} : Vec3{1, 1, off};
        Environment environment(mesh, Threads{1});
        Particles particles;
        environment.add(particles, std::vector<Vec3>{from + shift});
        ASSERT_EQ(particles.size(), 1U);
        for (const Vec3& q : {Vec3{0, 2, -2} + shift, Vec3{-1, 1, 0} + shift, Vec3{-0.5, 1.5, -1} + shift, beside}) {
          environment.advance(particles, std::vector<Vec3>{q});
          EXPECT_TRUE(detail::in_closed_simplex(environment.complex().corners(particles[0].at()), q)) << q.x;
          EXPECT_EQ(particles[0].position, q);
        }
      }
    }
  }
}

}  // namespace dartcast::test::simplex_cache_test
