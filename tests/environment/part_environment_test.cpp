// Steps in environments that are spread over ranks, against the same steps in one: states, contacts and counts to the bit.
#include "environment/part_environment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <tuple>
#include <vector>

#include "base/bytes.hpp"
#include "base/kept_runs.hpp"
#include "base/random.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/mesh_check.hpp"
#include "parts/bisected.hpp"
#include "support/meshes.hpp"
#include "support/stepped_scenes.hpp"
#include "support/thread_ranks.hpp"
#include "support/tier.hpp"
#include "tracking/batch/traveller.hpp"

namespace dartcast::part_environment_test {

using Words = std::vector<std::uint64_t>;

std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }
void append(Words& words, const Vec3& v) { words.insert(words.end(), {bits(v.x), bits(v.y), bits(v.z)}); }

Words words_of(const ParticleState& s) {
  Words words = {s.cell.value, s.simplex, s.touching_count, s.held ? 1U : 0U};
  append(words, s.position);
  for (unsigned i = 0; i < s.touching_count; ++i)
    words.insert(words.end(), {s.touching[i].cell.value, s.touching[i].face});
  return words;
}

// Walls of other ranks have no face here: these are left out.
Words words_of(const Contact& c, std::span<const WallHit> walls, Cell cell, const std::function<Cell(Cell)>& whole) {
  Words words = {static_cast<std::uint64_t>(c.kind),
                 cell.value,
                 c.dart.number,
                 c.wall_count,
                 c.earlier,
                 c.together,
                 c.last ? 1U : 0U,
                 bits(c.time_of_impact)};
  for (const Vec3& v : {c.point, c.wall_displacement, c.displacement, c.unused}) append(words, v);
  for (const WallHit& w : walls) {
    words.insert(words.end(), {whole(w.face.cell).value, w.face.face, w.triangle, w.patch.value});
    append(words, w.normal);
  }
  return words;
}

// The results of a step, by the particles' ids.
struct Outcome {
  std::map<std::uint64_t, Words> states;
  std::map<std::pair<std::uint64_t, std::uint32_t>, Words> contacts;  // by id and number of earlier walls
  std::map<std::uint64_t, bool> held;
  Counters counters;
};

// All counts but those of tests.
Words words_of(const Counters& c) {
  Words words = {c.particle_steps, c.steps_split, c.unfinished};
  words.insert(words.end(), c.contacts.begin(), c.contacts.end());
  return words;
}

// A particle's way in a step. Along a lattice of halves it leads to faces, edges and vertices of unit cells.
Vec3 way(std::uint64_t id, int step, const test::SteppedScene& scene) {
  Random random(id * 1000 + static_cast<std::uint64_t>(step));
  const auto number = [&] { return 2.0 * random.uniform() - 1.0; };
  const Vec3 v = {number(), number(), number()};
  if (scene.lattice == 0.0) return v * scene.speed;
  const double halves = 2.0 * scene.lattice;
  return {std::round(v.x * halves) * 0.5, std::round(v.y * halves) * 0.5, std::round(v.z * halves) * 0.5};
}

// One rank's particles.
class Travellers final : public TravelData {
 public:
  std::vector<std::uint64_t> ids;
  std::vector<unsigned> answered;  // contacts in this step

  [[nodiscard]] std::string leave(std::uint32_t particle, std::uint32_t contacts) const override {
    EXPECT_LE(contacts, answered[particle]);
    ByteWriter out;
    out.put(ids[particle]);
    out.put(answered[particle]);
    return out.bytes();
  }
  void come(std::string_view data) override {
    ByteReader in(data);
    ids.push_back(in.take<std::uint64_t>());
    answered.push_back(in.take<unsigned>());
  }
};

AfterContact answer(std::uint64_t id, unsigned count, const Contact& c, std::span<const WallHit> walls,
                    std::span<const WallHit> earlier) {
  Contact named = c;
  named.particle = static_cast<std::uint32_t>(id);
  test::Answers answers(id + 1);
  answers.set_answered(named.particle, count);
  return answers(named, walls, earlier);
}

class WholeRun {
 public:
  WholeRun(const test::SteppedScene& scene, const StepOptions& options, std::uint64_t seed, std::size_t particles)
      : scene_(scene), options_(options), environment_(scene.mesh, Threads{1}) {
    Random random(seed);
    particles_ = test::scattered(environment_, scene.mesh, 400, random);
    particles_.truncate(particles);
  }

  Outcome step(int step) {
    if (scene_.moved) {
      std::vector<Vec3> x = scene_.mesh.points;
      for (Vec3& p : x) p = scene_.moved(p, step);
      environment_.move(x);
    }
    std::vector<Vec3> targets;
    for (std::size_t i = 0; i < particles_.size(); ++i)
      targets.push_back(particles_[i].position + way(i, step, scene_));
    std::vector<unsigned> answered(particles_.size());
    const ContactCallback respond = [&](const Contact& c, auto walls, auto earlier) {
      return answer(c.particle, answered[c.particle]++, c, walls, earlier);
    };
    const StepReport report = environment_.advance(particles_, targets, respond, options_);
    Outcome o;
    for (std::size_t i = 0; i < particles_.size(); ++i) o.states[i] = words_of(particles_[i]);
    for (const Contact& c : report.contacts.contacts)
      o.contacts[{c.particle, c.earlier}] =
          words_of(c, report.contacts.walls_of(c), c.dart.cell, [](Cell cell) { return cell; });
    for (const HeldParticle& h : report.held) o.held[h.particle] = true;
    o.counters = report.counters;
    return o;
  }

  [[nodiscard]] const Particles& particles() const { return particles_; }

 private:
  const test::SteppedScene& scene_;
  StepOptions options_;
  Environment environment_;
  Particles particles_;
};

// One rank of a run.
class PartRun {
 public:
  PartRun(const test::SteppedScene& scene, const StepOptions& options, const std::vector<std::uint32_t>& parts,
          Ranks& ranks, const Particles& start)
      : scene_(scene),
        options_(options),
        part_(mesh_part(checked(scene.mesh), parts, ranks.size(), ranks.rank())),
        environment_(part_.mesh, Threads{1}),
        distributed_(environment_, part_, ranks) {
    for (std::size_t i = 0; i < start.size(); ++i) {
      const SimplexId here = distributed_.cells().here(start[i].at());
      if (!here.valid() || !distributed_.cells().is_own(here.cell)) continue;
      EXPECT_TRUE(environment_.add(particles_, here, start[i].position));
      own_.ids.push_back(i);
    }
  }

  static MeshData checked(MeshData mesh) {
    check_and_repair(mesh);
    return mesh;
  }

  // Adds to the outcome of all ranks.
  void step(int step, Outcome& all, std::mutex& mutex) {
    if (scene_.moved) {
      std::vector<Vec3> x = part_.mesh.points;
      for (Vec3& p : x) p = scene_.moved(p, step);
      environment_.move(x);
    }
    std::vector<Vec3> targets;
    for (std::size_t i = 0; i < particles_.size(); ++i)
      targets.push_back(particles_[i].position + way(own_.ids[i], step, scene_));
    own_.answered.assign(particles_.size(), 0);
    const ContactCallback respond = [&](const Contact& c, auto walls, auto earlier) {
      return answer(own_.ids[c.particle], own_.answered[c.particle]++, c, walls, earlier);
    };
    std::vector<std::uint8_t> gone;
    const StepReport report = distributed_.advance(particles_, targets, respond, options_, own_, gone);
    const PartCells& cells = distributed_.cells();
    const auto whole = [&](Cell c) { return cells.whole(c); };
    {
      const std::lock_guard lock(mutex);
      for (const Contact& c : report.contacts.contacts)
        all.contacts[{own_.ids[c.particle], c.earlier}] =
            words_of(c, report.contacts.walls_of(c), whole(c.dart.cell), whole);
      for (const HeldParticle& h : report.held) all.held[own_.ids[h.particle]] = true;
      all.counters += report.counters;
      for (std::size_t i = 0; i < particles_.size(); ++i) {
        if (gone[i] != 0) continue;
        EXPECT_TRUE(cells.is_own(particles_[i].cell));
        EXPECT_TRUE(all.states.emplace(own_.ids[i], words_of(whole_state(cells, particles_[i]))).second);
      }
    }
    particles_.remove(gone);
    const KeptRuns runs(gone);
    runs.keep_in(own_.ids);
    EXPECT_EQ(audit(environment_.complex(), particles_).failed, 0U);
  }

  [[nodiscard]] const TrafficCounts& traffic() const { return distributed_.traffic(); }

 private:
  const test::SteppedScene& scene_;
  StepOptions options_;
  MeshPart part_;
  Environment environment_;
  PartEnvironment distributed_;
  Particles particles_;
  Travellers own_;
};

void expect_equal(const Outcome& one, const Outcome& many, const std::string& name) {
  EXPECT_TRUE(one.states == many.states) << name;
  EXPECT_TRUE(one.contacts == many.contacts) << name;
  EXPECT_EQ(one.held, many.held) << name;
  EXPECT_EQ(words_of(one.counters), words_of(many.counters)) << name;
  EXPECT_EQ(many.counters.orientation.tests + many.counters.forecast_kept, 0U) << name;
}

// Particles that must change ranks, so that the test says something; one under sanitizers, which take three steps.
std::uint64_t at_least(std::uint64_t particles) { return test::sanitized() ? 1 : particles; }

// Runs the scene on parts and as a whole. Returns the particles that went from rank to rank.
std::uint64_t compare(const test::SteppedScene& scene, const StepOptions& options, std::uint32_t count, int steps,
                      std::size_t particles = 1000) {
  steps = std::max(steps, 3);
  WholeRun whole(scene, options, 7, particles);
  const Particles start = whole.particles();
  std::vector<Outcome> expected;
  for (int s = 0; s < steps; ++s) expected.push_back(whole.step(s));
  const std::vector<std::uint32_t> parts =
      bisected(middles_of(scene.mesh), {}, std::vector<std::uint64_t>(scene.mesh.cell_count(), 1), count);
  std::vector<Outcome> found(expected.size());
  std::mutex mutex;
  std::uint64_t sent = 0;
  test::on_ranks(count, [&](Ranks& ranks) {
    PartRun part(scene, options, parts, ranks, start);
    for (int s = 0; s < steps; ++s) part.step(s, found[static_cast<std::size_t>(s)], mutex);
    const std::lock_guard lock(mutex);
    sent += part.traffic().sent;
  });
  for (std::size_t s = 0; s < expected.size(); ++s) {
    const std::string name = scene.name + ", " + std::to_string(count) + " parts, step " + std::to_string(s);
    expect_equal(expected[s], found[s], name);
    if (testing::Test::HasFailure()) break;
  }
  return sent;
}

TEST(PartEnvironment, StepsAreThoseOfOneEnvironment) {
  for (const test::SteppedScene& scene : test::make_scenes()) {
    if (scene.mesh.dimension() == 2) continue;
    for (const double share : {0.1, 1.0}) {
      test::SteppedScene slower = scene;
      slower.speed *= share;
      for (const std::uint32_t count : test::all_or_first({8U, 1U, 2U, 3U})) {
        const std::uint64_t sent = compare(slower, {}, count, test::scaled(12, 60));
        if (count > 1) EXPECT_GE(sent, at_least(20)) << scene.name;
        if (HasFailure()) return;
      }
    }
  }
}

// Ends of steps and contacts lie on faces, edges and vertices that 2, 4 and 8 parts share.
TEST(PartEnvironment, LatticeMotionsPassTheBordersOfParts) {
  for (const CellType type : {CellType::hexahedron, CellType::tetrahedron, CellType::prism}) {
    test::SteppedScene scene{"lattice", test::cubes(4, type, 0.1), {}, 0.0, 1.5};
    for (const std::uint32_t count : test::all_or_first({8U, 2U, 4U, 27U}))
      EXPECT_GE(compare(scene, {}, count, test::scaled(20, 200)), at_least(100));
    if (HasFailure()) return;
  }
}

// Truncated octahedra, whose edges have three cells each and no two faces of a cell are parallel and equal.
TEST(PartEnvironment, PolyhedraAreSpread) {
  OctahedraOptions options;
  options.cells = {4, 4, 4};
  options.size = {1.0, 1.0, 1.0};
  options.blocked_share = 0.1;
  const test::SteppedScene still{"octahedra", generate_octahedra(options), {}, 0.5};
  const test::SteppedScene moved{"octahedra that deform", still.mesh, test::sheared, 0.5};
  for (const std::uint32_t count : test::all_or_first({8U, 2U, 4U})) {
    EXPECT_GE(compare(still, {}, count, test::scaled(20, 200)), at_least(100));
    EXPECT_GE(compare(moved, {}, count, test::scaled(20, 200)), at_least(100));
  }
}

// Steps of many parts: they leave at the start of a part, too.
TEST(PartEnvironment, SplitStepsGoOnInTheirParts) {
  StepOptions options;
  options.tolerance = 1e-4;
  options.max_contacts = 5;
  for (const test::SteppedScene& scene : test::make_scenes()) {
    if (scene.mesh.dimension() == 2 || !scene.moved) continue;
    for (const std::uint32_t count : test::all_or_first({8U, 2U, 5U}))
      EXPECT_GE(compare(scene, options, count, test::scaled(10, 100)), at_least(20));
    if (HasFailure()) return;
  }
}

// Batches walk the first parts of these; walks pass several ranks, and meet walls on them.
TEST(PartEnvironment, LongStepsThatAreSplit) {
  BoxOptions box;
  box.cells = {16, 8, 8};
  box.size = {16.0, 8.0, 8.0};
  box.blocked_share = 0.05;
  OctahedraOptions octahedra;
  octahedra.cells = {4, 4, 4};
  octahedra.size = {1.0, 1.0, 1.0};
  octahedra.blocked_share = 0.1;
  StepOptions options;
  options.max_contacts = 3;
  for (const MeshData& mesh : {generate_box(box), generate_octahedra(octahedra)}) {
    const test::SteppedScene scene{"long steps", mesh, test::sheared, 9.0};
    for (const std::uint32_t count : test::all_or_first({8U, 2U, 4U}))
      EXPECT_GE(compare(scene, options, count, test::scaled(20, 400)), at_least(100));
    if (HasFailure()) return;
  }
}

// Cubes that move as a whole, by parts of the lattice: steps have one part, start on faces and vertices, and their lines
// pass edges and vertices exactly.
TEST(PartEnvironment, LongStepsAlongALatticeThatMoves) {
  BoxOptions box;
  box.cells = {16, 8, 8};
  box.size = {16.0, 8.0, 8.0};
  box.blocked_share = 0.05;
  const auto along = [](const Vec3& p, int step) { return Vec3{p.x + 0.25 * step, p.y, p.z - 0.125 * step}; };
  const test::SteppedScene scene{"lattice that moves", generate_box(box), along, 0.0, 9.0};
  for (const std::uint32_t count : test::all_or_first({8U, 2U, 4U}))
    EXPECT_GE(compare(scene, {}, count, test::scaled(20, 400)), at_least(100));
}

// A rank without particles takes part in the moves of the others: walls move where a particle comes to it.
TEST(PartEnvironment, MostRanksMayBeEmpty) {
  std::uint64_t sent = 0;
  for (const test::SteppedScene& scene : test::make_scenes()) {
    if (scene.mesh.dimension() == 2) continue;
    sent += compare(scene, {}, 8, test::scaled(40, 400), 3);
    if (HasFailure()) return;
  }
  EXPECT_GE(sent, at_least(100));
}

// Parts of one cell: every cell around is a ghost.
TEST(PartEnvironment, APartMayBeOneCell) {
  BoxOptions box;
  box.cells = {3, 2, 2};
  box.size = {3, 2, 2};
  box.jitter = 0.2;
  const test::SteppedScene scene{"small", generate_box(box), test::sheared, 0.7};
  EXPECT_GE(compare(scene, {}, 12, test::scaled(10, 50)), at_least(1000));
}

}  // namespace dartcast::part_environment_test
