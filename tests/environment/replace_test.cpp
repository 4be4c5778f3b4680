// Meshes that are replaced while particles are in them: everybody keeps place and side, or goes to the nearest free place.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/random.hpp"
#include "dartcast/cell_tally.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "mesh/cell_types.hpp"
#include "support/expectations.hpp"
#include "support/mixed_mesh.hpp"

namespace dartcast::replace_test {

constexpr int size = 4;  // cubes along an axis
constexpr std::int32_t membrane = 99;

using Blocked = std::array<bool, size * size * size>;

Blocked blocked_cubes(Random& random) {
  Blocked blocked{};
  for (bool& b : blocked) b = random.below(5) == 0;
  return blocked;
}

Vec3 middle_of(const MeshData& mesh, std::size_t c) {
  Vec3 sum;
  for (const std::uint32_t p : mesh.cell(c)) sum += mesh.points[p];
  return sum * (1.0 / static_cast<double>(mesh.cell(c).size()));
}

// Cubes of edge 1 divided as asked, with a membrane at x = 2.
MeshData mesh_of(const Blocked& blocked, CellType type, std::uint32_t divided, Random* random = nullptr) {
  BoxOptions box;
  box.cells = {size * divided, size * divided, size * divided};
  box.size = {size, size, size};
  box.type = type;
  MeshData mesh = generate_box(box);
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const Vec3 m = middle_of(mesh, c);
    mesh.free.resize(c + 1, 1);
    mesh.free[c] = blocked[static_cast<std::size_t>(m.x) +
                           size * (static_cast<std::size_t>(m.y) + size * static_cast<std::size_t>(m.z))]
                       ? 0
                       : 1;
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> face) {
      const bool on = std::all_of(face.begin(), face.end(), [&](std::uint32_t p) { return mesh.points[p].x == 2.0; });
      if (on && m.x < 2.0) mesh.add_patch_face(face, membrane);
    });
  }
  mesh.patch_source.clear();
  mesh.patch_names[membrane] = "membrane";
  mesh.baffle_tags = {membrane};
  if (random == nullptr) return mesh;
  return test::renumbered(mesh, test::permutation(mesh.points.size(), *random));
}

double distance_to_cube(const Vec3& x, std::size_t cube) {
  const auto along = [](double v, std::size_t low) {
    const auto l = static_cast<double>(low);
    return std::max({l - v, v - (l + 1.0), 0.0});
  };
  return norm(Vec3{along(x.x, cube % size), along(x.y, cube / size % size), along(x.z, cube / size / size)});
}

double distance_to_free(const Vec3& x, const Blocked& blocked) {
  double least = 1e300;
  for (std::size_t c = 0; c < blocked.size(); ++c) {
    if (!blocked[c]) least = std::min(least, distance_to_cube(x, c));
  }
  return least;
}

// The cell's side, not the place's: some are on the membrane.
std::vector<bool> sides(const Environment& environment, const Particles& particles) {
  std::vector<bool> left;
  for (const ParticleState& s : particles.states()) {
    Vec3 sum;
    for (const Vec3& corner : environment.complex().corners(s.at())) sum += corner;
    left.push_back(sum.x < 8.0);
  }
  return left;
}

// On a lattice of quarters, and anywhere; then a step that many end on walls and on the membrane.
void add_particles(Environment& environment, Particles& particles, Random& random) {
  std::vector<Vec3> places;
  for (int i = 0; i < 600; ++i) {
    const auto quarter = [&] { return random.below(4 * size + 1) / 4.0; };
    places.push_back(i % 2 == 0 ? Vec3{quarter(), quarter(), quarter()}
                                : Vec3{random.uniform(0, size), random.uniform(0, size), random.uniform(0, size)});
  }
  environment.add(particles, places);
}

std::vector<Vec3> targets_of(const Particles& particles, Random& random) {
  std::vector<Vec3> targets;
  for (const ParticleState& s : particles.states()) {
    const bool on_lattice = random.below(2) == 0;
    const auto by = [&] { return on_lattice ? (random.below(9) - 4.0) / 4.0 : random.uniform(-1.0, 1.0); };
    targets.push_back(s.position + Vec3{by(), by(), by()});
  }
  return targets;
}

TEST(Replace, TheSameSpaceKeepsEveryPlaceAndSide) {
  Random random(7);
  const Blocked blocked = blocked_cubes(random);
  Environment environment(mesh_of(blocked, CellType::hexahedron, 1));
  Particles particles;
  add_particles(environment, particles, random);
  const std::size_t count = particles.size();
  const std::vector<bool> left = sides(environment, particles);
  std::size_t touching = 0;
  for (int round = 0; round < 12; ++round) {
    environment.advance(particles, targets_of(particles, random));
    EXPECT_EQ(sides(environment, particles), left);
    for (const ParticleState& s : particles.states()) touching += s.touching_count;
    const std::vector<ParticleState> before(particles.states().begin(), particles.states().end());
    const CellType type = random.below(2) == 0 ? CellType::hexahedron : CellType::tetrahedron;
    environment.replace(round == 0 ? mesh_of(blocked, CellType::hexahedron, 1)
                                   : mesh_of(blocked, type, 1 + random.below(2), &random));
    EXPECT_TRUE(environment.last_edit().replaced);
    const UpdateReport report = environment.update_after_edit(particles);
    EXPECT_EQ(report.located, count);
    EXPECT_TRUE(report.orphaned.empty());
    ASSERT_EQ(particles.size(), count);
    for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(particles[i].position, before[i].position) << i;
    EXPECT_EQ(sides(environment, particles), left);
    test::expect_audited(environment.complex(), particles);
  }
  EXPECT_GT(touching, count);
}

TEST(Replace, OthersGoToTheNearestFreePlaceOrLeave) {
  Random random(8);
  for (int round = 0; round < 6; ++round) {
    Environment environment(mesh_of(blocked_cubes(random), CellType::hexahedron, 1));
    Particles particles;
    add_particles(environment, particles, random);
    const std::vector<ParticleState> before(particles.states().begin(), particles.states().end());
    const Blocked blocked = blocked_cubes(random);
    MeshData mesh = mesh_of(blocked, round % 2 == 0 ? CellType::tetrahedron : CellType::hexahedron, 1);
    // Some that stay would be on the far side of the membrane. It is none here.
    mesh.baffle_tags.clear();
    environment.replace(std::move(mesh));
    Particles others = particles;
    const UpdateReport report = environment.update_after_edit(particles);
    ASSERT_EQ(particles.size(), before.size());
    test::expect_audited(environment.complex(), particles);
    for (const OrphanedParticle& p : report.orphaned) {
      const double least = distance_to_free(before[p.particle].position, blocked);
      EXPECT_NEAR(p.distance, least, 1e-12);
      EXPECT_NEAR(norm(particles[p.particle].position - before[p.particle].position), least, 1e-12);
    }
    const auto without =
        static_cast<std::size_t>(std::count_if(before.begin(), before.end(), [&](const ParticleState& s) {
          return distance_to_free(s.position, blocked) > 0.0;
        }));
    EXPECT_GT(without, 0U);
    EXPECT_EQ(report.orphaned.size(), without);
    environment.update_after_edit(others, OrphanPolicy::absorb);
    EXPECT_EQ(others.size(), before.size() - without);
    test::expect_audited(environment.complex(), others);
  }
}

TEST(Replace, MovesAndStepsGoOn) {
  Random random(9);
  const Blocked blocked = blocked_cubes(random);
  Environment environment(mesh_of(blocked, CellType::hexahedron, 1));
  Particles particles;
  add_particles(environment, particles, random);
  const std::vector<bool> left = sides(environment, particles);
  for (int round = 0; round < 4; ++round) {
    environment.replace(mesh_of(blocked, round % 2 == 0 ? CellType::tetrahedron : CellType::hexahedron, 1, &random));
    EXPECT_THROW(environment.advance(particles, targets_of(particles, random)), InvalidArgument);
    const auto move = [&] {
      std::vector<Vec3> moved(environment.positions().begin(), environment.positions().end());
      for (Vec3& x : moved) x = {x.x, x.y + 0.03 * x.z, x.z};
      environment.move(moved);
    };
    const bool moves_first = round % 2 == 1;
    if (moves_first) move();  // then they follow in the positions before
    environment.update_after_edit(particles);
    if (!moves_first) move();
    environment.advance(particles, targets_of(particles, random));
    test::expect_audited(environment.complex(), particles);
    EXPECT_EQ(sides(environment, particles), left);
    std::vector<Vec3> back(environment.positions().begin(), environment.positions().end());
    for (Vec3& x : back) x = {x.x, std::round(x.y - 0.03 * x.z), x.z};
    environment.move(back);
    environment.advance(particles, targets_of(particles, random));
  }
}

TEST(Replace, WhatCannotFollowIsRefused) {
  Random random(10);
  const Blocked blocked = blocked_cubes(random);
  Environment environment(mesh_of(blocked, CellType::hexahedron, 1));
  Particles particles;
  add_particles(environment, particles, random);
  RectangleOptions plane;
  EXPECT_THROW(environment.replace(generate_rectangle(plane)), InvalidArgument);
  MeshData flat = mesh_of(blocked, CellType::hexahedron, 1);
  for (Vec3& x : flat.points) x.z = 0.0;
  EXPECT_THROW(environment.replace(std::move(flat)), InvalidMesh);
  EXPECT_EQ(environment.edit_count(), 0U);
  environment.advance(particles, targets_of(particles, random));  // nothing has changed
  CellTally tally(environment.complex());
  environment.set_tally(&tally);
  environment.move(std::vector<Vec3>(environment.positions().begin(), environment.positions().end()));
  environment.replace(mesh_of(blocked, CellType::tetrahedron, 1));
  EXPECT_EQ(environment.tally(), nullptr);
  EXPECT_THROW(environment.update_after_edit(particles), InvalidArgument);  // missed the move
  EXPECT_THROW(tally.update_after_edit(environment.complex(), environment.last_edit()), InvalidArgument);
}

}  // namespace dartcast::replace_test
