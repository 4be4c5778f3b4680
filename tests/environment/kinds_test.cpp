// Every kind of cell beside every other, after every edit, by steps of all lengths, at rest and moving: the batch, the
// batch in rounds and the step of one particle give the same bits, and no particle is lost.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/cutting.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/remeshing.hpp"
#include "support/particle_checks.hpp"
#include "support/patchwork.hpp"
#include "support/report_words.hpp"
#include "support/seeds.hpp"
#include "support/stepped_scenes.hpp"

namespace dartcast::kinds_test {

using test::Words;

// --- scenes

struct Scene {
  MeshData mesh;
  Vec3 size;
};

// Three of four are of space, and one is of the plane. Some cells are blocked.
Scene draw_scene(std::uint64_t seed, Random& random) {
  constexpr std::array<std::array<std::uint32_t, 3>, 4> sizes = {{{6, 6, 6}, {24, 3, 3}, {10, 10, 2}, {4, 4, 4}}};
  const auto n = sizes[random.below(4)];
  Scene scene;
  if (seed % 4 == 0) {
    RectangleOptions o;
    o.cells = {4 * n[0], 4 * n[1]};
    o.size = {double(4 * n[0]), double(4 * n[1])};
    o.mixed = true;
    o.jitter = random.below(2) == 0 ? 0.0 : 0.25;
    o.seed = seed;
    scene = {generate_rectangle(o), {o.size->at(0), o.size->at(1), 0.0}};
  } else {
    scene = {test::patchwork(n, random), {double(n[0]), double(n[1]), double(n[2])}};
  }
  const std::uint32_t one_blocked_of = random.below(2) == 0 ? 1000 : 12;
  scene.mesh.free.resize(scene.mesh.cell_count());
  for (auto& free : scene.mesh.free) free = random.below(one_blocked_of) == 0 ? 0 : 1;
  return scene;
}

// Merges, subdivides, splits or marks a cell; nothing where that cannot be.
void edit_once(Environment& environment, Random& random) {
  const std::vector<Cell> cells = environment.map().cells();
  const Cell c = cells[random.below(static_cast<std::uint32_t>(cells.size()))];
  const CombinatorialMap& map = environment.map();
  const auto face = static_cast<std::uint16_t>(random.below(map.shape(c).face_count()));
  const Vec3 through = environment.positions()[map.view(c).vertex(0).value] + Vec3{0.4, 0.45, 0.5};
  const Vec3 normal = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
  try {
    environment.edit([&](ComplexEdit& edit) {
      const bool space = map.dimension() == 3;
      switch (random.below(space ? 8 : 4)) {
        case 0: edit.topology().set_free(c, !map.is_free(c)); break;
        case 4:
        case 5: subdivide(edit, c); break;
        case 6:
        case 7: split_by_plane(edit, std::vector<Cell>{c}, plane_through(through, normal)); break;
        default: merge_cells(edit.topology(), CellFace{c, face}); break;
      }
    });
  } catch (const Error&) {  // refused: nothing is changed
  }
}

// Counts of all that the scenes had: nothing must be left out.
struct Seen {
  std::array<std::array<std::uint64_t, 8>, 8> beside{};  // by the types of neighbouring cells
  std::uint64_t most_faces = 0;
  std::uint64_t steiner = 0, held = 0, split = 0;
  std::array<std::uint64_t, 3> contacts{};  // by kind
  std::mutex mutex;

  void look_at(const CombinatorialMap& map) {
    const std::lock_guard lock(mutex);
    for (const Cell c : map.cells()) {
      const CellView view = map.view(c);
      most_faces = std::max<std::uint64_t>(most_faces, view.shape().face_count());
      steiner += view.shape().key().has_point ? 1 : 0;
      for (std::uint16_t f = 0; f < view.shape().face_count(); ++f) {
        const Cell other = view.neighbour(f);
        if (other.valid()) ++beside[static_cast<std::size_t>(map.type(c))][static_cast<std::size_t>(map.type(other))];
      }
    }
  }
  void look_at(const StepReport& report) {
    const std::lock_guard lock(mutex);
    held += report.held.size();
    split += report.counters.steps_split;
    for (std::size_t kind = 0; kind < contacts.size(); ++kind) contacts[kind] += report.counters.contacts[kind];
  }
};

// --- ways to take one step

// A step's targets: from a thousandth of a cell to 300 cells away; often along the lattice, through its edges and points.
std::vector<Vec3> draw_targets(const Particles& particles, bool plane, Random& random) {
  std::vector<Vec3> targets;
  for (const ParticleState& s : particles.states()) {
    const double length = std::pow(10.0, random.uniform(-3.0, 2.5));
    Vec3 way = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    if (random.below(3) == 0) way = {std::round(way.x), std::round(way.y), std::round(way.z)};
    if (plane) way.z = 0.0;
    targets.push_back(s.position + way * length);
  }
  return targets;
}

struct Answered {
  bool answers;  // else particles stop at their first contact
  test::Answers by;

  ContactCallback one_by_one() {
    by.start_step();
    return answers ? ContactCallback(std::ref(by)) : ContactCallback{};
  }
  RoundCallback in_rounds() {
    by.start_step();
    if (!answers) return {};
    return [this](const ContactList& list, std::span<AfterContact> after) {
      for (std::size_t i = 0; i < after.size(); ++i) {
        const Contact& c = list.contacts[i];
        after[i] = by(c, list.walls_of(c), list.earlier_walls_of(c));
      }
    };
  }
};

// The first particle for which the batch has another result than one step, as trace() takes it; or nothing.
std::string compare_with_traces(const Environment& environment, const Particles& before, const Particles& after,
                                const std::vector<Vec3>& targets, const StepReport& report, Answered& answered) {
  std::size_t next = 0;
  const auto& contacts = report.contacts.contacts;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Trace trace = environment.trace(before, i, {&targets[i], 1}, answered.one_by_one()).at(0);
    std::string difference = test::same_bits(trace.after, after[i]) ? "" : "another state";
    for (const Contact& c : trace.contacts.contacts) {
      const bool same = next < contacts.size() &&
                        test::words_of(trace.contacts, c) == test::words_of(report.contacts, contacts[next]);
      if (!same) difference += ", another contact";
      ++next;
    }
    if (difference.empty()) continue;
    const Vec3& p = before[i].position;
    const Vec3& q = targets[i];
    return fmt::format("particle {} from ({}, {}, {}) to ({}, {}, {}): {}", i, p.x, p.y, p.z, q.x, q.y, q.z,
                       difference);
  }
  return next == contacts.size() ? "" : "contacts that no trace has";
}

// All ways to take a step; they leave the particles at its end. Returns what differs, or nothing.
std::string step(Environment& environment, Particles& particles, Random& random, Seen& seen) {
  const std::vector<Vec3> targets = draw_targets(particles, environment.map().dimension() == 2, random);
  Answered answered{random.below(2) == 0, test::Answers(particles.size())};
  const Particles before = particles;
  Particles in_rounds = particles;
  const StepReport report = environment.advance(particles, targets, answered.one_by_one());
  seen.look_at(report);
  const std::string difference = compare_with_traces(environment, before, particles, targets, report, answered);
  if (!difference.empty()) return difference;
  const StepReport rounds = environment.advance_in_rounds(in_rounds, targets, answered.in_rounds());
  if (!test::same_bits(test::copy_of(particles), in_rounds) || test::words_of(report) != test::words_of(rounds))
    return "rounds have another result";
  return test::check_states(environment, particles);
}

// --- the product

std::string run(std::uint64_t seed, Seen& seen) {
  Random random(seed);
  const Scene scene = draw_scene(seed, random);
  Environment environment(scene.mesh);
  Particles particles;
  environment.add(particles, test::random_points(40, {}, scene.size, random));
  const bool moving = random.below(2) == 0;
  for (int k = 0; k < 6; ++k) {
    const std::uint32_t edits = k % 2 == 0 ? random.below(12) : 0;
    for (std::uint32_t i = 0; i < edits; ++i) {
      edit_once(environment, random);
      environment.update_after_edit(particles);
    }
    seen.look_at(environment.map());
    if (moving) {
      const double far = random.uniform(0.0, k == 4 ? 0.5 : 0.05);
      const auto next = environment.next_positions();
      for (std::size_t i = 0; i < next.size(); ++i) {
        const Vec3 p = environment.positions()[i];
        next[i] = p + Vec3{std::sin(p.y + p.z), std::sin(p.x), scene.size.z > 0.0 ? std::sin(p.x + p.y) : 0.0} * far;
      }
      environment.move();
    }
    const std::string wrong = step(environment, particles, random, seen);
    if (!wrong.empty()) return fmt::format("seed {}, step {}: {}", seed, k, wrong);
  }
  return "";
}

TEST(Kinds, TakeTheSameStepsWhateverIsBesideThem) {
  Seen seen;
  const auto wrong = test::run_seeds(test::scaled(600, 20000), [&](std::uint64_t seed) { return run(seed, seen); });
  EXPECT_EQ(wrong, std::vector<std::string>{});
  for (const std::size_t type : {0, 1, 2, 3, 4})
    for (const std::size_t other : {0, 1, 2, 3, 4})
      if (type + other != 1)
        EXPECT_GT(seen.beside[type][other], 0U) << type << " beside " << other;  // no face fits both
  EXPECT_GT(seen.beside[7][6], 0U);
  EXPECT_GE(seen.most_faces, 54U);
  EXPECT_GT(seen.steiner, 0U);
  EXPECT_GT(seen.held, 0U);
  EXPECT_GT(seen.split, 0U);
  for (const std::uint64_t contacts : seen.contacts) EXPECT_GT(contacts, 0U);
}

}  // namespace dartcast::kinds_test
