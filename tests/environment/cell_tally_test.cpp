// Tallies against traces, against the mean chord, and against themselves: in threads, in any order, over edits.
#include "dartcast/cell_tally.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

#include "base/exact_sum.hpp"
#include "base/random.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/remeshing.hpp"
#include "dartcast/response.hpp"
#include "dartcast/spheres.hpp"
#include "support/expectations.hpp"
#include "support/random_vectors.hpp"
#include "tracking/place_in_simplex.hpp"
#include "tracking/tally_amount.hpp"

namespace dartcast::test::cell_tally_test {

MeshData box(std::uint32_t edge, double blocked = 0.0) {
  BoxOptions options;
  options.cells = {edge, edge, edge};
  options.size = {double(edge), double(edge), double(edge)};
  options.blocked_layer = true;
  options.blocked_share = blocked;
  return generate_box(options);
}

// Particles that rebound in a box, which may twist. Every step is traced first, and summed by cell from its crossings.
class Bouncing {
 public:
  explicit Bouncing(unsigned threads = 1, bool backward = false, double cells = 0.7)
      : environment(box(8, 0.1), Threads{threads}), tally(environment.complex()) {
    Random random(7);
    const std::vector<Vec3> rest(environment.positions().begin(), environment.positions().end());
    rest_ = rest;
    while (places_.size() < 3000) {
      places_.push_back({random.uniform(1.1, 6.9), random.uniform(1.1, 6.9), random.uniform(1.1, 6.9)});
      velocities_.push_back(random_vector(random) * cells);
    }
    if (backward) {
      std::reverse(places_.begin(), places_.end());
      std::reverse(velocities_.begin(), velocities_.end());
    }
    std::vector<Vec3> kept;
    const auto added = environment.add(particles, places_);
    for (std::size_t i = 0; i < added.size(); ++i) {
      if (added[i].location.place == Place::free) kept.push_back(velocities_[i]);
    }
    velocities_ = kept;
    statuses_.assign(kept.size(), ParticleStatus::alive);
    environment.set_tally(&tally);
  }

  void step(bool moves, bool traced) {
    if (moves) {
      ++moves_;
      std::vector<Vec3> now = rest_;
      for (Vec3& x : now) x.x += 0.05 * std::sin(0.3 * moves_) * x.z;
      environment.move(now);
    }
    std::vector<Vec3> targets;
    for (std::size_t i = 0; i < particles.size(); ++i) targets.push_back(particles[i].position + velocities_[i]);
    const WallResponses responses(Reflect{1.0});
    if (traced) trace(targets, responses);
    environment.advance(particles, targets, respond_with(responses, velocities_, statuses_, 1.0));
  }

  std::map<Cell, double> time;  // traced
  Environment environment;
  CellTally tally;
  Particles particles;

 private:
  void trace(std::span<const Vec3> targets, const WallResponses& responses) {
    for (std::size_t i = 0; i < particles.size(); ++i) {
      std::vector<Vec3> velocities = velocities_;
      std::vector<ParticleStatus> statuses = statuses_;
      const Trace t =
          environment.trace(particles, i, targets.subspan(i, 1), respond_with(responses, velocities, statuses, 1.0))
              .at(0);
      double last = 0.0;
      Cell cell = t.before.cell;
      for (const Crossing& c : t.crossings) {
        time[cell] += c.time - last;
        last = c.time;
        cell = c.to;
      }
      time[cell] += 1.0 - last;
    }
  }

  int moves_ = 0;
  std::vector<Vec3> rest_;
  std::vector<Vec3> places_;
  std::vector<Vec3> velocities_;
  std::vector<ParticleStatus> statuses_;
};

TEST(CellTally, HasTheTimesOfTraces) {
  for (const bool moves : {false, true}) {
    Bouncing run;
    for (int step = 0; step < 3; ++step) run.step(moves, true);
    for (const auto& [cell, time] : run.time) EXPECT_NEAR(run.tally.residence(cell), time, 1e-9);
    EXPECT_TRUE(run.tally.adds_up());
    EXPECT_EQ(run.tally.age(), 3.0 * double(run.particles.size()));
  }
}

TEST(CellTally, IsTheSameForAnyThreadsAndOrder) {
  for (const bool moves : {false, true}) {
    std::vector<std::vector<std::uint64_t>> words;
    for (const auto& [threads, backward] : {std::pair{1U, false}, {4U, false}, {3U, true}}) {
      Bouncing run(threads, backward, 0.2);
      for (int step = 0; step < 20; ++step) run.step(moves, false);
      EXPECT_TRUE(run.tally.adds_up());
      words.push_back(run.tally.words());
    }
    EXPECT_EQ(words[0], words[1]);
    EXPECT_EQ(words[0], words[2]);
  }
}

// The states are those of a run without one.
TEST(CellTally, ChangesNoStep) {
  Bouncing with;
  Bouncing without;
  without.environment.set_tally(nullptr);
  for (int step = 0; step < 20; ++step) {
    with.step(step % 2 == 1, false);
    without.step(step % 2 == 1, false);
  }
  for (std::size_t i = 0; i < with.particles.size(); ++i) {
    ASSERT_EQ(with.particles[i].position, without.particles[i].position);
    ASSERT_EQ(with.particles[i].at(), without.particles[i].at());
  }
}

// Amounts of all sizes: their sum is that of exact numbers. An amount of 1 is shared as the time is.
TEST(CellTally, SharesAmountsByTimeAndKeepsClassesApart) {
  for (const bool moves : {false, true}) {
    std::vector<std::vector<std::uint64_t>> words;
    for (const auto& [threads, backward] : {std::pair{1U, false}, {4U, false}, {3U, true}}) {
      Bouncing run(threads, backward, 0.4);
      const std::size_t count = run.particles.size();
      CellTally tally(run.environment.complex(), 2, 2);
      std::vector<std::uint32_t> classes(count);
      std::vector<double> amounts(2 * count);
      ExactSum sum;
      Random random(3);
      for (std::size_t k = 0; k < count; ++k) {
        const std::size_t i = backward ? count - 1 - k : k;
        classes[i] = k % 3 == 0 ? 1 : 0;
        amounts[2 * i] = classes[i] == 1 ? -2.0 : 1.0;
        amounts[2 * i + 1] = std::ldexp(random.uniform(-1.0, 1.0), static_cast<int>(random.uniform(-90.0, 60.0)));
        for (int step = 0; step < 5; ++step) sum.add(amounts[2 * i + 1]);
      }
      run.environment.set_tally(&tally, {{}, classes, amounts});
      for (int step = 0; step < 5; ++step) run.step(moves, false);
      EXPECT_TRUE(tally.adds_up());
      EXPECT_DOUBLE_EQ(tally.whole_amount(1), sum.value());
      EXPECT_EQ(tally.whole_amount(0), 5.0 * (double(count) - 3.0 * std::ceil(double(count) / 3.0)));
      for (const Cell c : run.environment.map().cells()) {
        EXPECT_NEAR(tally.amount(c, 0, 0), tally.residence(c, 0), 1e-12);
        EXPECT_NEAR(tally.amount(c, 0, 1), -2.0 * tally.residence(c, 1), 1e-12);
        EXPECT_EQ(tally.visits(c), tally.visits(c, 0) + tally.visits(c, 1));
        EXPECT_NEAR(tally.track_length(c), tally.track_length(c, 0) + tally.track_length(c, 1), 1e-12);
      }
      words.push_back(tally.words());
    }
    EXPECT_EQ(words[0], words[1]);
    EXPECT_EQ(words[0], words[2]);
  }
}

TEST(CellTally, SharesAmountsOfEditedCells) {
  Bouncing run;
  CellTally tally(run.environment.complex(), 2, 1);
  std::vector<std::uint32_t> classes(run.particles.size());
  std::vector<double> amounts(run.particles.size());
  for (std::size_t i = 0; i < classes.size(); ++i) {
    classes[i] = i % 2;
    amounts[i] = -1e-7 * double(i % 11);
  }
  run.environment.set_tally(&tally, {{}, classes, amounts});
  run.step(false, false);
  const double whole = tally.whole_amount(0);
  Environment& e = run.environment;
  const auto by_source = [&] {
    std::map<std::uint32_t, double> sums;
    for (const Cell c : e.map().cells()) sums[e.map().source(c)] += tally.amount(c, 0);
    return sums;
  };
  const std::map<std::uint32_t, double> before = by_source();
  const Cell divided = run.particles[0].cell;
  e.edit([&](ComplexEdit& edit) { subdivide(edit, divided); });
  e.update_after_edit(run.particles);
  tally.update_after_edit(e.complex(), e.last_edit());
  EXPECT_TRUE(tally.adds_up());
  EXPECT_EQ(tally.whole_amount(0), whole);
  for (const auto& [source, sum] : by_source()) EXPECT_NEAR(sum, before.at(source), -1e-12 * whole);
  CellTally other(e.complex(), 2, 1);
  other.set_words(tally.words());
  EXPECT_EQ(other.words(), tally.words());
  std::vector<std::uint64_t> twice = tally.words();  // as two ranks add them up
  for (std::uint64_t& w : twice) w += w;
  other.set_words(twice);
  EXPECT_EQ(other.whole_amount(0), 2.0 * whole);
  EXPECT_TRUE(other.adds_up());
  CellTally narrow(e.complex());
  EXPECT_THROW(narrow.set_words(tally.words()), InvalidArgument);
}

TEST(CellTally, RefusesValuesThatDoNotFit) {
  Environment environment(box(4), Threads{1});
  CellTally tally(environment.complex(), 2, 1);
  Particles particles;
  const Vec3 from{1.5, 1.6, 1.7};
  environment.add(particles, {&from, 1});
  const auto refused = [&](const TalliedParticles& values) {
    environment.set_tally(&tally, values);
    return refusal([&] { environment.advance(particles, {&from, 1}); });
  };
  const std::vector<std::uint32_t> high = {2};
  const std::vector<std::uint32_t> many = {0, 1};
  const std::vector<double> infinite = {HUGE_VAL};
  const std::vector<double> two = {1.0, 2.0};
  expect_parts(refused({{}, high, {}}), {"class 2", "has 2"});
  expect_parts(refused({{}, many, {}}), {"2 classes for 1 particles"});
  expect_parts(refused({{}, {}, infinite}), {"not finite"});
  expect_parts(refused({{}, {}, two}), {"2 amounts for 1 particles"});
  EXPECT_THROW(CellTally(environment.complex(), 0), InvalidArgument);
  EXPECT_THROW(CellTally(environment.complex(), 1, 257), InvalidArgument);
}

// Signs, carries over all parts, and both ends of the range.
TEST(CellTally, AddsAmountsExactly) {
  for (const double x : {0.0, 1.0, -1.0, 0.1, -3e24, 0x1p-170, -0x1.8p-169, 0x1p-171, 0x1p84, -1e300, 5e-324})
    EXPECT_EQ(detail::tally_amount(x).value(), std::abs(x) < 0x1p-170 ? 0.0 : std::clamp(x, -0x1p84, 0x1p84)) << x;
  detail::TallyAmount sum;
  ExactSum truth;
  Random random(5);
  for (int i = 0; i < 10'000; ++i) {
    const double x = std::ldexp(random.uniform(-1.0, 1.0), static_cast<int>(random.uniform(-60.0, 80.0)));
    add_to(sum, detail::tally_amount(x));
    truth.add(x);
    if (i % 100 != 0) continue;
    EXPECT_DOUBLE_EQ(sum.value(), truth.value());
  }
}

double volume_of(const CellComplex& complex, Cell c) {
  double volume = 0.0;
  for (std::uint16_t s = 0; s < complex.map().shape(c).simplices().size(); ++s) {
    const Corners v = complex.corners({c, s});
    volume += std::abs(dot(cross(v[1] - v[0], v[2] - v[0]), v[3] - v[0])) / 6.0;
  }
  return volume;
}

double surface_of(const CellComplex& complex, Cell c) {
  double area = 0.0;
  const CellView cell = complex.map().view(c);
  for (const ImplicitSimplex& s : cell.shape().simplices()) {
    for (unsigned i = 0; i < 4; ++i) {
      if (!s.across[i].outer()) continue;
      Vec3 v[3];
      for (unsigned k = 0, n = 0; k < 4; ++k) {
        if (k != i) v[n++] = complex.positions()[cell.vertex(s.vertex[k]).value];
      }
      area += 0.5 * norm(cross(v[1] - v[0], v[2] - v[0]));
    }
  }
  return area;
}

// Isotropic tracks: on average a cell that one visits has 4 V / S of it.
TEST(CellTally, HasTheMeanChord) {
  for (const bool octahedra : {false, true}) {
    BoxOptions options;
    options.cells = {9, 9, 9};
    options.size = {9.0, 9.0, 9.0};
    Environment environment(
        octahedra ? generate_octahedra({.cells = {9, 9, 9}, .size = Vec3{9.0, 9.0, 9.0}}) : generate_box(options),
        Threads{1});
    CellTally tally(environment.complex());
    environment.set_tally(&tally);
    const Cell middle = environment.locate({4.5, 4.5, 4.5}).simplex.cell;
    Random any(11);
    std::vector<Vec3> from;
    std::vector<Vec3> to;
    while (from.size() < 20'000) {  // lines that may meet the cell in the middle, all alike
      const double z = any.uniform(-1, 1);
      const double around = any.uniform(0, 2 * std::numbers::pi);
      const double ring = std::sqrt(1 - z * z);
      const Vec3 d{ring * std::cos(around), ring * std::sin(around), z};
      const Vec3 x = unit_of(cross(d, Vec3{0.3, 0.5, 0.8}));
      const double angle = any.uniform(0, 2 * std::numbers::pi);
      const double radius = std::sqrt(any.uniform(0, 1));
      const Vec3 at = Vec3{4.5, 4.5, 4.5} + x * (radius * std::cos(angle)) + cross(d, x) * (radius * std::sin(angle));
      from.push_back(at - d * 3.0);
      to.push_back(at + d * 3.0);
    }
    Particles particles;
    environment.add(particles, from);
    ASSERT_EQ(particles.size(), from.size());
    environment.advance(particles, to);
    EXPECT_NEAR(tally.path_length(), 6.0 * double(from.size()), 1e-6);
    EXPECT_TRUE(tally.adds_up());
    const double chord = 4.0 * volume_of(environment.complex(), middle) / surface_of(environment.complex(), middle);
    EXPECT_NEAR(tally.track_length(middle) / double(tally.visits(middle)), chord, 0.02 * chord);
  }
}

// Where other codes have lost cells: along the common faces and edges of hexahedra, from a vertex to a vertex.
TEST(CellTally, CountsPiecesAlongFacesOnce) {
  for (const Vec3& way : {Vec3{4, 0, 0}, Vec3{4, 4, 0}, Vec3{4, 4, 4}, Vec3{4, 2, 0}, Vec3{4, 2, 1}}) {
    Environment environment(box(8), Threads{1});
    CellTally tally(environment.complex());
    environment.set_tally(&tally);
    Particles particles;
    const Vec3 start{2, 2, 2};
    environment.add(particles, {&start, 1});
    const Vec3 end = start + way;
    environment.advance(particles, {&end, 1});
    EXPECT_EQ(particles[0].position, end);
    EXPECT_TRUE(tally.adds_up());
    EXPECT_NEAR(tally.path_length(), norm(way), 1e-14 * norm(way));
    double sum = 0.0;
    for (const Cell c : environment.map().cells()) sum += tally.track_length(c);
    EXPECT_NEAR(sum, norm(way), 1e-14 * norm(way));
  }
}

// As in openmc-dev/openmc#3622: tracks so near to edges and vertices that cells get pieces of a millionth. None is missed. The
// truth cuts the track at all planes of the lattice, in exact numbers.
TEST(CellTally, MissesNoCellBesideEdges) {
  Environment environment(box(8), Threads{1});
  CellTally tally(environment.complex());
  environment.set_tally(&tally);
  std::map<std::array<int, 3>, double> truth;
  std::vector<Vec3> from;
  std::vector<Vec3> to;
  std::size_t shortest = 0;
  for (const Vec3& way : {Vec3{4, 4, 4}, Vec3{4, 4, 0}, Vec3{4, -4, 0}, Vec3{4, 2, -2}}) {
    for (const double near : {0x1p-20, -0x1p-24, 0x1p-30}) {
      const Vec3 x = Vec3{2.5, way.y < 0 ? 6.5 : 2.5, way.z < 0 ? 6.5 : 2.5} + Vec3{0.0, near, -3.0 * near};
      from.push_back(x);
      to.push_back(x + way);
      std::vector<double> cuts = {0.0, 1.0};
      for (int k = 0; k < 9; ++k) {
        for (const auto& [at, along] : {std::pair{x.x, way.x}, {x.y, way.y}, {x.z, way.z}}) {
          const double t = along == 0.0 ? -1.0 : (k - at) / along;
          if (t > 0.0 && t < 1.0) cuts.push_back(t);
        }
      }
      std::sort(cuts.begin(), cuts.end());
      for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        if (cuts[i] == cuts[i + 1]) continue;
        const Vec3 middle = x + way * (0.5 * (cuts[i] + cuts[i + 1]));
        const double length = norm(way) * (cuts[i + 1] - cuts[i]);
        if (length < 1e-5) ++shortest;
        truth[{int(middle.x), int(middle.y), int(middle.z)}] += length;
      }
    }
  }
  EXPECT_GT(shortest, 20U);
  Particles particles;
  environment.add(particles, from);
  environment.advance(particles, to);
  for (const Cell c : environment.map().cells()) {
    Vec3 middle;
    for (const std::uint32_t v : environment.map().view(c).vertices()) middle += environment.positions()[v] * 0.125;
    const auto found = truth.find({int(middle.x), int(middle.y), int(middle.z)});
    EXPECT_NEAR(tally.track_length(c), found == truth.end() ? 0.0 : found->second, 1e-14);
    EXPECT_EQ(tally.visits(c) + (tally.track_length(c) > 0.0 ? 1U : 0U) > 0U, found != truth.end());
  }
}

TEST(CellTally, SharesSumsOfEditedCells) {
  Bouncing run;
  for (int step = 0; step < 5; ++step) run.step(false, false);
  const double length = run.tally.path_length();
  Environment& e = run.environment;
  for (int i = 0; i < 20; ++i) {
    const std::vector<Cell> cells = e.map().cells();
    const Cell c = cells[(37U * unsigned(i)) % cells.size()];
    e.edit([&](ComplexEdit& edit) { split_edge(edit.topology(), {c, static_cast<std::uint16_t>(i % 20)}); });
    e.update_after_edit(run.particles);
    run.tally.update_after_edit(e.complex(), e.last_edit());
    EXPECT_TRUE(run.tally.adds_up());
  }
  EXPECT_EQ(run.tally.path_length(), length);
  CellTally other(e.complex());
  other.set_words(run.tally.words());
  EXPECT_EQ(other.words(), run.tally.words());
  EXPECT_THROW(other.set_words(std::vector<std::uint64_t>(3)), InvalidArgument);
}

TEST(CellTally, RefusesStepsAfterAMissedEdit) {
  Environment environment(box(4), Threads{1});
  CellTally tally(environment.complex());
  environment.set_tally(&tally);
  Particles particles;
  const Vec3 from{1.5, 1.6, 1.7};
  environment.add(particles, {&from, 1});
  environment.edit([&](ComplexEdit& e) { subdivide(e, particles[0].cell); });
  environment.update_after_edit(particles, OrphanPolicy::relocate);
  const Vec3 to{2.5, 1.6, 1.7};
  expect_parts(refusal([&] { environment.advance(particles, {&to, 1}); }), {"advance", "missed an edit"});
  expect_parts(refusal([&] {
                 advance_spheres(environment, particles, std::vector<double>{0.1}, {&to, 1}, {});
               }),
               {"missed an edit"});
  tally.update_after_edit(environment.complex(), environment.last_edit());
  environment.advance(particles, {&to, 1});
  EXPECT_TRUE(tally.adds_up());
}

TEST(CellTally, TakesSpheresStraight) {
  Environment environment(box(4), Threads{1});
  CellTally tally(environment.complex());
  environment.set_tally(&tally);
  Particles particles;
  const std::vector<Vec3> from = {{1.5, 2.2, 2.3}, {1.7, 1.6, 2.4}};
  environment.add(particles, from);
  const std::vector<Vec3> to = {{2.5, 2.2, 2.3}, {1.7, 1.6, 9.0}};
  advance_spheres(environment, particles, std::vector<double>{0.1, 0.1}, to, {});
  EXPECT_EQ(environment.tally(), &tally);
  EXPECT_TRUE(tally.adds_up());
  EXPECT_EQ(tally.age(), 2.0);
  EXPECT_NEAR(tally.path_length(), norm(particles[0].position - from[0]) + norm(particles[1].position - from[1]),
              1e-12);
}

// A point is counted alike if it is alone and beside spheres. A response that throws leaves the tally as it was.
TEST(CellTally, CountsPointsBesideSpheresByTheirWalks) {
  const auto words = [](std::vector<Vec3> from, std::vector<Vec3> to, const std::vector<double>& radii) {
    Environment environment(box(4), Threads{1});
    CellTally tally(environment.complex());
    environment.set_tally(&tally);
    Particles particles;
    environment.add(particles, from);
    const ContactCallback back = [](const Contact& c, std::span<const WallHit>, std::span<const WallHit>) {
      return AfterContact{c.unused * -0.5};
    };
    advance_spheres(environment, particles, radii, to, back);
    const std::vector<std::uint64_t> counted = tally.words();
    unsigned calls = 0;
    const ContactCallback bad = [&](const Contact& c, std::span<const WallHit>, std::span<const WallHit>) {
      if (++calls == radii.size()) throw std::runtime_error("user");
      return AfterContact{c.unused * -0.5};
    };
    for (Vec3& x : to) x = {2, 2, 9};
    EXPECT_THROW(advance_spheres(environment, particles, radii, to, bad), std::runtime_error);
    EXPECT_EQ(tally.words(), counted);
    return counted;
  };
  const Vec3 point{1.7, 1.6, 2.4};
  const Vec3 sphere{1.5, 2.2, 2.3};
  const Vec3 to{1.7, 1.6, 9.0};
  const std::vector<std::uint64_t> together = words({point, sphere}, {to, to}, {0.0, 0.125});
  const std::vector<std::uint64_t> of_point = words({point}, {to}, {0.0});
  const std::vector<std::uint64_t> of_sphere = words({sphere}, {to}, {0.125});
  EXPECT_NE(of_point, of_sphere);
  Environment environment(box(4), Threads{1});
  CellTally sum(environment.complex());
  std::vector<std::uint64_t> added = of_point;
  for (std::size_t i = 0; i < added.size(); ++i) added[i] += of_sphere[i];
  sum.set_words(added);
  EXPECT_EQ(sum.words(), together);
}

TEST(CellTally, TakesBackTheTimeAfterLeaving) {
  Environment environment(box(4), Threads{1});
  CellTally tally(environment.complex());
  environment.set_tally(&tally);
  Particles particles;
  const Vec3 from{1.5, 1.6, 1.7};
  const Vec3 to{3.5, 1.6, 1.7};
  environment.add(particles, {&from, 1});
  const StepReport report = environment.advance(particles, {&to, 1});
  tally.take_back(particles[0].cell, 1.0 - report.contacts.contacts.at(0).time_of_impact);
  EXPECT_NEAR(tally.age(), 0.75, 1e-12);
  EXPECT_TRUE(tally.adds_up());
  const RoundCallback rounds = [](const ContactList&, std::span<AfterContact>) {};
  EXPECT_THROW(environment.advance_in_rounds(particles, {&to, 1}, rounds), InvalidArgument);
}

}  // namespace dartcast::test::cell_tally_test
