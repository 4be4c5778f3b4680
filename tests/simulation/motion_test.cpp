// Motions of four vertices at a time against one vertex at a time, in every instruction set.
#include "simulation/motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "base/random.hpp"

namespace dartcast::motion_test {

constexpr std::size_t count = 103;

void expect_same_bits(std::span<const Vec3> a, std::span<const Vec3> b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(std::memcmp(&a[i], &b[i], sizeof a[i]), 0) << i;
}

std::vector<Vec3> random_vectors(Random& random, double size) {
  std::vector<Vec3> v(count);
  for (Vec3& x : v) x = {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
  return v;
}

DeformationStep step_of(DeformationKind kind, double amplitude) {
  DeformationStep s;
  s.kind = kind;
  s.amplitude = amplitude;
  s.axis = {0.6, 0.0, 0.8};
  s.direction = {0.8, 0.0, -0.6};
  s.centre = {0.1, 0.2, 0.3};
  s.length = 1.5;
  s.wavelength = 0.7;
  return s;
}

void expect_the_same_in_parts(const DeformationStep& step) {
  Random random(3);
  const std::vector<Vec3> rest = random_vectors(random, 2.0);
  const detail::Motion motion(step, 0.3);
  std::vector<Vec3> one_by_one = rest;
  for (std::size_t i = 0; i < count; ++i)
    detail::apply(motion, std::span(one_by_one).subspan(i, 1), i, detail::InstructionSet::portable);
  EXPECT_NE(one_by_one, rest);
  for (const detail::InstructionSet set : {detail::InstructionSet::portable, detail::best_instruction_set()}) {
    std::vector<Vec3> together = rest;
    detail::apply(motion, together, 0, set);
    expect_same_bits(together, one_by_one);
    std::vector<Vec3> in_parts = rest;
    detail::apply(motion, std::span(in_parts).first(38), 0, set);
    detail::apply(motion, std::span(in_parts).subspan(38), 38, set);
    expect_same_bits(in_parts, one_by_one);
  }
}

// With an amplitude of 10^5 radians, angles are beyond the range that the lanes reduce themselves.
TEST(Motion, IsTheSameHoweverVerticesAreDivided) {
  for (const double amplitude : {0.25, 1e5}) {
    for (const DeformationKind kind : {DeformationKind::rotate, DeformationKind::swing, DeformationKind::bend,
                                       DeformationKind::twist, DeformationKind::pulse, DeformationKind::bump})
      expect_the_same_in_parts(step_of(kind, amplitude));
  }
  expect_the_same_in_parts(step_of(DeformationKind::stretch, 0.25));
  Random random(5);
  DeformationStep pulse = step_of(DeformationKind::pulse, 0.25);
  pulse.field = random_vectors(random, 1.0);
  for (const Vec3& v : pulse.field) pulse.path.push_back(1e3 * v.x);
  expect_the_same_in_parts(pulse);
}

// A pulse along x shows the sine of the turns, a twist about z that of an angle.
TEST(Motion, TakesTheBitsOfTheElementaryFunctions) {
  Random random(7);
  DeformationStep pulse;
  pulse.kind = DeformationKind::pulse;
  pulse.amplitude = 1.0;
  pulse.wavelength = 1.0;
  pulse.field.assign(count, Vec3{1, 0, 0});
  for (std::size_t i = 0; i < count; ++i)
    pulse.path.push_back(std::ldexp(random.uniform(-1, 1), static_cast<int>(random.below(90)) - 45));
  DeformationStep twist;
  twist.kind = DeformationKind::twist;
  twist.amplitude = 1.0;
  twist.length = 1.0;
  for (const detail::InstructionSet set : {detail::InstructionSet::portable, detail::best_instruction_set()}) {
    std::vector<Vec3> pulsed(count);
    detail::apply(detail::Motion(pulse, 0.0), pulsed, 0, set);
    std::vector<Vec3> turned(count);
    for (std::size_t i = 0; i < count; ++i) turned[i] = {1, 0, pulse.path[i]};
    detail::apply(detail::Motion(twist, 0.25), turned, 0, set);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(pulsed[i].x, sine_cosine_of_turns(0.0 - pulse.path[i]).sine) << pulse.path[i];
      EXPECT_EQ(turned[i].x, sine_cosine(pulse.path[i]).cosine) << pulse.path[i];
      EXPECT_EQ(turned[i].y, sine_cosine(pulse.path[i]).sine) << pulse.path[i];
    }
  }
}

}  // namespace dartcast::motion_test
