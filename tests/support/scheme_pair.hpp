// The library and the paper's scheme over the same scene, and how they compare.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/random.hpp"
#include "bench/paper_scheme.hpp"
#include "dartcast/environment.hpp"

namespace dartcast::test {

template <class Scheme>
struct SchemePair {
  /// `places(random)`: where particles are added.
  template <class Places>
  SchemePair(MeshData mesh, Places&& places)
      : environment(std::move(mesh), Threads{1}), scheme(environment.complex()), random(7) {
    environment.add(particles, places(random));
    scheme.start(particles.states());
    results.resize(particles.size());
    targets.resize(particles.size());
  }

  /// Targets at random, up to `reach` along each axis that the scene has.
  void aim(double reach) {
    const bool flat = environment.map().dimension() == 2;
    const auto by = [&] { return random.uniform(-reach, reach); };
    for (std::size_t i = 0; i < targets.size(); ++i)
      targets[i] = particles[i].position + (flat ? Vec3{by(), by(), 0.0} : Vec3{by(), by(), by()});
  }

  /// One step of both, which then go on from where the library's particles are.
  void step(const ContactCallback& respond = {}) {
    scheme.advance(targets, results);
    const StepReport report = environment.advance(particles, targets, respond);
    std::vector<const Contact*> first(particles.size(), nullptr);
    for (const Contact& c : report.contacts.contacts) {
      if (first[c.particle] == nullptr) first[c.particle] = &c;
    }
    for (std::uint32_t i = 0; i < particles.size(); ++i) {
      compare(i, first[i], report.contacts);
      const ParticleState& s = particles[i];
      if (first[i] != nullptr || scheme.position(i) != s.position || scheme.cell(i) != s.cell)
        scheme.place(i, s.position, s.cell);
    }
  }

  /// Counts what differs: hit or not, the wall, the cell of arrival, the time.
  void compare(std::uint32_t i, const Contact* contact, const ContactList& list) {
    const bench::PaperResult& r = results[i];
    ++steps;
    tests += r.tests;
    least = std::min(least, r.tests);
    hits += contact != nullptr ? 1 : 0;
    bool same = (r.end == bench::PaperEnd::collision) == (contact != nullptr) && r.end != bench::PaperEnd::error;
    if (same && contact != nullptr) {
      const auto walls = list.walls_of(*contact);
      same = std::any_of(walls.begin(), walls.end(), [&](const WallHit& w) { return w.face == r.wall; });
      if (same) worst_time = std::max(worst_time, std::abs(r.time - contact->time_of_impact));
    } else if (same) {
      same = scheme.cell(i) == particles[i].cell;
    }
    differ += same ? 0 : 1;
  }

  [[nodiscard]] double tests_per_step() const { return static_cast<double>(tests) / static_cast<double>(steps); }

  Environment environment;
  Particles particles;
  Scheme scheme;
  Random random;
  std::vector<bench::PaperResult> results;
  std::vector<Vec3> targets;
  std::uint64_t steps = 0, tests = 0, hits = 0, differ = 0;
  std::uint32_t least = 1000;
  double worst_time = 0.0;
};

}  // namespace dartcast::test
