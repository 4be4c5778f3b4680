// The environment as a program uses it: what it refuses, what it reports, and that nothing is lost.
#include "dartcast/environment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "base/random.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/validity.hpp"
#include "mesh/cell_types.hpp"
#include "support/dyadic.hpp"
#include "support/expectations.hpp"
#include "support/meshes.hpp"
#include "support/particle_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::environment_test {

using test::error_text;
using test::expect_refused;
using test::positions_of;

constexpr double infinity = std::numeric_limits<double>::infinity();
const std::vector<double> bad_numbers = {std::nan(""), infinity, -infinity, 0x1p+301, -0x1p+301};

MeshData box(int n, int which = 1, double blocked = 0.0) {
  BoxOptions o;
  const auto edge = static_cast<std::uint32_t>(n);
  o.cells = {edge, edge, edge};
  o.size = {1.0 * n, 1.0 * n, 1.0 * n};
  o.blocked_share = blocked;
  test::set_kind(o, which);
  return generate_box(o);
}

double& coordinate(Vec3& p, unsigned axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

TEST(EnvironmentRefuses, BadNumbersAtEveryEntryAndNothingChanges) {
  Environment environment(box(3));
  Particles particles;
  Random random(1);
  const std::vector<Vec3> start = test::random_points(20, {0, 0, 0}, {3, 3, 3}, random);
  environment.add(particles, start);
  ASSERT_EQ(particles.size(), 20U);
  const std::vector<ParticleState> before = test::copy_of(particles);
  for (const double bad : bad_numbers) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      std::vector<Vec3> points = start;
      coordinate(points[13], axis) = bad;
      expect_refused([&] { (void)environment.locate(points[13]); }, "point 0");
      expect_refused([&] { (void)environment.locate(points); }, "point 13");
      expect_refused([&] { environment.add(particles, points); }, "point 13");
      expect_refused([&] { environment.advance(particles, points); }, "particle 13");
      EXPECT_TRUE(test::same_bits(before, particles));
    }
  }
  // All is still well.
  EXPECT_TRUE(environment.advance(particles, start).contacts.contacts.empty());
  EXPECT_TRUE(test::same_bits(before, particles));
}

TEST(EnvironmentRefuses, BadPointsOfTheMeshByNumber) {
  for (const double bad : bad_numbers) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      MeshData mesh = box(2);
      coordinate(mesh.points[17], axis) = bad;
      EXPECT_THROW(Environment{mesh}, InvalidMesh);
      EXPECT_NE(error_text([&] { const Environment e(mesh); }).find("17"), std::string::npos)
          << error_text([&] { const Environment e(mesh); });
    }
  }
}

TEST(EnvironmentRefuses, SizesThatDoNotMatch) {
  Environment environment(box(2));
  Particles particles;
  environment.add(particles, std::vector<Vec3>(5, Vec3{0.3, 0.4, 0.5}));
  const std::vector<ParticleState> before = test::copy_of(particles);
  expect_refused([&] { environment.advance(particles, std::vector<Vec3>(4)); }, "4 targets for 5 particles");
  expect_refused([&] { environment.move(std::vector<Vec3>(26)); }, "26 positions for 27 points");
  expect_refused([&] { particles.remove(std::vector<std::uint8_t>(6)); }, "one mark per particle");
  expect_refused([&] { particles.reorder(std::vector<std::uint32_t>{0, 1, 2, 3}); }, "4 indices for 5 particles");
  expect_refused([&] { particles.reorder(std::vector<std::uint32_t>{0, 1, 2, 3, 3}); }, "no permutation");
  expect_refused([&] { particles.reorder(std::vector<std::uint32_t>{0, 1, 2, 3, 5}); }, "names none of the 5");
  EXPECT_TRUE(test::same_bits(before, particles));
}

TEST(EnvironmentRefuses, OptionsThatMakeNoSense) {
  Environment environment(box(2));
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{0.3, 0.4, 0.5}});
  const std::vector<ParticleState> before = test::copy_of(particles);
  const std::vector<Vec3> targets = {{0.6, 0.6, 0.6}};
  for (const double tolerance : {0.0, -1.0, std::nan("")}) {
    StepOptions options;
    options.tolerance = tolerance;
    expect_refused([&] { environment.advance(particles, targets, {}, options); }, "tolerance");
  }
  StepOptions options;
  options.max_slices = 0;
  expect_refused([&] { environment.advance(particles, targets, {}, options); }, "max_slices is 0");
  EXPECT_TRUE(test::same_bits(before, particles));
}

TEST(EnvironmentRefuses, ParticlesThatMissedAMove) {
  const MeshData mesh = box(2);
  Environment environment(mesh);
  Particles early, late;
  const std::vector<Vec3> place = {{0.3, 0.4, 0.5}};
  environment.add(early, place);
  environment.add(late, place);
  environment.move(mesh.points);
  expect_refused([&] { environment.add(late, place); }, "call advance() with them first");
  environment.advance(early, place);
  environment.add(early, place);  // has followed
  EXPECT_EQ(early.size(), 2U);
  environment.move(mesh.points);
  const std::vector<ParticleState> before = test::copy_of(late);
  expect_refused([&] { environment.advance(late, place); }, "missed a move");
  EXPECT_TRUE(test::same_bits(before, late));
  environment.advance(early, positions_of(early));
  Particles fresh;
  environment.add(fresh, place);  // an empty set follows from now on
  environment.advance(fresh, place);
}

TEST(EnvironmentRefuses, MeshesWithDefects) {
  MeshData flat = box(2);
  flat.points[13] = flat.points[14];
  EXPECT_THROW(Environment{flat}, InvalidMesh);
  EXPECT_THROW(Environment{MeshData{}}, InvalidMesh);
  MeshData wrong = box(1);
  wrong.connectivity[3] = 99;
  EXPECT_THROW(Environment{wrong}, InvalidMesh);
}

TEST(EnvironmentRefuses, ResponsesThatAreNotFinite) {
  for (const double bad : {std::nan(""), infinity, -infinity}) {
    for (const bool moved : {false, true}) {
      const MeshData mesh = box(2);
      Environment environment(mesh);
      Particles particles;
      environment.add(particles, std::vector<Vec3>{{1.5, 1.5, 1.5}, {0.3, 0.4, 0.5}});
      const std::vector<ParticleState> before = test::copy_of(particles);
      if (moved) environment.move(mesh.points);
      const std::vector<Vec3> targets = {{1.6, 1.6, 1.6}, {-2, 0.4, 0.5}};
      AfterContact next{{0.1, bad, 0}, true};
      const ContactCallback respond = [&](const Contact&, std::span<const WallHit>, std::span<const WallHit>) {
        return next;
      };
      expect_refused([&] { environment.advance(particles, targets, respond); }, "particle 1");
      EXPECT_TRUE(test::same_bits(before, particles));
      next = {{0.25, 0, 0}, true};
      environment.advance(particles, targets, respond);
      EXPECT_EQ(particles[0].position, targets[0]);
      EXPECT_EQ(particles[1].position, (Vec3{0.25, 0.4, 0.5}));
      EXPECT_EQ(test::check_states(environment, particles), "");
    }
  }
}

// No test can be made out of the exact range.
TEST(EnvironmentStops, WhereAResponseLeadsOutOfTheExactRange) {
  for (const bool moved : {false, true}) {
    const MeshData mesh = box(2);
    Environment environment(mesh);
    Particles particles;
    environment.add(particles, std::vector<Vec3>{{1.5, 1.5, 1.5}, {0.3, 0.4, 0.5}});
    if (moved) environment.move(mesh.points);
    const auto respond = [](const Contact&, auto, auto) { return AfterContact{{0.1, 0x1p+302, 0}, true}; };
    const StepReport report =
        environment.advance(particles, std::vector<Vec3>{{1.6, 1.6, 1.6}, {-2, 0.4, 0.5}}, respond);
    ASSERT_EQ(report.stopped.size(), 1U);
    EXPECT_EQ(report.stopped[0].particle, 1U);
    EXPECT_EQ(report.counters.unfinished, 1U);
    EXPECT_EQ(particles[1].position, (Vec3{0.0, 0.4, 0.5}));
    EXPECT_EQ(test::check_states(environment, particles), "");
  }
}

// --- locating and adding

bool on_segment(const Vec3& a, const Vec3& b, const Vec3& x) {
  const Vec3 c = cross(b - a, x - a);
  return c == Vec3{} && dot(x - a, x - b) <= 0.0;
}

// Where x is in one cell of a lattice, by plain arithmetic that is exact there; nothing if outside.
std::optional<Kind> kind_in(const MeshData& mesh, std::size_t c, const Vec3& x) {
  bool inside = true;
  Kind kind = Kind::volume;
  for_each_face(mesh, c, [&](std::span<const std::uint32_t> f) {
    const Vec3& a = mesh.points[f[0]];
    const double side = dot(cross(mesh.points[f[1]] - a, mesh.points[f[2]] - a), x - a);
    inside = inside && side <= 0.0;
    if (side == 0.0) kind = std::min(kind, Kind::face);
    for (std::size_t i = 0; i < f.size(); ++i) {
      const Vec3& p = mesh.points[f[i]];
      if (on_segment(p, mesh.points[f[(i + 1) % f.size()]], x))
        kind = std::min(kind, p == x ? Kind::vertex : Kind::edge);
      if (p == x) kind = Kind::vertex;
    }
  });
  if (!inside) return {};
  return kind;
}

TEST(EnvironmentLocate, EveryKindOfPlaceOnLattices) {
  for (int which = 0; which < 5; ++which) {
    const MeshData mesh = box(3, which, 0.4);
    Environment environment(mesh);
    const CombinatorialMap& map = environment.map();
    std::vector<Vec3> points;
    for (int k = -1; k <= 13; ++k) {
      for (int j = -1; j <= 13; ++j) {
        for (int i = -1; i <= 13; i += test::sanitized() ? 5 : 1) points.push_back({i / 4.0, j / 4.0, k / 4.0});
      }
    }
    const std::vector<Location> locations = environment.locate(points);
    std::set<std::pair<Place, Kind>> seen;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Location& at = locations[i];
      Place place = Place::outside;
      Kind kind = Kind::volume;
      for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
        const auto here = kind_in(mesh, c, points[i]);
        if (!here) continue;
        kind = *here;
        if (mesh.free[c] != 0) place = Place::free;
        if (place == Place::outside) place = Place::blocked;
      }
      ASSERT_EQ(at.place, place) << which << ": " << points[i].x << " " << points[i].y << " " << points[i].z;
      seen.insert({at.place, at.kind});
      if (place == Place::outside) {
        EXPECT_FALSE(at.simplex.valid());
        continue;
      }
      ASSERT_EQ(at.kind, kind) << which << ": " << points[i].x << " " << points[i].y << " " << points[i].z;
      EXPECT_EQ(map.is_free(at.simplex.cell), place == Place::free);
      ASSERT_TRUE(kind_in(mesh, map.source(at.simplex.cell), points[i]));
      ASSERT_EQ(at.dart.valid(), kind != Kind::volume);
      if (kind == Kind::volume) continue;
      const Vec3& a = mesh.points[map.origin(at.dart).value];
      const Vec3& b = mesh.points[map.origin(map.phi1(at.dart)).value];
      const Vec3& c = mesh.points[map.origin(map.phi_1(at.dart)).value];
      EXPECT_EQ(at.dart.cell, at.simplex.cell);
      if (kind == Kind::vertex) EXPECT_EQ(a, points[i]);
      if (kind == Kind::edge) EXPECT_TRUE(on_segment(a, b, points[i]));
      if (kind == Kind::face) EXPECT_EQ(dot(cross(b - a, c - a), points[i] - a), 0.0);
    }
    EXPECT_GE(seen.size(), 7U);  // every kind in free cells, most in blocked ones, and outside
  }
}

TEST(Environment, AddReportsWhatItDoesNotAdd) {
  MeshData mesh = box(3);
  mesh.free.assign(27, 1);
  mesh.free[13] = 0;  // the middle
  Environment environment(mesh);
  Particles particles;
  const std::vector<Vec3> places = {{0.5, 0.5, 0.5}, {1.5, 1.5, 1.5}, {4, 0, 0}, {1, 1, 1}, {1.5, 1.5, 1}, {3, 3, 3}};
  const std::vector<AddResult> added = environment.add(particles, places);
  ASSERT_EQ(added.size(), places.size());
  const std::vector<Place> expected = {Place::free, Place::blocked, Place::outside,
                                       Place::free, Place::free,    Place::free};
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_EQ(added[i].location.place, expected[i]) << i;
    const bool taken = expected[i] == Place::free;
    EXPECT_EQ(added[i].particle, taken ? next : 0xffffffffU);
    if (taken) EXPECT_EQ(particles[next++].position, places[i]);
  }
  EXPECT_EQ(particles.size(), 4U);
  EXPECT_EQ(added[3].location.kind, Kind::vertex);
  EXPECT_EQ(added[4].location.kind, Kind::face);
  EXPECT_EQ(test::check_states(environment, particles), "");
}

// Where the caller names the simplex, it is taken at his word only as far as exact signs bear him out.
TEST(Environment, AddsAtASimplexOnlyWhatLiesInIt) {
  MeshData mesh = box(3);
  mesh.free.assign(27, 1);
  mesh.free[13] = 0;
  Environment environment(mesh);
  const std::vector<Vec3> places = {{0.3, 0.4, 0.45}, {1, 1, 1}, {2.5, 2.5, 2.5}, {1.5, 1.5, 1.4}};
  Particles particles;
  for (const Vec3& x : places) {
    const Location at = environment.locate(x);
    std::size_t taken = 0;
    for (const Cell c : environment.map().cells()) {
      for (std::uint16_t s = 0; s < environment.map().shape(c).simplices().size(); ++s) {
        const std::size_t before = particles.size();
        const bool added = environment.add(particles, SimplexId{c, s}, x);
        ASSERT_EQ(particles.size(), before + (added ? 1 : 0));
        taken += added ? 1 : 0;
        if (SimplexId{c, s} == at.simplex) EXPECT_EQ(added, at.place == Place::free);
      }
    }
    EXPECT_EQ(taken > 0, at.place == Place::free);
    if (at.kind == Kind::volume) EXPECT_LE(taken, 6U);
  }
  EXPECT_EQ(test::check_states(environment, particles), "");
  const SimplexId first = environment.locate(places[0]).simplex;
  const std::size_t size = particles.size();
  for (const double bad : bad_numbers) {
    EXPECT_FALSE(environment.add(particles, first, {places[0].x, bad, places[0].z}));
  }
  EXPECT_FALSE(environment.add(particles, SimplexId{first.cell, 6}, places[0]));
  EXPECT_FALSE(environment.add(particles, SimplexId{}, places[0]));
  EXPECT_EQ(particles.size(), size);
  environment.move(mesh.points);
  EXPECT_THROW(environment.add(particles, first, places[0]), InvalidArgument);
}

TEST(Environment, RemoveAndReorderKeepTheRest) {
  Environment environment(box(2));
  Particles particles;
  Random random(9);
  environment.add(particles, test::random_points(6, {0, 0, 0}, {2, 2, 2}, random));
  const std::vector<ParticleState> before = test::copy_of(particles);
  particles.reorder(std::vector<std::uint32_t>{5, 3, 1, 0, 2, 4});
  for (const auto& [now, then] : {std::pair{0, 5}, {1, 3}, {2, 1}, {3, 0}, {4, 2}, {5, 4}}) {
    EXPECT_TRUE(test::same_bits(particles[static_cast<std::size_t>(now)], before[static_cast<std::size_t>(then)]));
  }
  Particles first = particles;
  first.truncate(9);
  EXPECT_EQ(first.size(), 6U);
  first.truncate(2);
  ASSERT_EQ(first.size(), 2U);
  EXPECT_TRUE(test::same_bits(first[1], before[3]));
  EXPECT_EQ(environment.advance(first, std::vector<Vec3>(2, Vec3{1, 1, 1})).counters.particle_steps, 2U);
  particles.remove(std::vector<std::uint8_t>{0, 1, 0, 1, 1, 0});
  ASSERT_EQ(particles.size(), 3U);
  EXPECT_TRUE(test::same_bits(particles[0], before[5]));
  EXPECT_TRUE(test::same_bits(particles[1], before[1]));
  EXPECT_TRUE(test::same_bits(particles[2], before[4]));
  environment.advance(particles, std::vector<Vec3>(3, Vec3{1, 1, 1}));
  for (const ParticleState& s : particles.states()) EXPECT_EQ(s.position, (Vec3{1, 1, 1}));
  particles.remove(std::vector<std::uint8_t>{1, 1, 1});
  EXPECT_EQ(environment.advance(particles, {}).counters.particle_steps, 0U);
}

// --- stepping

TEST(Environment, WithoutAResponseAParticleStopsAtTheWall) {
  Environment environment(box(2));
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{0.5, 0.75, 0.5}, {0.5, 0.5, 0.5}, {1, 1, 0.5}});
  const std::vector<Vec3> targets = {{2.5, 0.75, 0.5}, {1.5, 1.5, 1.5}, {3, 3, 0.5}};
  const StepReport report = environment.advance(particles, targets);
  EXPECT_EQ(particles[0].position, (Vec3{2, 0.75, 0.5}));
  EXPECT_EQ(particles[1].position, targets[1]);
  EXPECT_EQ(particles[2].position, (Vec3{2, 2, 0.5}));
  ASSERT_EQ(report.stopped.size(), 2U);
  EXPECT_EQ(report.stopped[0].particle, 0U);
  EXPECT_EQ(report.stopped[0].unused, (Vec3{0.5, 0, 0}));
  EXPECT_EQ(report.stopped[1].particle, 2U);
  EXPECT_EQ(report.stopped[1].unused, (Vec3{1, 1, 0}));
  ASSERT_EQ(report.contacts.contacts.size(), 2U);
  const Contact& face = report.contacts.contacts[0];
  EXPECT_EQ(face.kind, Kind::face);
  EXPECT_EQ(face.time_of_impact, 0.75);
  EXPECT_EQ(face.point, (Vec3{2, 0.75, 0.5}));
  EXPECT_EQ(face.displacement, (Vec3{2, 0, 0}));
  EXPECT_EQ(face.wall_displacement, Vec3{});
  ASSERT_EQ(face.wall_count, 1U);
  const WallHit& wall = report.contacts.walls_of(face)[0];
  EXPECT_EQ(wall.normal, (Vec3{-1, 0, 0}));
  EXPECT_EQ(wall.patch, environment.map().patch("xmax"));
  const Contact& edge = report.contacts.contacts[1];
  EXPECT_EQ(edge.kind, Kind::edge);
  EXPECT_EQ(edge.time_of_impact, 0.5);
  std::set<std::uint16_t> patches;
  for (const WallHit& w : report.contacts.walls_of(edge)) patches.insert(w.patch.value);
  EXPECT_EQ(patches,
            (std::set<std::uint16_t>{environment.map().patch("xmax").value, environment.map().patch("ymax").value}));
  EXPECT_EQ(report.counters.contacts, (std::array<std::uint64_t, 3>{0, 1, 1}));
  EXPECT_EQ(report.counters.particle_steps, 3U);
  EXPECT_EQ(report.counters.unfinished, 0U);
  EXPECT_TRUE(report.held.empty());
  // Pressed on against the wall: it stays, in contact at time 0; then it leaves.
  const StepReport pressed = environment.advance(particles, targets);
  EXPECT_EQ(particles[0].position, (Vec3{2, 0.75, 0.5}));
  EXPECT_EQ(pressed.contacts.contacts[0].time_of_impact, 0.0);
  const StepReport away = environment.advance(particles, std::vector<Vec3>(3, Vec3{1.25, 1, 1}));
  EXPECT_TRUE(away.contacts.contacts.empty());
  EXPECT_EQ(particles[0].touching_count, 0);
}

TEST(Environment, PolylinesAreStepsOneAfterAnother) {
  Environment environment(box(4, 4));
  Particles particles;
  Random random(12);
  environment.add(particles, test::random_points(50, {0, 0, 0}, {4, 4, 4}, random));
  for (int corner = 0; corner < 20; ++corner) {
    const std::vector<Vec3> targets = test::random_points(50, {0, 0, 0}, {4, 4, 4}, random);
    EXPECT_TRUE(environment.advance(particles, targets).stopped.empty());
    EXPECT_TRUE(positions_of(particles) == targets);
    ASSERT_EQ(test::check_states(environment, particles), "");
  }
}

// --- invalid cells

// One particle in the middle of every simplex.
void fill(Environment& environment, Particles& particles) {
  std::vector<Vec3> middles;
  for (const Cell c : environment.map().cells()) {
    for (std::uint16_t s = 0; s < environment.map().shape(c).simplices().size(); ++s) {
      const Corners v = environment.complex().corners({c, s});
      middles.push_back((v[0] + v[1] + v[2] + v[3]) * 0.25);
    }
  }
  environment.add(particles, middles);
}

bool has_vertex(const Environment& environment, const ParticleState& s, std::uint32_t vertex) {
  const auto v = environment.complex().vertices(s.at());
  return std::any_of(v.begin(), v.end(), [&](Vertex x) { return x.value == vertex; });
}

TEST(EnvironmentHolds, ParticlesThatMeetAVertexThatIsNotFinite) {
  for (int which = 0; which < 5; ++which) {
    for (const double bad : {std::nan(""), infinity, 0x1p+320}) {
      const MeshData mesh = box(3, which);
      Environment environment(mesh);
      Particles particles;
      fill(environment, particles);
      constexpr std::uint32_t vertex = 21;  // of the lattice, inside
      std::vector<bool> meets;
      for (const ParticleState& s : particles.states()) meets.push_back(has_vertex(environment, s, vertex));
      const std::vector<ParticleState> before = test::copy_of(particles);

      std::vector<Vec3> points = mesh.points;
      points[vertex].y = bad;
      for (int again = 0; again < 3; ++again) {
        environment.move(points);
        const StepReport report = environment.advance(particles, positions_of(particles));
        std::set<std::uint32_t> held;
        for (const HeldParticle& h : report.held) {
          held.insert(h.particle);
          EXPECT_EQ(h.cell, before[h.particle].cell);
        }
        for (std::uint32_t i = 0; i < particles.size(); ++i) {
          EXPECT_EQ(held.contains(i), meets[i]);
          EXPECT_EQ(particles[i].held, meets[i]);
          EXPECT_TRUE(is_finite(particles[i].position)) << "targets made from positions must be good";
          if (!meets[i]) EXPECT_TRUE(test::same_bits(particles[i], before[i]));
        }
        EXPECT_FALSE(environment.validity().valid());
        ASSERT_EQ(test::check_states(environment, particles), "");
      }
      // Mended: all go on, and nobody has lost its place.
      environment.move(mesh.points);
      EXPECT_TRUE(environment.advance(particles, positions_of(particles)).held.empty());
      for (std::uint32_t i = 0; i < particles.size(); ++i) {
        EXPECT_FALSE(particles[i].held);
        EXPECT_LT(norm(particles[i].position - before[i].position), 1e-12) << i;
      }
      ASSERT_EQ(test::check_states(environment, particles), "");
      const std::vector<Vec3> targets(particles.size(), Vec3{1.25, 1.5, 1.125});
      EXPECT_TRUE(environment.advance(particles, targets).stopped.empty());
      EXPECT_TRUE(positions_of(particles) == targets);
    }
  }
}

TEST(EnvironmentHolds, AParticleOnItsWayIntoAnInvalidCellWaitsBeforeIt) {
  BoxOptions o;
  o.cells = {4, 1, 1};
  o.size = {4, 1, 1};
  const MeshData mesh = generate_box(o);
  Environment environment(mesh);
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{0.5, 0.25, 0.5}, {0.5, 0.25, 0.625}});
  std::vector<Vec3> points = mesh.points;
  for (const std::size_t i : {3U, 8U, 13U, 18U}) points[i].x = std::nan("");  // cells 2 and 3
  environment.move(points);
  const std::vector<Vec3> targets = {{3.5, 0.25, 0.5}, {0.75, 0.25, 0.625}};
  const StepReport report = environment.advance(particles, targets);
  ASSERT_EQ(report.held.size(), 1U);
  EXPECT_EQ(report.held[0].particle, 0U);
  EXPECT_EQ(environment.map().source(report.held[0].cell), 2U);
  EXPECT_FALSE(particles[0].held);  // its own simplex is good
  EXPECT_EQ(particles[0].position, (Vec3{0.5, 0.25, 0.5}));
  EXPECT_EQ(particles[1].position, targets[1]);
  environment.move(mesh.points);
  EXPECT_TRUE(environment.advance(particles, targets).held.empty());
  EXPECT_TRUE(positions_of(particles) == targets);
  EXPECT_EQ(test::check_states(environment, particles), "");
}

TEST(EnvironmentHolds, ParticlesOfAnInvertedCellAreCarriedAlong) {
  for (int which = 0; which < 5; ++which) {
    const MeshData mesh = box(3, which);
    Environment environment(mesh);
    Particles particles;
    fill(environment, particles);
    const std::vector<ParticleState> before = test::copy_of(particles);
    constexpr std::uint32_t vertex = 21;
    std::vector<Vec3> points = mesh.points;
    points[vertex] += Vec3{1.75, 0.125, 0.25};  // through the cells on one side
    environment.move(points);
    const StepReport report = environment.advance(particles, positions_of(particles));
    std::set<std::uint32_t> held;
    for (const HeldParticle& h : report.held) held.insert(h.particle);
    std::size_t inverted = 0;
    for (std::uint32_t i = 0; i < particles.size(); ++i) {
      const Corners v = environment.complex().corners(before[i].at());
      const bool positive = test::exact_sign(v[0], v[1], v[2], v[3]) > 0;
      inverted += positive ? 0 : 1;
      EXPECT_EQ(particles[i].held, !positive) << i;
      if (positive) continue;
      EXPECT_TRUE(held.contains(i));
      EXPECT_EQ(particles[i].at(), before[i].at());
      EXPECT_LT(norm(particles[i].position - (v[0] + v[1] + v[2] + v[3]) * 0.25), 1e-12) << "rides along";
    }
    EXPECT_GT(inverted, 0U);
    EXPECT_EQ(test::check_states(environment, particles), "");
    // Not moved again: still held, wherever it wants to go.
    const std::vector<Vec3> targets(particles.size(), Vec3{0.125, 0.25, 0.125});
    const std::vector<ParticleState> waiting = test::copy_of(particles);
    environment.advance(particles, targets);
    for (std::uint32_t i = 0; i < particles.size(); ++i) {
      if (waiting[i].held) EXPECT_TRUE(test::same_bits(particles[i], waiting[i]));
    }
    // Valid again. A step taken in parts leads through the invalid cells once more, so some particles are
    // only carried with the mesh.
    environment.move(mesh.points);
    const StepReport mended = environment.advance(particles, targets);
    EXPECT_LT(mended.held.size(), inverted);
    for (const ParticleState& s : particles.states()) EXPECT_FALSE(s.held);
    ASSERT_EQ(test::check_states(environment, particles), "");
    EXPECT_TRUE(environment.advance(particles, targets).held.empty());
    EXPECT_TRUE(positions_of(particles) == targets);
    EXPECT_EQ(test::check_states(environment, particles), "");
  }
}

// In the step that mends a vertex its old position is still no number: the wall's motion at a contact must not be one
// either.
TEST(EnvironmentHolds, AContactInTheStepThatMends) {
  const MeshData mesh = box(2);
  Environment environment(mesh);
  Particles particles;
  fill(environment, particles);
  std::vector<Vec3> points = mesh.points;
  for (const std::size_t corner : {0U, 2U, 6U, 8U, 18U, 20U, 24U, 26U}) points[corner].z = std::nan("");
  environment.move(points);
  const StepReport held = environment.advance(particles, positions_of(particles));
  ASSERT_GT(held.held.size(), 8U);
  environment.move(mesh.points);
  std::vector<Vec3> targets = positions_of(particles);
  for (Vec3& t : targets) t += (t - Vec3{1, 1, 1}) * 4.0;
  const ContactCallback back = [](const Contact& c, std::span<const WallHit>, std::span<const WallHit>) {
    return AfterContact{c.unused * -0.125};
  };
  const StepReport report = environment.advance(particles, targets, back);
  EXPECT_TRUE(report.held.empty());
  EXPECT_GE(report.contacts.contacts.size(), particles.size());
  for (const Contact& c : report.contacts.contacts) {
    EXPECT_TRUE(is_finite(c.wall_displacement));
    EXPECT_TRUE(is_finite(c.unused));
    EXPECT_TRUE(is_finite(c.displacement));
  }
  EXPECT_EQ(test::check_states(environment, particles), "");
}

TEST(Environment, ValidityOfTheScene) {
  const MeshData mesh = box(3);
  Environment environment(mesh);
  EXPECT_TRUE(environment.validity().valid());
  std::vector<Vec3> points = mesh.points;
  points[0] = {2, 2, 2};
  environment.move(points);
  const Validity validity = environment.validity();
  EXPECT_EQ(validity.invalid_count, 1U);
  EXPECT_EQ(environment.map().source(validity.first[0].cell), 0U);
  EXPECT_EQ(environment.locate({0.5, 0.5, 0.5}).place, Place::outside);  // a cell that is invalid holds no point
  EXPECT_EQ(environment.locate({1.5, 0.5, 0.5}).place, Place::free);
}

}  // namespace dartcast::environment_test
