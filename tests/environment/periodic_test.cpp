// Periodic pairs of patches. The truth is the same mesh many times over, side by side, without pairs.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "complex/periodic_faces.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/response.hpp"
#include "support/expectations.hpp"
#include "support/periodic_meshes.hpp"
#include "support/tier.hpp"

namespace dartcast::periodic_test {

using test::periodic_box;
using test::repeated;

// A multiple of 2^-30 in [low, high). Every fourth is a whole number, and every fourth one a multiple of 1/4.
double lattice(Random& random, int low, int high) {
  const auto width = static_cast<std::uint32_t>(high - low);
  switch (random.below(4)) {
    case 0: return low + static_cast<double>(random.below(width));
    case 1: return low + random.below(4 * width) * 0.25;
    default: return low + static_cast<double>(random.next() % (std::uint64_t{width} << 30U)) * 0x1p-30;
  }
}

// The images of each particle since the start, by axis.
using Images = std::vector<std::array<int, 3>>;

void count_images(const ContactList& list, Images& images) {
  for (const PeriodicCrossing& c : list.crossings) images[c.particle][c.pair] += c.back ? -1 : 1;
}

// Particles at free places of a box, and the same ones in the middle of its copies.
struct Twins {
  Twins(MeshData box, const std::array<std::uint32_t, 3>& cubes, const std::array<int, 3>& copies_each_way)
      : cells(static_cast<std::uint32_t>(box.cell_count())),
        size{static_cast<double>(cubes[0]), static_cast<double>(cubes[1]), static_cast<double>(cubes[2])},
        low{-copies_each_way[0], -copies_each_way[1], -copies_each_way[2]},
        high(copies_each_way),
        all(repeated(box, size, low, high)),
        one(std::move(box)) {}

  void add(std::span<const Vec3> places) {
    for (const Vec3& x : places) {
      const Location here = one.locate(x);
      const Location there = all.locate(x);
      if (here.place != Place::free || there.place != Place::free) continue;
      // Walls may part the cells at a point of the border: both must start in the same one.
      if (one.map().source(here.simplex.cell) + first() != all.map().source(there.simplex.cell)) continue;
      one.add(ones, {&x, 1});
      all.add(alls, {&x, 1});
    }
    images.assign(ones.size(), {});
  }

  // The first cell of the copy that is not moved.
  [[nodiscard]] std::uint32_t first() const {
    const auto wide = [&](std::size_t a) { return high[a] - low[a] + 1; };
    return cells * static_cast<std::uint32_t>(-low[0] + wide(0) * (-low[1] + wide(1) * -low[2]));
  }
  [[nodiscard]] Vec3 unwrapped(std::size_t i) const {
    const auto& n = images[i];
    return ones[i].position + Vec3{n[0] * size.x, n[1] * size.y, n[2] * size.z};
  }
  // The cell of the box that a particle of the copies is in.
  [[nodiscard]] std::uint32_t cell_of_all(Cell c) const { return all.map().source(c) % cells; }

  std::uint32_t cells;
  Vec3 size;
  std::array<int, 3> low, high;
  Environment all, one;
  Particles ones, alls;
  Images images;
};

std::vector<Vec3> lattice_points(Random& random, const std::array<std::uint32_t, 3>& cubes, std::size_t count) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 x{lattice(random, 0, static_cast<int>(cubes[0]) + 1), lattice(random, 0, static_cast<int>(cubes[1]) + 1),
           lattice(random, 0, static_cast<int>(cubes[2]) + 1)};
    x = {std::min<double>(x.x, cubes[0]), std::min<double>(x.y, cubes[1]), std::min<double>(x.z, cubes[2])};
    points.push_back(x);
  }
  return points;
}

// Every step starts and ends on the lattice. Both ways must end at the same bits, and in the same cell if the end is in
// the interior of one.
void expect_same_bits(bool shaken, CellType type, std::size_t particles, unsigned steps, std::uint64_t seed) {
  const std::array<std::uint32_t, 3> cubes = {2, 1, 2};
  MeshData box = periodic_box({.cells = cubes, .type = type}, 3);
  if (shaken) test::shake(box, cubes, seed);
  Twins twins(std::move(box), cubes, {2, 2, 2});
  Random random(seed);
  twins.add(lattice_points(random, cubes, particles));
  ASSERT_GT(twins.ones.size(), particles / 4);
  std::uint64_t crossings = 0;
  for (unsigned step = 0; step < steps; ++step) {
    // Both start in the first copy: there the steps are multiples of 2^-30, too.
    std::vector<Vec3> starts(twins.ones.size());
    for (std::size_t i = 0; i < starts.size(); ++i) starts[i] = twins.ones[i].position;
    twins.alls = Particles();
    ASSERT_EQ(twins.all.add(twins.alls, starts).size(), starts.size());
    twins.images.assign(starts.size(), {});
    std::vector<Vec3> targets;
    for (const Vec3& p : starts)
      targets.push_back(p + Vec3{lattice(random, -3, 4), lattice(random, -1, 2), lattice(random, -3, 4)});
    const StepReport one = twins.one.advance(twins.ones, targets);
    const StepReport all = twins.all.advance(twins.alls, targets);
    ASSERT_TRUE(one.contacts.contacts.empty() && one.held.empty() && one.stopped.empty());
    ASSERT_TRUE(all.contacts.contacts.empty() && all.held.empty());
    crossings += one.contacts.crossings.size();
    count_images(one.contacts, twins.images);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      ASSERT_EQ(twins.unwrapped(i), targets[i]) << "particle " << i << " step " << step;
      ASSERT_EQ(twins.alls[i].position, targets[i]);
      const Location end = twins.all.locate(targets[i]);
      if (end.kind != Kind::volume) continue;
      ASSERT_EQ(twins.one.map().source(twins.ones[i].cell), twins.cell_of_all(twins.alls[i].cell)) << "particle " << i;
    }
    test::expect_audited(twins.one.complex(), twins.ones);
  }
  EXPECT_GT(crossings, twins.ones.size() * steps / 4);
}

TEST(Periodic, LatticeStepsEndAtTheBitsOfARepeatedBox) {
  const std::size_t particles = test::scaled<std::size_t>(1000, 50000);
  expect_same_bits(false, CellType::hexahedron, particles, 10, 1);
  expect_same_bits(true, CellType::tetrahedron, particles, 10, 2);
}

// Steps from and to the lattice among obstacles that reach the border. They stop at the first wall: at the same one, at the
// same time.
TEST(Periodic, LatticeStepsStopAtTheWallsOfARepeatedBox) {
  const std::array<std::uint32_t, 3> cubes = {3, 2, 2};
  Random random(4);
  std::size_t contacts = 0;
  for (std::uint64_t seed = 1; seed <= test::scaled<std::uint64_t>(4, 100); ++seed) {
    const CellType type = seed % 2 == 0 ? CellType::hexahedron : CellType::tetrahedron;
    Twins twins(periodic_box({.cells = cubes, .type = type, .blocked_share = 0.4, .seed = seed}, 3), cubes, {2, 2, 2});
    twins.add(lattice_points(random, cubes, test::scaled<std::size_t>(1000, 2000)));
    std::vector<Vec3> targets;
    for (std::size_t i = 0; i < twins.ones.size(); ++i)
      targets.push_back(twins.ones[i].position +
                        Vec3{lattice(random, -3, 4), lattice(random, -2, 3), lattice(random, -2, 3)});
    const StepReport one = twins.one.advance(twins.ones, targets);
    const StepReport all = twins.all.advance(twins.alls, targets);
    count_images(one.contacts, twins.images);
    for (const WallHit& wall : one.contacts.walls)
      ASSERT_EQ(twins.one.complex().periodic()->partner(wall.face), nullptr) << "seed " << seed;
    contacts += all.contacts.contacts.size();
    std::vector<double> times(targets.size(), 1.0), others(targets.size(), 1.0);
    std::vector<bool> grazes(targets.size());  // the shift decides, which is chosen anew at each crossing
    const auto note = [&](const ContactList& list, std::vector<double>& time) {
      for (const Contact& c : list.contacts) {
        time[c.particle] = c.time_of_impact;
        if (c.kind != Kind::face && c.time_of_impact > 0.0 && c.time_of_impact < 1.0) grazes[c.particle] = true;
      }
    };
    note(one.contacts, times);
    note(all.contacts, others);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      if (grazes[i]) continue;
      EXPECT_NEAR(times[i], others[i], 1e-9) << "seed " << seed << " particle " << i;
      EXPECT_LT(norm(twins.unwrapped(i) - twins.alls[i].position), 1e-9) << "seed " << seed << " particle " << i;
    }
    test::expect_audited(twins.one.complex(), twins.ones);
  }
  EXPECT_GT(contacts, test::sanitized() ? 10U : 100U);
}

// A quarter of a square, whose sides at the axis are a pair, and the whole square.
Vec3 quarter_turns(Vec3 x, int count) {
  for (int i = 0; i < ((count % 4) + 4) % 4; ++i) x = {-x.y, x.x, x.z};
  return x;
}

TEST(Periodic, QuarterTurnsEndAtTheBitsOfAWholeSquare) {
  MeshData quarter = generate_box({.cells = {2, 2, 1}});
  quarter.periodic.push_back({"ymin", "xmin", {}, {0.0, 0.0, 3.0}, {0.0, 0.0, 7.0}, 90.0});
  quarter.periodic.push_back({"zmax", "zmin", {0.0, 0.0, -1.0}});
  MeshData whole = generate_box({.cells = {4, 4, 1}, .origin = {-2.0, -2.0, 0.0}});
  whole.periodic.push_back({"zmax", "zmin", {0.0, 0.0, -1.0}});
  Environment part(std::move(quarter));
  Environment all(std::move(whole));
  Random random(3);
  std::vector<Vec3> starts;
  for (std::size_t i = 0; i < test::scaled<std::size_t>(1000, 50000); ++i)
    starts.push_back({lattice(random, 0, 2), lattice(random, 0, 2), lattice(random, 0, 1)});
  Particles ones, alls;
  part.add(ones, starts);
  all.add(alls, starts);
  ASSERT_EQ(ones.size(), starts.size());
  ASSERT_EQ(alls.size(), starts.size());
  std::vector<int> turns(starts.size());
  for (int step = 0; step < 10; ++step) {
    std::vector<Vec3> near, far;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      const Vec3 q{0.5 * lattice(random, -3, 4), 0.5 * lattice(random, -3, 4),
                   alls[i].position.z + lattice(random, -1, 2)};
      far.push_back(q);
      near.push_back(quarter_turns(q, turns[i]));
    }
    const StepReport report = part.advance(ones, near);
    all.advance(alls, far);
    ASSERT_TRUE(report.contacts.contacts.empty() && report.held.empty() && report.stopped.empty());
    for (const PeriodicCrossing& c : report.contacts.crossings) {
      if (c.pair != 0) continue;
      turns[c.particle] += c.back ? -1 : 1;
      const Vec3 turned = quarter_turns({1.0, 2.0, 3.0}, c.back ? -1 : 1);
      const Vec3 v = {1.0, 2.0, 3.0};
      const Vec3 by_rows = {dot(c.turn[0], v), dot(c.turn[1], v), dot(c.turn[2], v)};
      ASSERT_EQ(by_rows, turned);
    }
    for (std::size_t i = 0; i < starts.size(); ++i)
      ASSERT_EQ(quarter_turns(ones[i].position, -turns[i]), alls[i].position) << "particle " << i << " step " << step;
    test::expect_audited(part.complex(), ones);
  }
}

// A wedge of 30 degrees around z, with prisms at the axis, stands for a cylinder of twelve sides. Ways are straight there,
// through the axis, too.
TEST(Periodic, WedgesStandForAFullTurn) {
  MeshData wedge;
  constexpr double ring[] = {1.0, 2.0};
  const double cosine = std::cos(std::numbers::pi / 12.0);
  const double sine = std::sin(std::numbers::pi / 12.0);
  for (const double z : {0.0, 1.0}) {
    wedge.points.push_back({0.0, 0.0, z});
    for (const double r : ring) {
      wedge.points.push_back({r * cosine, -r * sine, z});
      wedge.points.push_back({r * cosine, r * sine, z});
    }
  }
  wedge.add_cell(CellType::prism, std::array<std::uint32_t, 6>{0, 1, 2, 5, 6, 7});
  wedge.add_cell(CellType::hexahedron, std::array<std::uint32_t, 8>{1, 3, 4, 2, 6, 8, 9, 7});
  wedge.patch_names = {{1, "front"}, {2, "back"}};
  wedge.add_patch_face(std::array<std::uint32_t, 4>{0, 1, 6, 5}, 1);
  wedge.add_patch_face(std::array<std::uint32_t, 4>{1, 3, 8, 6}, 1);
  wedge.add_patch_face(std::array<std::uint32_t, 4>{0, 5, 7, 2}, 2);
  wedge.add_patch_face(std::array<std::uint32_t, 4>{2, 7, 9, 4}, 2);
  wedge.periodic.push_back({"front", "back", {}, {0.0, 0.0, 1.0}, {}, 30.0});
  Environment environment(std::move(wedge));
  EXPECT_EQ(environment.complex().periodic()->face_count(0), 2U);
  Random random(7);
  std::vector<Vec3> starts(400), ends(400);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    starts[i] = {random.uniform(0.1, 1.5), 0.0, 0.5};
    const Vec3 through_axis{-starts[i].x, 0.0, random.uniform(0.1, 0.9)};
    ends[i] = i % 4 == 0 ? through_axis
                         : Vec3{random.uniform(-1.3, 1.3), random.uniform(-1.3, 1.3), random.uniform(0.1, 0.9)};
  }
  Particles particles;
  environment.add(particles, starts);
  ASSERT_EQ(particles.size(), starts.size());
  const StepReport report = environment.advance(particles, ends);
  EXPECT_TRUE(report.contacts.contacts.empty() && report.held.empty() && report.stopped.empty());
  for (const PeriodicCrossing& c : report.contacts.crossings)
    ends[c.particle] = {dot(c.turn[0], ends[c.particle]), dot(c.turn[1], ends[c.particle]), ends[c.particle].z};
  for (std::size_t i = 0; i < ends.size(); ++i) EXPECT_LT(norm(particles[i].position - ends[i]), 1e-12) << i;
  EXPECT_GT(report.contacts.crossings.size(), starts.size());
  test::expect_audited(environment.complex(), particles);
  // Ways that end a hair behind a face cross it once: rounding does not lead them out again.
  Particles close;
  environment.add(close, starts);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const double r = random.uniform(0.1, 1.9);
    const double hair = random.below(8) * 0x1p-54;
    ends[i] = {r * cosine - hair * sine, (r * sine + hair * cosine) * (i % 2 == 0 ? 1.0 : -1.0),
               random.uniform(0.1, 0.9)};
  }
  const StepReport at_face = environment.advance(close, ends);
  std::vector<unsigned> crossings(ends.size());
  for (const PeriodicCrossing& c : at_face.contacts.crossings) ++crossings[c.particle];
  EXPECT_GT(std::count(crossings.begin(), crossings.end(), 1U), 100);
  EXPECT_EQ(*std::max_element(crossings.begin(), crossings.end()), 1U);
  test::expect_audited(environment.complex(), close);
}

// Steps of any length among obstacles: contacts at the same walls, times and places.
struct Motion {
  std::vector<Vec3> velocities;
  std::vector<ParticleStatus> statuses;
};

void expect_same_contacts(const Twins& twins, const StepReport& one, const StepReport& all) {
  const auto& here = one.contacts.contacts;
  const auto& there = all.contacts.contacts;
  ASSERT_EQ(here.size(), there.size());
  for (std::size_t i = 0; i < here.size(); ++i) {
    ASSERT_EQ(here[i].particle, there[i].particle);
    ASSERT_NEAR(here[i].time_of_impact, there[i].time_of_impact, 1e-9);
    const WallHit& wall = one.contacts.walls_of(here[i]).front();
    const WallHit& other = all.contacts.walls_of(there[i]).front();
    ASSERT_EQ(twins.one.map().source(wall.face.cell), twins.cell_of_all(other.face.cell));
    ASSERT_NEAR(dot(wall.normal, other.normal), 1.0, 1e-9);
    for (const WallHit& w : one.contacts.walls_of(here[i]))
      ASSERT_EQ(twins.one.complex().periodic()->partner(w.face), nullptr);
  }
}

void expect_same_paths(bool moving, std::uint64_t seed) {
  const std::array<std::uint32_t, 3> cubes = {3, 2, 2};
  MeshData box = periodic_box({.cells = cubes, .type = CellType::tetrahedron, .blocked_share = 0.3, .seed = seed}, 3);
  const MeshData even = box;
  test::shake(box, cubes, seed);
  Twins twins(std::move(box), cubes, {1, 2, 2});
  Random random(seed);
  const auto uniform = [&](double low, double high) { return random.uniform(low, high); };
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < test::scaled<std::size_t>(300, 3000); ++i)
    places.push_back({uniform(0.0, 3.0), uniform(0.0, 2.0), uniform(0.0, 2.0)});
  twins.add(places);
  const std::size_t count = twins.ones.size();
  for (unsigned step = 0; step < 5; ++step) {
    std::vector<Vec3> starts, targets;
    for (std::size_t i = 0; i < count; ++i) starts.push_back(twins.ones[i].position);
    twins.alls = Particles();
    ASSERT_EQ(twins.all.add(twins.alls, starts).size(), count);
    ASSERT_EQ(twins.alls.size(), count);
    twins.images.assign(count, {});
    Motion one{std::vector<Vec3>(count), std::vector<ParticleStatus>(count)};
    for (std::size_t i = 0; i < count; ++i) {
      one.velocities[i] = {uniform(-2.5, 2.5), uniform(-2.5, 2.5), uniform(-2.5, 2.5)};
      targets.push_back(starts[i] + one.velocities[i]);
    }
    if (moving) {
      MeshData moved = even;
      test::shake(moved, cubes, seed + 100 + step);
      twins.one.move(moved.points);
      twins.all.move(repeated(moved, twins.size, twins.low, twins.high).points);
    }
    Motion all = one;
    const WallResponses responses(Reflect{1.0});
    const StepReport here =
        twins.one.advance(twins.ones, targets, respond_with(responses, one.velocities, one.statuses, 1.0));
    const StepReport there =
        twins.all.advance(twins.alls, targets, respond_with(responses, all.velocities, all.statuses, 1.0));
    count_images(here.contacts, twins.images);
    ASSERT_NO_FATAL_FAILURE(expect_same_contacts(twins, here, there)) << "step " << step;
    for (std::size_t i = 0; i < count; ++i) {
      ASSERT_LT(norm(twins.unwrapped(i) - twins.alls[i].position), 1e-9) << "particle " << i << " step " << step;
      ASSERT_LT(norm(one.velocities[i] - all.velocities[i]), 1e-9);
    }
    test::expect_audited(twins.one.complex(), twins.ones);
  }
}

TEST(Periodic, ContactsAreThoseOfARepeatedBox) {
  for (std::uint64_t seed = 1; seed <= test::scaled<std::uint64_t>(4, 40); ++seed)
    ASSERT_NO_FATAL_FAILURE(expect_same_paths(false, seed)) << "seed " << seed;
}

TEST(Periodic, SidesThatMoveAlikeStayAPair) {
  for (std::uint64_t seed = 1; seed <= test::scaled<std::uint64_t>(4, 40); ++seed)
    ASSERT_NO_FATAL_FAILURE(expect_same_paths(true, seed)) << "seed " << seed;
}

// Walls met before a crossing are those of another image: a contact has those alone that it met since then.
void expect_earlier_walls_since_crossings(const ContactList& list) {
  auto crossing = list.crossings.begin();
  std::uint32_t earlier = 0;
  std::uint32_t number = 0;  // of the particle's contact
  for (std::size_t i = 0; i < list.contacts.size(); ++i) {
    const Contact& c = list.contacts[i];
    if (i == 0 || list.contacts[i - 1].particle != c.particle) earlier = number = 0;
    for (; crossing != list.crossings.end() &&
           std::pair(crossing->particle, crossing->contacts) <= std::pair(c.particle, number);
         ++crossing) {
      if (crossing->particle == c.particle) earlier = 0;
    }
    ASSERT_EQ(c.earlier, earlier) << "contact " << number << " of particle " << c.particle;
    earlier += c.wall_count;
    ++number;
  }
}

// A direct call, rounds, a trace, and two threads take the same steps.
TEST(Periodic, AllWaysToStepHaveTheSameBits) {
  const std::array<std::uint32_t, 3> cubes = {2, 2, 2};
  MeshData box = periodic_box({.cells = cubes, .type = CellType::tetrahedron, .blocked_share = 0.2}, 3);
  test::shake(box, cubes, 5);
  Environment environment(std::move(box));
  Random random(5);
  Particles particles;
  std::vector<Vec3> targets;
  for (int i = 0; i < 300; ++i)
    environment.add(particles,
                    std::array{Vec3{2.0 * random.uniform(), 2.0 * random.uniform(), 2.0 * random.uniform()}});
  for (std::size_t i = 0; i < particles.size(); ++i)
    targets.push_back(particles[i].position +
                      Vec3{random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0)});
  const ContactCallback respond = [](const Contact& c, std::span<const WallHit> walls, std::span<const WallHit>) {
    return AfterContact{reflected(c.unused, walls, 1.0, 0.0), true};
  };
  const Particles before = particles;
  const StepReport report = environment.advance(particles, targets, respond);
  EXPECT_GT(report.contacts.crossings.size(), particles.size());
  EXPECT_GT(report.contacts.contacts.size(), 100U);
  ASSERT_NO_FATAL_FAILURE(expect_earlier_walls_since_crossings(report.contacts));
  const auto expect_same = [&](const Particles& others, const ContactList& list) {
    for (std::size_t i = 0; i < particles.size(); ++i) {
      ASSERT_EQ(others[i].position, particles[i].position);
      ASSERT_EQ(others[i].at(), particles[i].at());
    }
    ASSERT_EQ(list.crossings.size(), report.contacts.crossings.size());
    for (std::size_t i = 0; i < list.crossings.size(); ++i) {
      ASSERT_EQ(list.crossings[i].particle, report.contacts.crossings[i].particle);
      ASSERT_EQ(list.crossings[i].point, report.contacts.crossings[i].point);
      ASSERT_EQ(list.crossings[i].contacts, report.contacts.crossings[i].contacts);
    }
    ASSERT_EQ(list.contacts.size(), report.contacts.contacts.size());
    for (std::size_t i = 0; i < list.contacts.size(); ++i) {
      ASSERT_EQ(list.contacts[i].point, report.contacts.contacts[i].point);
      ASSERT_EQ(list.walls_of(list.contacts[i]).front().face,
                report.contacts.walls_of(report.contacts.contacts[i]).front().face);
    }
  };
  Particles others = before;
  const RoundCallback rounds = [](const ContactList& list, std::span<AfterContact> after) {
    for (std::size_t i = 0; i < after.size(); ++i)
      after[i] = {reflected(list.contacts[i].unused, list.walls_of(list.contacts[i]), 1.0, 0.0), true};
  };
  const StepReport in_rounds = environment.advance_in_rounds(others, targets, rounds);
  ASSERT_NO_FATAL_FAILURE(expect_same(others, in_rounds.contacts));
  environment.set_threads(Threads{2});
  others = before;
  const StepReport threaded = environment.advance(others, targets, respond);
  ASSERT_NO_FATAL_FAILURE(expect_same(others, threaded.contacts));
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const std::vector<Trace> traces = environment.trace(before, i, {&targets[i], 1}, respond);
    ASSERT_EQ(traces[0].after.position, particles[i].position);
  }
}

// A particle that passes a face and stops at a wall behind it begins its next step as any other.
TEST(Periodic, StepsAfterAStopBehindAFaceAreThoseOfTheParticleAlone) {
  const std::array<std::uint32_t, 3> cubes = {3, 2, 2};
  for (const bool moves : {false, true}) {
    const MeshData box = periodic_box({.cells = cubes, .blocked_share = 0.3}, 3);
    Environment environment(box);
    Random random(8);
    Particles particles;
    environment.add(particles, lattice_points(random, cubes, 400));
    for (unsigned step = 0; step < 6; ++step) {
      std::vector<Vec3> targets;
      for (std::size_t i = 0; i < particles.size(); ++i)  // every fourth way goes along walls
        targets.push_back(particles[i].position +
                          Vec3{lattice(random, -2, 3), lattice(random, -1, 2) * (i % 4 == 0 ? 0.0 : 1.0), 0.25});
      if (moves) {
        MeshData moved = box;
        test::shake(moved, cubes, step);
        environment.move(moved.points);
      }
      const Particles before = particles;
      environment.advance(particles, targets);
      for (std::size_t i = 0; i < particles.size(); ++i) {
        const Trace alone = environment.trace(before, i, {&targets[i], 1}).front();
        ASSERT_EQ(alone.after.position, particles[i].position) << "particle " << i << " step " << step;
        ASSERT_EQ(alone.after.at(), particles[i].at());
      }
      test::expect_audited(environment.complex(), particles);
    }
  }
}

// A way that starts on an edge of the border may pass a face that it does not go beyond, to come to another one. Its target
// stays where it is.
TEST(Periodic, WaysFromCornersOfTheBorderEndWhereTheyShould) {
  const std::array<std::uint32_t, 3> cubes = {3, 2, 2};
  std::size_t crossings = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    MeshData box = periodic_box({.cells = cubes, .type = CellType::tetrahedron, .blocked_share = 0.3, .seed = seed},
                                static_cast<unsigned>(1 + seed % 3));
    test::shake(box, cubes, seed);
    Environment environment(box);
    Particles particles;
    std::vector<Vec3> targets;
    Random random(seed);
    for (int i = 0; i < 10; ++i) environment.add(particles, box.points);
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const auto part = [&] { return 0x1p-5 * (random.below(3) - 1.0); };
      targets.push_back(particles[i].position + Vec3{part(), part(), part()});
    }
    const StepReport report = environment.advance(particles, targets);
    std::vector<bool> met(targets.size());
    for (const Contact& c : report.contacts.contacts) met[c.particle] = true;
    std::vector<Vec3> homes(targets.size());
    for (const PeriodicCrossing& c : report.contacts.crossings) {
      const Vec3 way = environment.complex().periodic()->pairs()[c.pair].translate;
      homes[c.particle] += c.back ? way : -way;
    }
    crossings += report.contacts.crossings.size();
    for (std::size_t i = 0; i < targets.size(); ++i)
      EXPECT_EQ(met[i] ? targets[i] : particles[i].position + homes[i], targets[i]) << i << " seed " << seed;
    test::expect_audited(environment.complex(), particles);
  }
  EXPECT_GT(crossings, 100U);
}

// Corners of one side are off their partners: no particle is lost, and each goes as far as it should.
TEST(Periodic, RoundedPartnersLoseNoParticle) {
  const std::array<std::uint32_t, 3> cubes = {2, 2, 2};
  for (const CellType type : {CellType::tetrahedron, CellType::hexahedron}) {
    for (const double off : {1e-15, 1e-9, 1e-3}) {
      MeshData box = periodic_box({.cells = cubes, .type = type}, 3);
      test::shake(box, cubes, 6);
      Random random(6);
      for (Vec3& x : box.points)
        x += Vec3{random.uniform(-off, off), random.uniform(-off, off), random.uniform(-off, off)};
      for (PeriodicPair& pair : box.periodic) pair.tolerance = 2.0 * off;
      Environment environment(std::move(box));
      Particles particles;
      std::vector<Vec3> starts;
      for (int i = 0; i < 300; ++i)
        starts.push_back({random.uniform(0.1, 1.9), random.uniform(0.1, 1.9), random.uniform(0.1, 1.9)});
      environment.add(particles, starts);
      ASSERT_EQ(particles.size(), starts.size());
      Images images(starts.size());
      for (int step = 0; step < 20; ++step) {
        std::vector<Vec3> targets;
        for (Vec3& x : starts) {
          const Vec3 way{random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5)};
          targets.push_back(particles[targets.size()].position + way);
          x += way;
        }
        const StepReport report = environment.advance(particles, targets);
        ASSERT_TRUE(report.held.empty() && report.stopped.empty() && report.contacts.contacts.empty());
        count_images(report.contacts, images);
        test::expect_audited(environment.complex(), particles);
      }
      for (std::size_t i = 0; i < starts.size(); ++i) {
        const auto& n = images[i];
        const Vec3 end = particles[i].position + Vec3{2.0 * n[0], 2.0 * n[1], 2.0 * n[2]};
        ASSERT_LT(norm(end - starts[i]), 1e-12 + 200.0 * off) << "particle " << i << " off " << off;
      }
    }
  }
}

TEST(Periodic, ALimitOfCrossingsStopsAParticleAtTheBorder) {
  Environment environment(periodic_box({.cells = {2, 2, 2}}, 3));
  Particles particles;
  environment.add(particles, std::array{Vec3{0.5, 0.5, 0.5}});
  const StepReport far = environment.advance(particles, std::array{Vec3{2000.5, 0.5, 0.5}}, {}, {.max_crossings = 999});
  ASSERT_EQ(far.stopped.size(), 1U);
  EXPECT_EQ(far.counters.unfinished, 1U);
  EXPECT_EQ(far.stopped[0].unused, (Vec3{0.5, 0.0, 0.0}));
  EXPECT_EQ(particles[0].position, (Vec3{0.0, 0.5, 0.5}));
  const StepReport rest = environment.advance(particles, std::array{Vec3{2000.5, 0.5, 0.5}});
  EXPECT_TRUE(rest.stopped.empty());
  EXPECT_EQ(rest.contacts.crossings.size(), 1000U);
  EXPECT_EQ(particles[0].position, (Vec3{0.5, 0.5, 0.5}));
}

TEST(Periodic, WhatIsNoPairIsRefusedWithItsPlace) {
  const auto refused = [](const PeriodicPair& pair, const std::string& words) {
    MeshData box = generate_box({.cells = {2, 2, 2}});
    box.points[0].y += 0.125;
    box.points[0].z += 0.125;
    box.periodic.push_back(pair);
    const std::string text = test::error_text([&] { const Environment environment(box); });
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  refused({"xmin", "xmax", {2.0, 0.0, 0.0}}, "the corner at (0, 0.125, 0.125) of \"xmin\" comes to (2, 0.125, 0.125)");
  refused({"ymax", "ymax", {}}, "a patch cannot be its own partner");
  refused({"xmin", "xmax", {2.0, 0.0, 0.0}, {}, {}, 30.0}, "an angle needs an axis");
  refused({"xmin", "xmax", {2.0, 0.0, 0.0}, {}, {}, 0.0, 0.0}, "the tolerance is 0");
}

TEST(Periodic, AMoveThatPartsAPairIsRefusedWithTheVertex) {
  Environment environment(periodic_box({.cells = {2, 2, 2}}, 1));
  std::vector<Vec3> points(environment.positions().begin(), environment.positions().end());
  points[0].y -= 0.25;
  test::expect_refused([&] { environment.move(points); }, "vertex 2 at (2, 0, 0) comes 0.25 off its partner, vertex 0");
  EXPECT_EQ(environment.positions()[0], Vec3{});
  points[2].y -= 0.25;
  environment.move(points);
  EXPECT_EQ(environment.positions()[0].y, -0.25);
}

TEST(Periodic, EditsAreRefused) {
  Environment environment(periodic_box({.cells = {2, 2, 2}}, 1));
  const std::string text = test::refusal([&] { environment.edit([](ComplexEdit&) {}); });
  EXPECT_EQ(text.rfind("refused: edit: a scene with periodic pairs", 0), 0U) << text;
}

}  // namespace dartcast::periodic_test
