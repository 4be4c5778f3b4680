// What particles keep of their simplexes for the next move, against particles that keep nothing: the same bits,
// whatever is done to the set in between.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "dartcast/base/random.hpp"
#include "dartcast/environment/environment.hpp"
#include "dartcast/mesh/generate_box.hpp"
#include "environment/particle_checks.hpp"
#include "tier.hpp"

namespace dartcast::test {
namespace {

class Trails : public ::testing::Test {
 protected:
  static constexpr std::size_t particles = 300;

  static Environment make_environment() {
    BoxOptions box;
    box.cells = {5, 5, 5};
    box.size = {5, 5, 5};
    box.blocked_share = 0.2;
    box.blocked_layer = true;
    return Environment(generate_box(box), Threads{2});
  }

  // Every vertex sways in its own rhythm.
  void move() {
    ++time_;
    std::span<Vec3> next = environment_.next_positions();
    for (std::size_t i = 0; i < rest_.size(); ++i) {
      const double phase = 0.4 * time_ + static_cast<double>(i);
      next[i] = rest_[i] + Vec3{std::sin(phase), std::cos(1.3 * phase), std::sin(0.7 * phase)} * 0.2;
    }
    environment_.move();
  }

  void add(std::size_t count) {
    while (set_.size() < count) {
      const Vec3 p{random_.uniform(1, 4), random_.uniform(1, 4), random_.uniform(1, 4)};
      environment_.add(set_, std::span<const Vec3>(&p, 1));
    }
  }

  // The same particles without anything kept.
  [[nodiscard]] Particles bare() const {
    std::vector<Weights> weights;
    for (std::size_t i = 0; i < set_.size(); ++i) weights.push_back(set_.held_weights(i));
    return environment_.restored(set_.states(), weights);
  }

  void disturb(std::uint32_t how) {
    std::vector<std::uint32_t> order(set_.size());
    std::iota(order.rbegin(), order.rend(), 0U);
    std::vector<std::uint8_t> marks(set_.size());
    for (std::size_t i = 0; i < marks.size(); ++i) marks[i] = random_.below(4) == 0 ? 1 : 0;
    switch (how) {
      case 0: return set_.reorder(order);
      case 1: return set_.remove(marks);
      case 2: return add(set_.size() + 20);
      case 3: environment_.advance(set_, targets()); return;  // the scene stands still meanwhile
      default: return;
    }
  }

  std::vector<Vec3> targets() {
    std::vector<Vec3> all;
    for (const State& s : set_.states()) {
      all.push_back(s.position + Vec3{random_.uniform(-1, 1), random_.uniform(-1, 1), random_.uniform(-1, 1)} * 0.3);
    }
    return all;
  }

  Environment environment_ = make_environment();
  std::vector<Vec3> rest_{environment_.positions().begin(), environment_.positions().end()};
  Random random_{7};
  Particles set_;
  double time_ = 0.0;
};

TEST_F(Trails, ChangeNothing) {
  std::uint64_t contacts = 0;
  for (int step = 0; step < std::max(30, scaled(60, 2000)); ++step) {
    add(particles);
    disturb(random_.below(6));
    Particles without = bare();
    const std::vector<Vec3> to = targets();
    move();
    const StepReport one = environment_.advance(set_, to);
    const StepReport other = environment_.advance(without, to);
    ASSERT_TRUE(same_bits(copy_of(set_), without)) << "step " << step;
    ASSERT_EQ(one.counters.orientation.tests, other.counters.orientation.tests) << "step " << step;
    const auto same = [](const Contact& a, const Contact& b) {
      return a.particle == b.particle && a.time_of_impact == b.time_of_impact && bits(a.point) == bits(b.point);
    };
    ASSERT_TRUE(std::ranges::equal(one.contacts.contacts, other.contacts.contacts, same)) << "step " << step;
    contacts += one.contacts.contacts.size();
  }
  EXPECT_GT(contacts, 100U);
}

}  // namespace
}  // namespace dartcast::test
