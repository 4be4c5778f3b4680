// Sliding in a box without obstacles, against the truth that one knows: each coordinate along the box's axes is clamped
// by itself. On all six sides, into creases and corners, with states kept, in boxes upright and turned.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "base/random.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/response.hpp"
#include "oracle/checked_scene.hpp"
#include "support/seeds.hpp"
#include "tracking/step.hpp"

namespace dartcast::test::slide_test {

constexpr double side = 6.0;
constexpr std::uint64_t steps_per_scene = 200;

enum class Pose { upright, at_the_origins_far_side, turned };

// Where a box stands: the images of the axes, and of the origin.
struct Frame {
  std::array<Vec3, 3> axis = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  Vec3 origin;

  [[nodiscard]] Vec3 outward(const Vec3& local) const {
    return origin + axis[0] * local.x + axis[1] * local.y + axis[2] * local.z;
  }
  [[nodiscard]] Vec3 inward(const Vec3& x) const {
    const Vec3 d = x - origin;
    return {dot(d, axis[0]), dot(d, axis[1]), dot(d, axis[2])};
  }
};

Frame make_frame(Pose pose, Random& random) {
  Frame f;
  if (pose == Pose::at_the_origins_far_side) f.origin = {-side, -side / 2.0, 100.0};
  if (pose != Pose::turned) return f;
  f.origin = {random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0)};
  const auto unit = [](const Vec3& v) { return v * (1.0 / norm(v)); };
  f.axis[0] = unit({random.uniform(0.1, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)});
  f.axis[1] = unit(cross(f.axis[0], {random.uniform(-0.1, 0.1), random.uniform(0.5, 1.0), random.uniform(-1.0, 0.0)}));
  f.axis[2] = cross(f.axis[0], f.axis[1]);
  return f;
}

// A polyhedron stands for a box of mixed cells.
MeshData make_box(CellType type, const Frame& frame, std::uint64_t seed) {
  BoxOptions o;
  o.cells = {3, 3, 3};
  o.size = {side, side, side};
  o.type = type == CellType::polyhedron ? CellType::hexahedron : type;
  o.mixed = type == CellType::polyhedron;
  o.jitter = 0.3;
  o.seed = seed;
  MeshData mesh = generate_box(o);
  for (Vec3& p : mesh.points) p = frame.outward(p);
  return mesh;
}

Vec3 displacement(Random& random) {
  const auto component = [&] {
    switch (random.below(4)) {
      case 0: return 0.0;
      case 1: return random.below(2) == 0 ? 9.0 : -9.0;
      default: return random.uniform(-3.0, 3.0);
    }
  };
  return {component(), component(), component()};
}

std::string slide_in_box(CellType type, Pose pose, std::uint64_t seed, std::atomic<std::uint64_t>& contacts_met) {
  Random random(seed, 5);
  const Frame frame = make_frame(pose, random);
  const CheckedScene scene(make_box(type, frame, seed));
  if (!scene.valid()) return fmt::format("seed {}: invalid", seed);
  const ContactCallback slide = [](const Contact& c, std::span<const WallHit> walls, std::span<const WallHit> earlier) {
    return AfterContact{slid(c.unused, walls, earlier), true};
  };
  const StepOptions options;
  const Stepper stepper(scene.complex(), false, options, slide);
  const auto start = scene.oracle().all_containing(frame.outward({2.9, 3.1, 3.3}));
  ParticleState state;
  state.put(scene.library_simplex(start.at(0)), frame.outward({2.9, 3.1, 3.3}));
  Weights weights{};
  Counters counters;
  for (std::uint64_t i = 0; i < steps_per_scene; ++i) {
    const Vec3 before = frame.inward(state.position);
    const Vec3 wanted = before + displacement(random);
    ContactList contacts;
    stepper.step(0, state, weights, frame.outward(wanted), contacts, counters);
    const std::string wrong = scene.check_state(state);
    if (!wrong.empty()) return fmt::format("seed {}, step {}: {}", seed, i, wrong);
    const auto clamped = [](double x) { return std::clamp(x, 0.0, side); };
    const Vec3 truth = {clamped(wanted.x), clamped(wanted.y), clamped(wanted.z)};
    const double off = norm(frame.inward(state.position) - truth);
    if (!(off < 1e-9)) {
      return fmt::format(
          "seed {}, step {}: slid to a point that is {} off, with {} contacts; from ({}, {}, {}) to ({}, {}, {})", seed,
          i, off, contacts.contacts.size(), before.x, before.y, before.z, wanted.x, wanted.y, wanted.z);
    }
    contacts_met += contacts.contacts.size();
  }
  if (counters.unfinished != 0) return fmt::format("seed {}: {} steps unfinished", seed, counters.unfinished);
  return {};
}

class SlideInBox : public ::testing::TestWithParam<std::tuple<CellType, Pose>> {};

TEST_P(SlideInBox, EndsWhereTheBoxClampsIt) {
  const CellType type = std::get<0>(GetParam());
  const Pose pose = std::get<1>(GetParam());
  const std::uint64_t scenes = scaled(20, 1000);
  std::atomic<std::uint64_t> contacts{0};
  for (const std::string& wrong :
       run_seeds(scenes, [&](std::uint64_t seed) { return slide_in_box(type, pose, seed, contacts); })) {
    ADD_FAILURE() << wrong;
  }
  EXPECT_GT(contacts, scenes * steps_per_scene / 2);
}

INSTANTIATE_TEST_SUITE_P(Boxes, SlideInBox,
                         ::testing::Combine(::testing::Values(CellType::tetrahedron, CellType::hexahedron,
                                                              CellType::prism, CellType::pyramid, CellType::polyhedron),
                                            ::testing::Values(Pose::upright, Pose::at_the_origins_far_side,
                                                              Pose::turned)));

}  // namespace dartcast::test::slide_test
