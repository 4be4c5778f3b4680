// The batch that the filter decides against the step of one particle: the same bits wherever the batch takes a step.
#include "tracking/batch/batch.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/random.hpp"
#include "oracle/scenes.hpp"
#include "support/particle_checks.hpp"
#include "support/random_vectors.hpp"
#include "support/seeds.hpp"
#include "support/tier.hpp"
#include "tracking/carry.hpp"
#include "tracking/locate.hpp"
#include "tracking/step.hpp"

namespace dartcast::test::batch_test {

constexpr std::size_t particles = 41;  // one alone in its vector
constexpr std::size_t steps_per_scene = 30;

struct Tally {
  std::atomic<std::uint64_t> steps{0};
  std::atomic<std::uint64_t> taken{0};
  std::atomic<std::uint64_t> moved_on{0};       // taken into another simplex
  std::atomic<std::uint64_t> resumed{0};        // taken up to a wall
  std::atomic<std::uint64_t> landed{0};         // of these, the contact is known
  std::atomic<std::uint64_t> remembered{0};     // taken, and coordinates are kept for the next
  std::atomic<std::uint64_t> exact{0};          // of these, exact ones
  std::atomic<std::uint64_t> in_parts{0};       // resumed in the first of several parts, at a wall
  std::atomic<std::uint64_t> carried_on{0};     // of these, where the vertices carry the particle to is known
  std::atomic<std::uint64_t> carried_often{0};  // in more than one part
  std::atomic<std::uint64_t> parts_on{0};       // resumed in the first of several parts, at its end
};

// A scene whose particles are stepped both ways.
class BothWays {
 public:
  BothWays(MeshData mesh, std::uint64_t seed, bool moves, bool on_lattice, bool on_facets)
      : mesh_(std::move(mesh)),
        complex_(mesh_),
        random_(seed, 9),
        stops_at_random_(seed, 10),
        moves_(moves),
        on_lattice_(on_lattice),
        on_facets_(on_facets) {
    std::vector<SimplexId> free;
    for (const Cell c : complex_.map().cells()) {
      for (std::uint16_t s = 0; s < complex_.map().shape(c).simplices().size(); ++s) {
        if (complex_.map().is_free(c)) free.push_back({c, s});
      }
    }
    while (states_.size() < particles) {
      ParticleState state;
      const SimplexId at = free[random_.below(static_cast<std::uint32_t>(free.size()))];
      state.put(at, point_of(complex_.corners(at)));
      states_.push_back(state);
    }
  }

  // Half of the targets are in planes across axes through vertices.
  void aim_at_planes() { at_planes_ = true; }

  void split_at_most(unsigned parts) { options_.max_slices = parts; }

  // Half of the targets are many cells away.
  void aim_far_away() { far_away_ = true; }

  [[nodiscard]] bool usable() const { return complex_.invalid_cells().empty(); }

  // One step of all particles; what differs.
  std::string step(Tally& tally) {
    if (moves_) move();
    stops_ = stops_at_random_.below(4) != 0;
    std::vector<Vec3> targets;
    for (const ParticleState& s : states_) targets.push_back(target(s));
    const Filtered portable = filtered(targets, detail::InstructionSet::portable, caches_);
    const Filtered best = filtered(targets, detail::best_instruction_set(), caches_);
    const Filtered uncached = filtered(targets, detail::best_instruction_set(), unknown_caches());
    if (!std::ranges::equal(portable.taken, best.taken)) return "instruction sets leave different steps";
    if (!same_caches(best, portable)) return "instruction sets keep different coordinates";
    if (!same(best.counters, portable.counters)) return "instruction sets count differently";
    if (std::ranges::equal(best.taken, uncached.taken) && !same(best.counters, uncached.counters))
      return "caches change the counts";
    const ContactCallback none;
    const Stepper stepper(complex_, moves_, options_, none);
    Counters counters;  // of the steps taken
    std::vector<ParticleState> next = states_;
    detail::SimplexCache next_caches;
    for (std::size_t i = 0; i < particles; ++i) {
      const ScalarStep one = scalar_step(stepper, i, targets[i]);
      next[i] = one.state;
      const bool taken = best.taken[i] == detail::step_complete;
      bool landed = false;
      std::string error = something_in_the_way(one, i, targets[i]);
      if (error.empty() && !taken && best.taken[i] != detail::step_untouched) {
        for (const Filtered* f : {&portable, &best}) {
          if (error.empty()) error = compare_resumed(stepper, *f, one, i, targets[i], landed);
        }
        tally.resumed += 1;
        tally.landed += landed ? 1 : 0;
        count_parts(best.partial[best.taken[i]], tally);
      }
      if (error.empty()) error = compare_states(portable, best, one, i, taken, landed);
      if (error.empty()) error = compare_caches(portable, best, one, i, taken, landed, tally);
      if (error.empty()) error = compare_uncached(stepper, uncached, one, i, targets[i]);
      if (!error.empty()) return fmt::format("particle {}: {}", i, error);
      if (taken || landed)
        next_caches.push_back(best.caches[i], best.caches.flags(i));
      else
        next_caches.push_back(cache_entry(one.state));
      if (taken) counters += is_carried_to(i, targets[i]) ? counts_of_a_kept_forecast() : one.counters;
      tally.steps += 1;
      tally.taken += taken ? 1 : 0;
      tally.moved_on += taken && next[i].at() != states_[i].at() ? 1 : 0;
    }
    states_ = next;
    caches_ = random_.below(8) == 0 ? detail::SimplexCache{} : next_caches;
    return same_but_tests(best.counters, counters) ? "" : "other counts";
  }

 private:
  struct Filtered {
    std::vector<ParticleState> states;
    std::vector<detail::VertexNumbers> vertices;
    detail::SimplexCache caches;
    std::vector<detail::StepStatus> taken;
    std::vector<StepState> partial;
    Counters counters;
  };

  // The exact step of one particle, the truth for the batch.
  struct ScalarStep {
    ParticleState state;
    StepResult result;
    ContactList contacts;
    Counters counters;
  };

  ScalarStep scalar_step(const Stepper& stepper, std::size_t i, const Vec3& target) const {
    ScalarStep one{states_[i], {}, {}, {}};
    Weights weights{};
    one.result = stepper.step(static_cast<std::uint32_t>(i), one.state, weights, target, one.contacts, one.counters);
    return one;
  }

  static void count_parts(const StepState& partial, Tally& tally) {
    if (partial.slices == 1) return;
    const bool at_wall = partial.walk.end == WalkEnd::wall;
    tally.in_parts += at_wall ? 1 : 0;
    tally.carried_on += partial.carried_on ? 1 : 0;
    tally.carried_often += partial.carried_on && partial.slices > 2 ? 1 : 0;
    tally.parts_on += at_wall ? 0 : 1;
  }

  // A step whose target is inside the simplex must have no contact and no other simplex.
  std::string something_in_the_way(const ScalarStep& one, std::size_t i, const Vec3& target) const {
    const bool stays = Determinants(complex_.corners(states_[i].at()), target).all_proved_positive();
    const bool undisturbed = one.state.at() == states_[i].at() && one.contacts.contacts.empty();
    if (!stays || one.counters.steps_split != 0 || one.result.held || undisturbed) return "";
    return "something in the way within its simplex";
  }

  // Resumes a partial step, and compares it with the scalar step.
  std::string compare_resumed(const Stepper& stepper, const Filtered& batch, const ScalarStep& one, std::size_t i,
                              const Vec3& target, bool& landed) const {
    const StepState& partial = batch.partial[batch.taken[i]];
    ParticleState state = states_[i];
    Weights unused{};
    ContactList resumed;
    Counters counts;
    stepper.step(static_cast<std::uint32_t>(i), state, unused, target, resumed, counts, partial);
    if (!same_bits(state, one.state)) return "another state, resumed";
    if (!same(resumed, one.contacts)) return "other contacts, resumed";
    if (!same_but_tests(counts, one.counters)) return "other counts, resumed";
    landed = partial.knows_end();
    if (partial.carried_on && !stops_) return "carried on from a wall that it might leave";
    return landed && !partial.stays(state) ? "not where it landed" : "";
  }

  std::string compare_uncached(const Stepper& stepper, const Filtered& batch, const ScalarStep& one, std::size_t i,
                               const Vec3& target) const {
    if (batch.taken[i] == detail::step_complete)
      return same_bits(batch.states[i], one.state) && one.contacts.contacts.empty() ? "" : "another state, uncached";
    if (batch.taken[i] == detail::step_untouched) return "";
    bool landed = false;
    return compare_resumed(stepper, batch, one, i, target, landed);
  }

  // A landed particle has its old state, but the vertices of its place at the wall.
  std::string compare_states(const Filtered& portable, const Filtered& best, const ScalarStep& one, std::size_t i,
                             bool taken, bool landed) const {
    const ParticleState& expected = taken ? one.state : states_[i];
    if (!same_bits(best.states[i], expected) || !same_bits(portable.states[i], expected)) return "another state";
    if (taken && (one.result.held || !one.contacts.contacts.empty())) return "held or stopped";
    if (best.vertices[i] != detail::vertex_numbers(complex_, (landed ? one.state : expected).at()))
      return "other vertices";
    return "";
  }

  std::string compare_caches(const Filtered& portable, const Filtered& best, const ScalarStep& one, std::size_t i,
                             bool taken, bool landed, Tally& tally) const {
    if (!taken && !landed) return "";
    if (moves_) {
      const detail::SimplexCacheEntry entry = cache_entry(one.state);
      return equal(best.caches[i], entry) && equal(portable.caches[i], entry) ? "" : "other previous geometry";
    }
    if (!std::isnan(best.caches[i].w[0])) tally.remembered += 1;
    if (best.caches.flags(i) == 0) return "";
    if (landed) return "flags on a wall";
    const unsigned zeros = detail::zeros_of(complex_.corners(one.state.at()), one.state.position);
    if (best.caches.flags(i) != (detail::exact_flag | zeros)) return "other flags";
    tally.exact += 1;
    return "";
  }

  [[nodiscard]] detail::SimplexCacheEntry cache_entry(const ParticleState& state) const {
    return detail::cache_entry_of(moves_ ? detail::CacheKind::previous_geometry : detail::CacheKind::barycentric,
                                  complex_.positions(), detail::vertex_numbers(complex_, state.at()), state.position);
  }

  // Where vertices move, new ones.
  [[nodiscard]] detail::SimplexCache unknown_caches() const {
    detail::SimplexCache caches;
    for (std::size_t i = 0; i < particles && !moves_; ++i) caches.push_back(detail::unknown_entry());
    return caches;
  }

  // With the caches of the step before, or where there are none, with new ones.
  Filtered filtered(std::span<const Vec3> targets, detail::InstructionSet set,
                    const detail::SimplexCache& caches) const {
    Filtered f{states_, {}, caches, std::vector<detail::StepStatus>(particles), {}, {}};
    f.caches.resize(particles);
    for (const ParticleState& s : states_) f.vertices.push_back(detail::vertex_numbers(complex_, s.at()));
    detail::step_batch({&complex_, moves_, !caches.empty(), options_, true, stops_},
                       {f.states, f.vertices, f.caches.from(0), targets, f.taken, f.partial}, f.counters, set);
    return f;
  }

  static bool same_caches(const Filtered& a, const Filtered& b) {
    bool same = a.caches.size() == b.caches.size();
    for (std::size_t i = 0; same && i < a.caches.size(); ++i)
      same = equal(a.caches[i], b.caches[i]) && a.caches.flags(i) == b.caches.flags(i);
    return same;
  }

  // Whether the mesh carries the particle to its target: the step of one particle then does not walk.
  [[nodiscard]] bool is_carried_to(std::size_t i, const Vec3& target) const {
    if (!moves_) return false;
    const SimplexId at = states_[i].at();
    const Weights weights = detail::barycentric(previous_space(complex_).corners(at), states_[i].position);
    return detail::carried(current_space(complex_), at, weights).position == target;
  }
  static Counters counts_of_a_kept_forecast() {
    Counters counts;
    counts.particle_steps = 1;
    counts.forecast_kept = 1;
    return counts;
  }

  static bool same(const ContactList& a, const ContactList& b) {
    const auto equal_contacts = [](const Contact& x, const Contact& y) {
      return x.kind == y.kind && x.dart == y.dart && x.time_of_impact == y.time_of_impact && x.point == y.point &&
             x.wall_displacement == y.wall_displacement && x.displacement == y.displacement && x.unused == y.unused &&
             x.wall_count == y.wall_count && x.earlier == y.earlier && x.last == y.last;
    };
    const auto equal_walls = [](const WallHit& x, const WallHit& y) {
      return x.face == y.face && x.triangle == y.triangle && x.patch == y.patch && x.normal == y.normal;
    };
    return std::ranges::equal(a.contacts, b.contacts, equal_contacts) &&
           std::ranges::equal(a.walls, b.walls, equal_walls);
  }

  static bool equal(const detail::SimplexCacheEntry& a, const detail::SimplexCacheEntry& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
  }

  static bool same(const Counters& a, const Counters& b) {
    return same_but_tests(a, b) && a.orientation.tests == b.orientation.tests && a.histogram == b.histogram &&
           a.orientation.exact == b.orientation.exact;
  }
  // Far walks ask other questions in a batch.
  static bool same_but_tests(const Counters& a, const Counters& b) {
    return a.particle_steps == b.particle_steps && a.forecast_kept == b.forecast_kept &&
           a.updated_by_deformation == b.updated_by_deformation && a.contacts == b.contacts &&
           a.steps_split == b.steps_split;
  }

  Vec3 point_of(const dartcast::Corners& v) {
    Vec3 sum;
    double weights = 0.0;
    for (const Vec3& c : v) {
      const double w = on_facets_ && random_.below(8) == 0 ? 0.0 : random_.uniform();
      sum += c * w;
      weights += w;
    }
    if (weights == 0.0) return v[0];
    const Vec3 p = sum * (1.0 / weights);
    std::uint64_t exact = 0;
    const Determinants d(v, p);
    for (unsigned i = 0; i < 4; ++i) {
      if (sign_of(d, i, v, p, exact) == Sign::negative) return v[0];
    }
    return p;
  }

  // A target other than the place, but for particles that touch a wall: at rest elsewhere only the counts differ.
  Vec3 target(const ParticleState& s) {
    const Vec3 q = any_target(s);
    if (q != s.position || s.touching_count > 0) return q;
    const dartcast::Corners v = complex_.corners(s.at());
    return q + (v[1] - v[0]) * 0x1p-6;
  }

  // Mostly small steps; some to a corner, some nowhere, some out of the scene.
  Vec3 any_target(const ParticleState& s) {
    const dartcast::Corners v = complex_.corners(s.at());
    const double edge = norm(v[1] - v[0]);
    const std::uint32_t kind = random_.below(16);
    if (at_planes_ && kind > 7) return plane_target();
    if (far_away_ && kind > 7)
      return s.position + random_vector(random_) * (edge * std::exp2(random_.uniform(2.0, 5.0)));
    if (kind == 0) return s.position;
    if (kind == 1) return v[random_.below(4)];
    if (on_lattice_ && kind > 2)
      return kind < 11 ? lattice_target(s) : kind < 13 ? through_edge(s, v) : beside_facet(v);
    const double length = edge * std::exp2(random_.uniform(-6.0, kind == 2 ? 4.0 : 1.0));
    return s.position + Vec3{random_.uniform(-1, 1), random_.uniform(-1, 1), random_.uniform(-1, 1)} * length;
  }

  Vec3 plane_target() {
    Vec3 q = complex_.positions()[random_.below(static_cast<std::uint32_t>(complex_.positions().size()))];
    const std::uint32_t across = random_.below(3);
    q.x += across == 0 ? 0.0 : random_.uniform(-1, 1);
    q.y += across == 1 ? 0.0 : random_.uniform(-1, 1);
    q.z += across == 2 ? 0.0 : random_.uniform(-1, 1);
    return q;
  }

  // One of eighths, along axes and diagonals.
  Vec3 lattice_target(const ParticleState& s) {
    const double length = 0.125 * (1 + random_.below(4));
    const auto next = [&](double x) { return std::round(8.0 * x) / 8.0 + length * (random_.below(3) - 1.0); };
    return {next(s.position.x), next(s.position.y), next(s.position.z)};
  }

  // Through an edge, after a third of the step, where no double may be.
  Vec3 through_edge(const ParticleState& s, const dartcast::Corners& v) {
    const std::uint32_t first = random_.below(4);
    const Vec3& a = v[first];
    const Vec3& b = v[(first + 1 + random_.below(3)) % 4];
    return s.position + ((a + b) * 0.5 - s.position) * 3.0 + (b - a) * 0.125;
  }

  // On a facet, but for rounding.
  Vec3 beside_facet(const dartcast::Corners& v) {
    const std::uint32_t facet = random_.below(4);
    Vec3 sum;
    double weights = 0.0;
    for (std::uint32_t i = 0; i < 4; ++i) {
      const double w = i == facet ? 0.0 : random_.uniform();
      sum += v[i] * w;
      weights += w;
    }
    return sum * (1.0 / weights);
  }

  // Every vertex moves: all alike, each its own way, seldom far enough to turn cells. Sometimes one is lost until the
  // next step.
  void move() {
    const double edge = norm(complex_.positions()[1] - complex_.positions()[0]);
    const double own = edge * std::exp2(random_.uniform(-20.0, random_.below(8) == 0 ? 0.0 : -7.0));
    const Vec3 all = Vec3{random_.uniform(-1, 1), random_.uniform(-1, 1), random_.uniform(-1, 1)} * edge;
    const std::span<Vec3> next = complex_.next_positions();
    for (std::size_t i = 0; i < next.size(); ++i) {
      next[i] = mesh_.points[i] + all * 0.1 +
                Vec3{random_.uniform(-1, 1), random_.uniform(-1, 1), random_.uniform(-1, 1)} * own;
    }
    using Limits = std::numeric_limits<double>;
    if (random_.below(8) == 0)
      next[random_.below(static_cast<std::uint32_t>(next.size()))].y =
          random_.below(2) == 0 ? Limits::infinity() : Limits::quiet_NaN();
    complex_.commit_positions();
  }

  MeshData mesh_;
  CellComplex complex_;
  Random random_;
  Random stops_at_random_;
  StepOptions options_;
  bool stops_ = true;  // nothing responds
  bool moves_;
  bool on_lattice_;
  bool on_facets_;
  bool at_planes_ = false;  // some particles begin there
  bool far_away_ = false;
  std::vector<ParticleState> states_;
  detail::SimplexCache caches_;  // of these, once a step has been taken
};

class FilteredBatch : public ::testing::TestWithParam<std::tuple<int, bool>> {};

// All simplices so flat that the filter knows little of them: pressed together across no axis.
MeshData flattened(MeshData mesh, double thickness) {
  const Vec3 across = Vec3{1, 1, 1} * (1.0 / std::sqrt(3.0));
  for (Vec3& p : mesh.points) p = p - across * (dot(p, across) * (1.0 - thickness));
  return mesh;
}

// The first error in a scene, or nothing.
std::string run(BothWays scene, const std::string& name, Tally& tally) {
  if (!scene.usable()) return {};
  for (std::size_t i = 0; i < steps_per_scene; ++i) {
    const std::string wrong = scene.step(tally);
    if (!wrong.empty()) return fmt::format("{}, step {}: {}", name, i, wrong);
  }
  return {};
}

std::string run_scene(oracle::SceneKind kind, bool moves, std::uint64_t seed, Tally& tally) {
  MeshData mesh = seed % 4 == 0 ? oracle::lattice_scene(kind, seed) : oracle::random_scene(kind, seed, 0.5);
  if (seed % 4 == 1) mesh = flattened(std::move(mesh), std::exp2(-2.0 * static_cast<double>(seed % 17)));
  if (seed % 4 == 2) {  // squares of areas are beyond what normals take as they are
    for (Vec3& p : mesh.points) p *= seed % 8 == 2 ? 0x1p-180 : 0x1p+270;
  }
  const bool far = moves && seed % 4 == 3;
  if (far) {  // a carried particle is often rounded out of the simplex
    for (Vec3& p : mesh.points) p += Vec3{0x1p+30, -0x1p+31, 0x1p+29} * (seed % 8 == 3 ? 1.0 : 0x1p-12);
  }
  return run(BothWays(std::move(mesh), seed, moves, false, !moves || far),
             fmt::format("{}, seed {}", oracle::name_of(kind), seed), tally);
}

TEST_P(FilteredBatch, TakesStepsAsOneParticleDoes) {
  const auto kind = static_cast<oracle::SceneKind>(std::get<0>(GetParam()));
  const bool moves = std::get<1>(GetParam());
  Tally tally;
  const auto complaints =
      run_seeds(scaled(20, 2000), [&](std::uint64_t seed) { return run_scene(kind, moves, seed, tally); });
  for (const std::string& wrong : complaints) ADD_FAILURE() << wrong;
  // Not in slivers, nor in a few scenes, and not in so many cells that have no way on.
  if (kind == oracle::SceneKind::slivers || sanitized()) return;
  EXPECT_GT(tally.taken, moves ? tally.steps / 8 : tally.steps * 6 / 25);  // of 2,000 seeds 0.243
  EXPECT_GT(tally.moved_on, tally.steps / 50);
  EXPECT_GT(tally.resumed, tally.steps / 100);
  EXPECT_GT(tally.landed, tally.resumed / 6);
  EXPECT_TRUE(moves || tally.remembered > tally.steps / 4);
}

class LatticeBatch : public ::testing::TestWithParam<int> {};

TEST_P(LatticeBatch, TakesStepsAsOneParticleDoes) {
  const auto kind = static_cast<oracle::SceneKind>(GetParam());
  Tally tally;
  const auto complaints = run_seeds(std::max(5, scaled(20, 2000)), [&](std::uint64_t seed) {
    MeshData mesh = oracle::lattice_scene(kind, seed);
    if (seed % 4 == 0) {  // far off, a rounded place is farther from where it should be than the filter asks for
      for (Vec3& p : mesh.points) p += Vec3{0x1p+30, -0x1p+31, 0x1p+29};
    }
    return run(BothWays(std::move(mesh), seed, false, true, true),
               fmt::format("{} on integers, seed {}", oracle::name_of(kind), seed), tally);
  });
  for (const std::string& wrong : complaints) ADD_FAILURE() << wrong;
  if (sanitized()) return;
  EXPECT_GT(tally.taken, tally.steps / 4);
  EXPECT_GT(tally.exact, tally.steps / 50);
}

INSTANTIATE_TEST_SUITE_P(Scenes, LatticeBatch, ::testing::Range(0, oracle::scene_kinds), [](const auto& scene) {
  return oracle::name_of(static_cast<oracle::SceneKind>(scene.param));
});

INSTANTIATE_TEST_SUITE_P(Scenes, FilteredBatch,
                         ::testing::Combine(::testing::Range(0, oracle::scene_kinds), ::testing::Bool()),
                         [](const auto& scene) {
                           return oracle::name_of(static_cast<oracle::SceneKind>(std::get<0>(scene.param))) +
                                  (std::get<1>(scene.param) ? "_moving" : "_still");
                         });

// A walk along its line does not decide on which side of an exit a target is that lies in the exit's plane.
TEST(FilteredBatch, WalksToFarPlanes) {
  Tally tally;
  for (int kind = 0; kind < oracle::scene_kinds; ++kind) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const auto scene = static_cast<oracle::SceneKind>(kind);
      BothWays both(oracle::lattice_scene(scene, seed), seed, false, false, false);
      both.aim_at_planes();
      EXPECT_EQ(run(std::move(both), fmt::format("{}, seed {}", oracle::name_of(scene), seed), tally), "");
    }
  }
}

// Targets far away in long boxes: bent hexahedra, some of them blocked, and on integers. Walks go in and out of cells of
// another type.
TEST(FilteredBatch, WalksThroughWholeCells) {
  Tally tally;
  const auto complaints = run_seeds(std::max(12, scaled(12, 1000)), [&](std::uint64_t seed) {
    BothWays both(oracle::long_box(seed), seed, false, false, seed % 4 == 0);
    both.aim_far_away();
    return run(std::move(both), fmt::format("long box, seed {}", seed), tally);
  });
  for (const std::string& wrong : complaints) ADD_FAILURE() << wrong;
  EXPECT_GT(tally.landed, tally.steps / 8);
}

// Far targets while vertices move: many steps are split, and the batch walks their first parts.
TEST(FilteredBatch, WalksFirstPartsOfSteps) {
  Tally tally;
  const auto complaints = run_seeds(std::max(16, scaled(80, 8000)), [&](std::uint64_t seed) {
    const auto kind = static_cast<oracle::SceneKind>(seed % oracle::scene_kinds);
    MeshData mesh = seed % 2 == 0 ? oracle::long_box(seed) : oracle::random_scene(kind, seed, 0.1);
    if (seed % 8 == 0) {
      for (Vec3& p : mesh.points) p += Vec3{0x1p+20, -0x1p+21, 0x1p+19};
    }
    BothWays both(std::move(mesh), seed, true, false, seed % 4 == 0);
    both.aim_far_away();
    if (seed % 5 == 0) both.split_at_most(3);
    return run(std::move(both), fmt::format("first parts, seed {}", seed), tally);
  });
  for (const std::string& wrong : complaints) ADD_FAILURE() << wrong;
  EXPECT_GT(tally.in_parts, tally.steps / 20);
  EXPECT_GT(tally.carried_on, tally.steps / 40);
  EXPECT_GT(tally.carried_often, tally.steps / 200);
  EXPECT_GT(tally.parts_on, tally.steps / 100);
}

TEST(FilteredBatch, SeedsThatWentWrong) {
  Tally tally;
  // A determinant below the filter's bound, exact and not zero: no wall is to be looked for.
  EXPECT_EQ(run_scene(oracle::SceneKind::hexahedra, false, 855, tally), "");
  // A particle at a corner that is rounded out of its simplex when the mesh carries it.
  EXPECT_EQ(run_scene(oracle::SceneKind::flat_corners, true, 197, tally), "");
  // Far off: steps that the rule splits, as it rounds the motion up.
  EXPECT_EQ(run_scene(oracle::SceneKind::pyramids, true, 51, tally), "");
  EXPECT_EQ(run_scene(oracle::SceneKind::flat_corners, true, 43, tally), "");
  // A walk that ends on a wall of a cell that has lost a vertex: its wall's displacement was infinite.
  EXPECT_EQ(run_scene(oracle::SceneKind::prisms, true, 283, tally), "");
  EXPECT_EQ(run_scene(oracle::SceneKind::prisms, true, 435, tally), "");
  EXPECT_EQ(run_scene(oracle::SceneKind::octahedra, true, 1819, tally), "");
  EXPECT_EQ(run_scene(oracle::SceneKind::flat_corners, true, 1027, tally), "");
  // A walk through all simplices of a small scene, of which the first is tested in a round of its own.
  EXPECT_EQ(run_scene(oracle::SceneKind::prisms, false, 1949, tally), "");
}

}  // namespace dartcast::test::batch_test
