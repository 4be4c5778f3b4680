#include "simulation/seeding.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "base/random.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/simulation.hpp"

namespace dartcast::seeding_test {

constexpr int count = 20000;

// Within 6 standard deviations of what is expected of `count` draws.
void expect_share(int found, double share) {
  EXPECT_NEAR(found, count * share, 6 * std::sqrt(count * share * (1 - share)));
}

MeshData corner_tetrahedron() {
  MeshData mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.add_cell(CellType::tetrahedron, std::vector<std::uint32_t>{0, 1, 2, 3});
  mesh.add_patch_face(std::vector<std::uint32_t>{0, 2, 1}, 5);
  mesh.patch_names = {{5, "base"}};
  return mesh;
}

// The part of a tetrahedron within half its height of a corner is an eighth of it.
TEST(VolumeSampler, FillsATetrahedronEvenly) {
  const CellComplex complex(corner_tetrahedron());
  const VolumeSampler sampler(complex);
  std::array<int, 4> near_corner{};
  for (int i = 0; i < count; ++i) {
    KeyedRandom random(1, RandomPurpose::place, static_cast<std::uint64_t>(i));
    const Vec3 p = sampler.sample(complex, random)->position;
    const std::array<double, 4> w = {1 - p.x - p.y - p.z, p.x, p.y, p.z};
    for (std::size_t k = 0; k < 4; ++k) {
      ASSERT_GE(w[k], -1e-15);
      near_corner[k] += w[k] > 0.5 ? 1 : 0;
    }
  }
  for (const int n : near_corner) expect_share(n, 0.125);
}

// A quarter of a triangle is within half its height of a corner.
TEST(PatchSampler, FillsATriangleEvenlyJustInside) {
  const CellComplex complex(corner_tetrahedron());
  const PatchSampler sampler(complex, complex.map().patch("base"));
  std::array<int, 3> near_corner{};
  for (int i = 0; i < count; ++i) {
    KeyedRandom random(1, RandomPurpose::place, static_cast<std::uint64_t>(i));
    const Vec3 p = sampler.sample(complex, random)->position;
    ASSERT_DOUBLE_EQ(p.z, 1.0 / 64);
    const std::array<double, 3> w = {1 - (p.x + p.y) * 64 / 63, p.x * 64 / 63, p.y * 64 / 63};
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_GE(w[k], -1e-15);
      near_corner[k] += w[k] > 0.5 ? 1 : 0;
    }
  }
  for (const int n : near_corner) expect_share(n, 0.25);
}

// Two faces of equal size; the plane between them moves, so that one is three times as large.
TEST(PatchSampler, FollowsTheMovingMesh) {
  BoxOptions box;
  box.cells = {2, 1, 1};
  box.size = {2, 1, 1};
  const MeshData mesh = generate_box(box);
  DeformationStep frames;
  frames.kind = DeformationKind::frames;
  frames.times = {0.0, 1.0};
  frames.frames = {mesh.points, mesh.points};
  for (Vec3& p : frames.frames[1]) p.x += p.x == 1.0 ? 0.5 : 0.0;
  Environment environment(mesh);
  SimulationOptions options;
  options.dt = 1.0;
  Simulation simulation(environment, options);
  simulation.set_deformation(Deformation({frames}, mesh.points));
  simulation.add_inlet(environment.map().patch("zmin"), count, {});
  const auto in_first_cell = [&](std::size_t from) {
    int n = 0;
    for (std::size_t i = from; i < simulation.particles().size(); ++i) {
      n += environment.map().source(simulation.particles()[i].cell) == 0 ? 1 : 0;
    }
    return n;
  };
  simulation.step();  // put in at rest, where the faces were equal: those beside x = 1 change cell as it passes
  simulation.step();
  expect_share(in_first_cell(count), 0.75);
}

// Whether both draw the same; an empty one is as good as none.
void expect_as_new(const PatchSampler& sampler, const CellComplex& complex, Patch patch) {
  std::optional<PatchSampler> fresh;
  try {
    fresh.emplace(complex, patch);
  } catch (const InvalidArgument&) {
    EXPECT_TRUE(sampler.empty());
    return;
  }
  ASSERT_FALSE(sampler.empty());
  for (std::uint64_t i = 0; i < 50; ++i) {
    KeyedRandom random(2, RandomPurpose::place, i);
    KeyedRandom same(2, RandomPurpose::place, i);
    const Sample drawn = *sampler.sample(complex, random);
    const Sample expected = *fresh->sample(complex, same);
    EXPECT_EQ(drawn.simplex, expected.simplex);
    EXPECT_EQ(drawn.position, expected.position);
  }
}

TEST(PatchSampler, IsAfterAnEditAsANewOne) {
  BoxOptions box;
  box.cells = {3, 2, 2};
  box.size = {3, 2, 2};
  MeshData mesh = generate_box(box);
  const auto point = [&](const Vec3& x) {
    return static_cast<std::uint32_t>(std::find(mesh.points.begin(), mesh.points.end(), x) - mesh.points.begin());
  };
  // An inner face, too: it is a wall while just one of its cells is free.
  mesh.add_patch_face(
      std::vector<std::uint32_t>{point({1, 0, 0}), point({1, 1, 0}), point({1, 1, 1}), point({1, 0, 1})},
      mesh.patch_names.begin()->first);
  CellComplex complex(mesh);
  const CombinatorialMap& map = complex.map();
  const Patch patch = map.patch(mesh.patch_names.begin()->second);
  PatchSampler sampler(complex, patch);
  Random random(3);
  const auto make = [&](const std::function<void(Transaction&)>& action) {
    ComplexEdit edit(complex);
    action(edit.topology());
    sampler.update_after_edit(complex, edit.commit());
    expect_as_new(sampler, complex, patch);
  };
  const auto any_cell = [&] { return map.cells()[random.below(static_cast<std::uint32_t>(map.cell_count()))]; };
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    const Cell c = any_cell();
    const Dart d{c, static_cast<std::uint16_t>(random.below(map.shape(c).dart_count()))};
    if (i % 3 == 0) make([&](Transaction& t) { split_edge(t, d); });
    if (i % 3 == 1) make([&](Transaction& t) { t.set_free(c, !map.is_free(c)); });
    if (i % 12 == 11) make([&](Transaction& t) { remove(t, c); });
  }
  for (const bool free : {false, true}) {
    make([&](Transaction& t) {
      for (const Cell c : map.cells()) t.set_free(c, free);
    });
    EXPECT_EQ(sampler.empty(), !free);
  }
}

// The particle with an id gets the same place in whatever portions particles are added.
TEST(Seeding, PlacesDependOnIdsAlone) {
  Environment environment(generate_bar());
  SimulationOptions options;
  options.seed = 11;
  Simulation whole(environment, options), parts(environment, options);
  whole.add_random(300, {});
  for (const std::size_t n : {1U, 99U, 0U, 200U}) parts.add_random(n, {});
  for (std::size_t i = 0; i < 300; ++i) EXPECT_EQ(whole.particles()[i].position, parts.particles()[i].position);
  Simulation later(environment, options);
  later.add(std::vector<Vec3>(100, whole.particles()[0].position), {});
  later.add_random(200, {});
  for (std::size_t i = 100; i < 300; ++i) EXPECT_EQ(whole.particles()[i].position, later.particles()[i].position);
}

TEST(FixedPointScale, SumsDoNotDependOnOrderAndFitIn63Bits) {
  for (const double unit : {0x1p-290, 0.7, 0x1p+290}) {
    for (const std::size_t n : {1UL, 7UL, 1000UL}) {
      const FixedPointScale scale(unit, n);
      const std::uint64_t one = scale(unit);
      EXPECT_LT(one, (1ULL << 62U) / n);
      EXPECT_GT(one, (1ULL << 59U) / n / 2);
      EXPECT_NEAR(static_cast<double>(scale(unit / 3)), static_cast<double>(one) / 3,
                  1.0 + static_cast<double>(one) * 0x1p-52);
    }
  }
  EXPECT_EQ(FixedPointScale(0.0, 3)(0.0), 0U);
}

TEST(Samplers, NeedSomewhereToPutParticles) {
  MeshData mesh = corner_tetrahedron();
  mesh.free = {0};
  const CellComplex complex(mesh);
  EXPECT_THROW(VolumeSampler{complex}, InvalidArgument);
  EXPECT_THROW(PatchSampler(complex, complex.map().patch("base")), InvalidArgument);
}

}  // namespace dartcast::seeding_test
