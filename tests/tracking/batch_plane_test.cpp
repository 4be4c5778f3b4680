// The batch of the plane against the step of one particle: the same bits wherever the batch takes a step.
#include "tracking/batch/batch_plane.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "dartcast/generators.hpp"
#include "support/particle_checks.hpp"
#include "support/seeds.hpp"
#include "support/tier.hpp"
#include "tracking/carry.hpp"
#include "tracking/step.hpp"

namespace dartcast::test::batch_plane_test {

constexpr std::size_t particle_count = 70;  // no multiple of a block
constexpr std::size_t steps_per_scene = 30;

struct PlaneTally {
  std::atomic<std::uint64_t> steps{0};
  std::atomic<std::uint64_t> taken{0};
  std::atomic<std::uint64_t> moved_on{0};  // taken into another triangle
  std::atomic<std::uint64_t> resumed{0};   // taken up to a wall
  std::atomic<std::uint64_t> split{0};
  std::atomic<std::uint64_t> exact{0};
};

bool same_counts(const Counters& a, const Counters& b) {
  return a.particle_steps == b.particle_steps && a.orientation.tests == b.orientation.tests &&
         a.orientation.exact == b.orientation.exact && a.histogram == b.histogram &&
         a.forecast_kept == b.forecast_kept && a.updated_by_deformation == b.updated_by_deformation &&
         a.steps_split == b.steps_split && a.contacts == b.contacts && a.unfinished == b.unfinished;
}

bool same_contacts(const ContactList& a, const ContactList& b) {
  if (a.contacts.size() != b.contacts.size() || a.walls.size() != b.walls.size()) return false;
  for (std::size_t i = 0; i < a.contacts.size(); ++i) {
    const Contact& x = a.contacts[i];
    const Contact& y = b.contacts[i];
    if (x.kind != y.kind || x.dart != y.dart || bits(x.point) != bits(y.point) ||
        x.time_of_impact != y.time_of_impact || bits(x.unused) != bits(y.unused))
      return false;
  }
  for (std::size_t i = 0; i < a.walls.size(); ++i) {
    if (a.walls[i].face != b.walls[i].face) return false;
  }
  return true;
}

// A scene whose particles are stepped both ways. Places and motions on a lattice make determinants
// zero.
class BothWaysInThePlane {
 public:
  explicit BothWaysInThePlane(std::uint64_t seed)
      : random_(seed, 5), moves_(seed % 3 == 0), lattice_(seed % 3 == 1), complex_(mesh(seed)) {
    std::vector<SimplexId> free;
    for (const Cell c : complex_.map().cells()) {
      for (std::uint16_t s = 0; s < complex_.map().shape(c).simplices().size(); ++s) {
        if (complex_.map().is_free(c)) free.push_back({c, s});
      }
    }
    while (states_.size() < particle_count) {
      const SimplexId at = free[random_.below(static_cast<std::uint32_t>(free.size()))];
      const PlaneCorners v = current_space<3>(complex_).corners(at);
      Vec3 x = detail::combine(v, Weights{0.25, 0.25, 0.5, 0.0});
      if (lattice_ || random_.below(4) == 0) x = v[random_.below(3)];
      if (!detail::in_closed_simplex(v, x)) continue;
      states_.emplace_back().put(at, x);
    }
  }

  // One step of all particles; what differs.
  std::string step(PlaneTally& tally) {
    if (moves_) move();
    std::vector<Vec3> targets;
    for (const ParticleState& s : states_) targets.push_back(target(s));
    std::vector<ParticleState> states = states_;
    std::vector<detail::VertexNumbers> vertices;
    for (const ParticleState& s : states) vertices.push_back(detail::vertex_numbers(complex_, s.at()));
    std::vector<detail::StepStatus> taken(particle_count);
    std::vector<StepState> partial;
    Counters counters;
    const StepOptions options;
    const bool portable = tally.steps / particle_count % 2 == 1;
    detail::step_plane({&complex_, moves_, false, options}, {states, vertices, {}, targets, taken, partial}, counters,
                       portable ? detail::InstructionSet::portable : detail::best_instruction_set());
    const ContactCallback none;
    const Stepper stepper(complex_, moves_, options, none);
    Counters expected;
    for (std::uint32_t i = 0; i < particle_count; ++i) {
      ParticleState next = states_[i];
      Weights weights{};
      ContactList contacts;
      Counters own;
      const StepResult result = stepper.step(i, next, weights, targets[i], contacts, own);
      const bool all = taken[i] == detail::step_complete;
      if (!all && taken[i] != detail::step_untouched) {
        ParticleState state = states_[i];
        ContactList resumed;
        Counters counts;
        stepper.step(i, state, weights, targets[i], resumed, counts, partial[taken[i]]);
        if (!same_bits(state, next)) return fmt::format("particle {}: another state, resumed", i);
        if (!same_contacts(resumed, contacts)) return fmt::format("particle {}: other contacts, resumed", i);
        if (!same_counts(counts, own)) return fmt::format("particle {}: other counts, resumed", i);
        ++tally.resumed;
      }
      if (!same_bits(states[i], all ? next : states_[i])) return fmt::format("particle {}: another state", i);
      if (all && (result.held || !contacts.contacts.empty())) return fmt::format("particle {}: held or stopped", i);
      if (vertices[i] != detail::vertex_numbers(complex_, states[i].at()))
        return fmt::format("particle {}: other vertices", i);
      if (all) expected += own;
      ++tally.steps;
      tally.taken += all ? 1 : 0;
      tally.moved_on += all && next.at() != states_[i].at() ? 1 : 0;
      tally.split += own.steps_split;
      states_[i] = next;
    }
    tally.exact += counters.orientation.exact;
    return same_counts(counters, expected) ? "" : "other counts";
  }

 private:
  [[nodiscard]] MeshData mesh(std::uint64_t seed) const {
    RectangleOptions o;
    o.cells = {7, 5};
    o.size = {7.0, 5.0};
    o.mixed = true;
    o.jitter = lattice_ ? 0.0 : 0.25;
    o.blocked_share = 0.2;
    o.seed = seed;
    MeshData mesh = generate_rectangle(o);
    if (moves_ && seed % 2 == 1) {  // far off, a carried particle is often rounded out of the triangle
      for (Vec3& p : mesh.points) p += Vec3{0x1p+30, -0x1p+31, 0.0};
    }
    return mesh;
  }

  // Every vertex, a little at most steps, and much at some.
  void move() {
    const std::span<Vec3> next = complex_.next_positions();
    const double by = random_.below(4) == 0 ? 0.1 : 0.01;
    for (Vec3& x : next) x += Vec3{random_.uniform(-by, by), random_.uniform(-by, by), 0.0};
    complex_.commit_positions();
  }

  Vec3 target(const ParticleState& s) {
    if (moves_ && s.touching_count > 0 && random_.below(4) == 0) return carried(s);  // it goes on touching
    if (lattice_) {
      const auto by = [&] { return 0.25 * (static_cast<double>(random_.below(9)) - 4.0); };
      return s.position + Vec3{by(), by(), 0.0};
    }
    const double reach = random_.below(8) == 0 ? 2.0 : 0.1;
    return s.position + Vec3{random_.uniform(-reach, reach), random_.uniform(-reach, reach), 0.0};
  }

  [[nodiscard]] Vec3 carried(const ParticleState& s) const {
    const Weights weights = detail::barycentric(previous_space<3>(complex_).corners(s.at()), s.position);
    return detail::carried(current_space<3>(complex_), s.at(), weights).position;
  }

  Random random_;
  bool moves_;
  bool lattice_;
  CellComplex complex_;
  std::vector<ParticleState> states_;
};

TEST(FilteredPlane, TakesTheSameStepsToTheBit) {
  PlaneTally tally;
  const auto complaints = run_seeds(scaled(150, 5000), [&](std::uint64_t seed) -> std::string {
    BothWaysInThePlane scene(seed);
    for (std::size_t step = 0; step < steps_per_scene; ++step) {
      const std::string wrong = scene.step(tally);
      if (!wrong.empty()) return fmt::format("seed {}, step {}: {}", seed, step, wrong);
    }
    return "";
  });
  for (const std::string& complaint : complaints) ADD_FAILURE() << complaint;
  EXPECT_GT(tally.taken, tally.steps / 2);
  EXPECT_GT(tally.moved_on, tally.steps / 20);
  EXPECT_GT(tally.resumed, tally.steps / 20);
  EXPECT_GT(tally.split, 0U);
  EXPECT_GT(tally.exact, 0U);
}

}  // namespace dartcast::test::batch_plane_test
