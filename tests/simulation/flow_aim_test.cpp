// Aiming four particles at a time gives the bits of aiming one, in every instruction set.
#include "simulation/flow_aim.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <vector>

#include "base/random.hpp"
#include "complex/simplex.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/vector_field.hpp"
#include "tracking/carry.hpp"

namespace dartcast::flow_aim_test {

constexpr double dt = 0.01;

// Particles in a mesh that has moved once, and the field that carries them.
class Flow {
 public:
  Flow(MeshData mesh, FieldFrame frame)
      : environment_(std::move(mesh)), field_(environment_.complex(), values(), frame) {
    const bool planar = environment_.map().dimension() == 2;
    const auto number = [&](double low, double high) { return random_.uniform(low, high); };
    std::vector<Vec3> points;
    for (int i = 0; i < 1003; ++i) points.push_back({number(0, 3), number(0, 3), planar ? 0.0 : number(0, 3)});
    environment_.add(particles_, points);
    std::vector<Vec3> moved(environment_.positions().begin(), environment_.positions().end());
    for (Vec3& x : moved) x = x * 1.01 + Vec3{0.02 * x.y, -0.01 * x.x, planar ? 0.0 : 0.01 * x.x};
    environment_.move(moved);
    for (std::size_t i = 0; i < particles_.size(); ++i) {
      velocities_.push_back({number(-1, 1), number(-1, 1), planar ? 0.0 : number(-1, 1)});
      constexpr std::array others = {ParticleStatus::stuck, ParticleStatus::absorbed, ParticleStatus::escaped};
      fates_.push_back(random_.below(10) == 0 ? others[random_.below(3)] : ParticleStatus::alive);
    }
  }

  void expect_same_bits(bool moving, bool drags) {
    const detail::FlowScene s = scene(moving, drags);
    for (const detail::InstructionSet set : {detail::InstructionSet::portable, detail::best_instruction_set()}) {
      std::vector<Vec3> velocities = velocities_;
      std::vector<Vec3> targets(velocities.size());
      std::vector<std::uint8_t> aimed(velocities.size() / 4);
      detail::aim_in_flow(s, {particles_.states(), particles_.vertex_numbers(), fates_, velocities, targets, aimed},
                          set);
      for (std::size_t i = 0; i < 4 * aimed.size(); ++i) {
        const bool is_aimed = (aimed[i / 4] >> i % 4 & 1U) != 0;
        ASSERT_EQ(is_aimed, fates_[i] == ParticleStatus::alive) << i;
        const auto [velocity, target] = is_aimed ? aim_one(s, i) : std::pair(velocities_[i], Vec3{});
        ASSERT_EQ(std::memcmp(&velocities[i], &velocity, sizeof velocity), 0) << i;
        ASSERT_EQ(std::memcmp(&targets[i], &target, sizeof target), 0) << i;
      }
    }
  }

 private:
  std::vector<Vec3> values() {
    std::vector<Vec3> values;
    for (std::size_t i = 0; i < environment_.complex().point_count(); ++i)
      values.push_back({random_.uniform(-1, 1), random_.uniform(-1, 1),
                        environment_.map().dimension() == 2 ? 0.0 : random_.uniform(-1, 1)});
    return values;
  }

  [[nodiscard]] detail::FlowScene scene(bool moving, bool drags) const {
    const CellComplex& complex = environment_.complex();
    return {complex.positions().data(),
            complex.previous_positions().data(),
            field_.values().data(),
            field_.rest().empty() ? nullptr : field_.rest().data(),
            complex.map().dimension() == 2,
            moving,
            1.0 / dt,
            0.5 * dt,
            drags,
            0.3,
            {0.1, -0.2, 0.0}};
  }

  [[nodiscard]] std::pair<Vec3, Vec3> aim_one(const detail::FlowScene& s, std::size_t i) const {
    const CellComplex& complex = environment_.complex();
    const ParticleState& state = particles_[i];
    const Corners now = complex.corners(state.at());
    const Corners before = complex.previous_corners(state.at());
    const Weights w = detail::barycentric(s.moving ? before : now, state.position);
    const Vec3 flow = field_.at(complex, state.at(), w, now);
    const auto accelerated = [&](const Vec3& in) {
      return s.drags ? velocities_[i] + (in + s.terminal - velocities_[i]) * s.lost : in;
    };
    if (field_.frame() == FieldFrame::space) {
      const Vec3 v = accelerated(flow);
      return {v, state.position + v * s.dt};
    }
    const Vec3 carried = detail::combine(now, w);
    const Vec3 mesh = (carried - detail::combine(before, w)) * s.per_move;
    const Vec3 v = accelerated(flow + mesh);
    return {v, (s.moving ? carried : state.position) + (v - mesh) * s.dt};
  }

  Random random_{7};
  Environment environment_;
  VelocityField field_;
  Particles particles_;
  std::vector<Vec3> velocities_;
  std::vector<ParticleStatus> fates_;
};

void expect_same_bits(const MeshData& mesh) {
  for (const FieldFrame frame : {FieldFrame::space, FieldFrame::mesh}) {
    Flow flow(mesh, frame);
    for (const bool moving : {false, true}) {
      for (const bool drags : {false, true}) flow.expect_same_bits(moving, drags);
    }
  }
}

TEST(FlowAim, GivesTheBitsOfOneParticleAtATime) {
  BoxOptions box;
  box.cells = {3, 3, 3};
  box.size = {3.0, 3.0, 3.0};
  box.jitter = 0.3;
  expect_same_bits(generate_box(box));
}

TEST(FlowAim, GivesTheBitsOfOneParticleAtATimeInThePlane) {
  RectangleOptions rectangle;
  rectangle.cells = {3, 3};
  rectangle.size = {3.0, 3.0};
  rectangle.jitter = 0.3;
  expect_same_bits(generate_rectangle(rectangle));
}

}  // namespace dartcast::flow_aim_test
