// Vertices that a move puts beyond the range of exact signs: what is tiny counts as 0, what is huge makes cells invalid
// until it is back. No particle is lost, and no position becomes NaN.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/predicates.hpp"
#include "dartcast/response.hpp"
#include "dartcast/spheres.hpp"
#include "dartcast/validity.hpp"
#include "support/particle_checks.hpp"
#include "support/seeds.hpp"
#include "support/tier.hpp"

namespace dartcast::range_test {

constexpr double infinity = std::numeric_limits<double>::infinity();

MeshData mesh_of(unsigned dimension, bool simplices) {
  if (dimension == 2) {
    RectangleOptions o;
    o.cells = {3, 3};
    o.size = {3, 3};
    o.type = simplices ? CellType::triangle : CellType::quadrilateral;
    return generate_rectangle(o);
  }
  BoxOptions o;
  o.cells = {3, 3, 3};
  o.size = {3, 3, 3};
  o.type = simplices ? CellType::tetrahedron : CellType::hexahedron;
  return generate_box(o);
}

// Inside cells, and on their faces, edges and vertices.
std::vector<Vec3> places(unsigned dimension) {
  std::vector<Vec3> points;
  for (const double x : {0.0, 0.5, 1.3, 2.0, 3.0}) {
    for (const double y : {0.0, 0.25, 1.0, 2.9}) {
      for (const double z : {0.0, 0.3, 3.0}) {
        if (dimension == 3 || z == 0.0) points.push_back({x, y, z});
      }
    }
  }
  return points;
}

// One environment with its particles, whose steps are the same for all that are made alike.
struct World {
  Environment environment;
  Particles particles;
  std::vector<Vec3> velocities;
  std::vector<ParticleStatus> statuses;
  WallResponses responses{WallResponse{WallResponseKind::reflect, 0.5, 0.1}};
  std::vector<Vec3> rest;

  World(unsigned dimension, bool simplices) : World(mesh_of(dimension, simplices), places(dimension), dimension) {}

  World(const MeshData& mesh, const std::vector<Vec3>& points, unsigned dimension) : environment(mesh) {
    environment.add(particles, points);
    EXPECT_EQ(particles.size(), points.size());
    Random random(5);
    for (std::size_t i = 0; i < points.size(); ++i) {
      velocities.push_back({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
      if (dimension == 2) velocities.back().z = 0.0;
    }
    statuses.resize(points.size());
    rest.assign(environment.positions().begin(), environment.positions().end());
  }

  StepReport step(bool respond) {
    std::vector<Vec3> targets;
    for (std::size_t i = 0; i < particles.size(); ++i) targets.push_back(particles[i].position + velocities[i] * 0.2);
    if (!respond) return environment.advance(particles, targets);
    return environment.advance(particles, targets, respond_with(responses, velocities, statuses, 0.2));
  }

  void move_vertex(std::size_t vertex, double Vec3::*axis, double to) {
    std::vector<Vec3> next = rest;
    next[vertex].*axis = to;
    environment.move(next);
  }

  void expect_sound(const std::string& what) const {
    const Audit a = audit(environment.complex(), particles);
    EXPECT_EQ(a.failed, 0U) << what << ": " << a.first;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      ASSERT_TRUE(is_finite(particles[i].position)) << what << ", particle " << i;
      ASSERT_TRUE(is_finite(velocities[i])) << what << ", particle " << i;
    }
  }
};

const std::vector<double Vec3::*> axes = {&Vec3::x, &Vec3::y, &Vec3::z};

template <class Body>
void for_each_vertex(Body&& body) {
  for (const unsigned dimension : {2U, 3U}) {
    for (const bool simplices : {false, true}) {
      const std::size_t vertices = mesh_of(dimension, simplices).points.size();
      const std::size_t stride = test::full_tier() ? 1 : test::sanitized() ? 29 : 5;
      for (std::size_t vertex = 0; vertex < vertices; vertex += stride) {
        for (unsigned axis = 0; axis < dimension; ++axis) body(dimension, simplices, vertex, axes[axis]);
      }
    }
  }
}

std::string name_of(unsigned dimension, std::size_t vertex, double x) {
  return std::to_string(dimension) + "D, vertex " + std::to_string(vertex) + " at " + std::to_string(x);
}

// The independent truth: the same steps where the coordinate is 0.
TEST(Range, ATinyCoordinateOfAVertexCountsAsZero) {
  for (const double tiny : {5e-324, -1e-310, 1e-100, -1e-91}) {
    for_each_vertex([&](unsigned dimension, bool simplices, std::size_t vertex, double Vec3::*axis) {
      const std::string what = name_of(dimension, vertex, tiny);
      World world(dimension, simplices);
      World twin(dimension, simplices);
      for (const bool respond : {true, false}) {
        world.move_vertex(vertex, axis, tiny);
        twin.move_vertex(vertex, axis, 0.0);
        const StepReport report = world.step(respond);
        const StepReport expected = twin.step(respond);
        world.expect_sound(what);
        ASSERT_TRUE(test::same_bits(test::copy_of(twin.particles), world.particles)) << what;
        ASSERT_EQ(report.held.size(), expected.held.size()) << what;
        ASSERT_EQ(report.contacts.contacts.size(), expected.contacts.contacts.size()) << what;
      }
      ASSERT_EQ(world.environment.validity().invalid_count, twin.environment.validity().invalid_count) << what;
    });
  }
}

TEST(Range, AHugeCoordinateOfAVertexHoldsParticlesUntilItIsBack) {
  std::size_t held = 0;
  for (const double huge : {1e91, -1e91, 1e120, -1e160, 1e300, infinity, std::nan("")}) {
    for_each_vertex([&](unsigned dimension, bool simplices, std::size_t vertex, double Vec3::*axis) {
      const std::string what = name_of(dimension, vertex, huge);
      World world(dimension, simplices);
      for (const bool respond : {true, false}) {
        world.move_vertex(vertex, axis, huge);
        held += world.step(respond).held.size();
        EXPECT_FALSE(world.environment.validity().valid()) << what;
        world.expect_sound(what);
        world.step(respond);  // nothing moves
        world.expect_sound(what);
        world.environment.move(world.rest);
        world.step(respond);
        world.expect_sound(what + ", back");
        EXPECT_TRUE(world.step(respond).held.empty()) << what;
        EXPECT_TRUE(world.environment.validity().valid()) << what;
      }
    });
  }
  EXPECT_GT(held, 1000U);
}

// Between what points may have and what signs are exact for: whichever it is, nothing is lost.
TEST(Range, ACoordinateAtTheEndOfTheRangeLosesNobody) {
  for (const double far : {0x1p+300, 2.1e90, -0x1.8p+301, 0x1p+302, -0x1.0000000000001p+302}) {
    for_each_vertex([&](unsigned dimension, bool simplices, std::size_t vertex, double Vec3::*axis) {
      World world(dimension, simplices);
      world.move_vertex(vertex, axis, far);
      world.step(false);
      world.expect_sound(name_of(dimension, vertex, far));
    });
  }
}

// Vertices that come and go, to infinity or almost out of the range: responses of the library never end a call, whatever
// takes the step. Velocities that lead out of the range are given up.
class Extremes {
 public:
  explicit Extremes(std::uint64_t seed) : random_(seed), dimension_(2 + random_.below(2)), mesh_(mesh(seed)) {
    environment_ = std::make_unique<Environment>(mesh_, Threads{1});
    environment_->add(particles_, test::random_points(40, {}, {4.0, 4.0, dimension_ == 2 ? 0.0 : 3.0}, random_));
    for (std::size_t i = 0; i < particles_.size(); ++i) velocities_.push_back(vector(3.0));
    fates_.resize(particles_.size());
    options_.tolerance = random_.below(2) == 0 ? 1e9 : 0.05;
    simultaneous_ = random_.below(4) == 0;
    responses_ = WallResponses(random_.below(2) == 0 ? Reflect{1.0, 0.0} : Reflect{0.24, 0.86});
  }

  std::string run() {
    for (int step = 0; step < 12; ++step) {
      environment_->move(moved());
      std::vector<Vec3> targets = test::positions_of(particles_);
      for (std::size_t i = 0; i < targets.size(); ++i) {
        if (!simultaneous_ && random_.below(3) == 0) velocities_[i] = vector(0x1p+300);
        if (!in_exact_range(targets[i] + velocities_[i])) velocities_[i] = {};
        targets[i] += velocities_[i];
      }
      const ContactCallback respond = respond_with(responses_, velocities_, fates_, 1.0);
      if (simultaneous_)
        stepper_.advance(*environment_, particles_, targets, respond, options_);
      else
        environment_->advance(particles_, targets, respond, options_);
      const Audit a = audit(environment_->complex(), particles_);
      if (a.failed > 0) return a.first;
      if (!std::all_of(velocities_.begin(), velocities_.end(), is_finite)) return "a velocity that is not finite";
    }
    return "";
  }

 private:
  MeshData mesh(std::uint64_t seed) {
    const double blocked = random_.below(2) == 0 ? 0.2 : 0.0;
    if (dimension_ == 2) {
      return generate_rectangle(
          {.cells = {4, 4}, .size = std::array{4.0, 4.0}, .mixed = true, .blocked_share = blocked, .seed = seed});
    }
    return generate_box(
        {.cells = {3, 3, 3}, .size = Vec3{3.0, 3.0, 3.0}, .mixed = true, .blocked_share = blocked, .seed = seed});
  }
  Vec3 vector(double size) {
    Vec3 v = {random_.uniform(-size, size), random_.uniform(-size, size), random_.uniform(-size, size)};
    if (dimension_ == 2) v.z = 0.0;
    return v;
  }
  std::vector<Vec3> moved() {
    constexpr std::array<double, 8> extremes = {
        infinity,   std::numeric_limits<double>::quiet_NaN(), 1e300, -1e160, 0x1p+300, -0x1p+300, 0x1.8p+299,
        -0x1.8p+299};
    std::vector<Vec3> next = mesh_.points;
    for (Vec3& x : next) {
      if (random_.below(12) == 0)
        x.*axes[random_.below(dimension_)] = extremes[random_.below(8)];
      else if (random_.below(3) == 0)
        x += vector(0.1);
    }
    return next;
  }

  Random random_;
  unsigned dimension_;
  MeshData mesh_;
  std::unique_ptr<Environment> environment_;
  Particles particles_;
  std::vector<Vec3> velocities_;
  std::vector<ParticleStatus> fates_;
  WallResponses responses_;
  StepOptions options_;
  SimultaneousStepper stepper_;
  bool simultaneous_ = false;
};

TEST(Range, ResponsesOfTheLibraryNeverEndACall) {
  const auto wrong = test::run_seeds(test::scaled(40, 20000), [](std::uint64_t seed) { return Extremes(seed).run(); });
  EXPECT_EQ(wrong, std::vector<std::string>{});
}

// The whole scene beyond the range, its cells as they were.
TEST(Range, ASceneBeyondTheRangeIsHeldAndComesBack) {
  for (const unsigned dimension : {2U, 3U}) {
    for (const double far : {0x1p+303, 1e120}) {
      World world(dimension, true);
      std::vector<Vec3> next = world.rest;
      for (Vec3& p : next) p = p * (far * 0x1p-2) + Vec3{far, 0.0, 0.0};
      world.environment.move(next);
      world.step(false);
      world.expect_sound("beyond");
      EXPECT_EQ(world.environment.validity().invalid_count, world.environment.map().cell_count());
      world.environment.move(world.rest);
      world.step(false);
      world.expect_sound("back");
      EXPECT_TRUE(world.step(false).held.empty());
    }
  }
}

// A Gaussian dent in a floor: far from it, vertices are at -1e-310 to -1e-92. The dent travels.
TEST(Range, AFloorWithAGaussianDent) {
  const int scenes = test::scaled(20, 200);
  for (int scene = 0; scene < std::max(scenes, 3); ++scene) {
    Random random(static_cast<std::uint64_t>(scene));
    BoxOptions o;
    o.cells = {60, 2, 2};
    o.size = {60, 2, 2};
    o.type = scene % 2 != 0 ? CellType::tetrahedron : CellType::hexahedron;
    std::vector<Vec3> at;
    for (int i = 0; i < 300; ++i) {
      at.push_back({random.uniform(0, 60), random.uniform(0, 2), random.uniform(-2, 2)});
      if (at.back().z < 0.0) at.back().z = 0.0;
      if (i % 3 == 0) at.back().x = std::floor(at.back().x);
      if (i % 5 == 0) at.back().y = i % 2 == 0 ? 0.0 : 1.0;
    }
    World world(generate_box(o), at, 3);
    ASSERT_EQ(world.particles.size(), at.size());
    if (scene % 3 == 1) world.responses = WallResponses(WallResponse{WallResponseKind::slide, 1.0, 0.0});
    for (Vec3& v : world.velocities)
      v = {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.5, 0)};
    for (int step = 0; step < 40; ++step) {
      std::vector<Vec3> next = world.rest;
      const double center = 5 + 0.2 * step;
      for (Vec3& p : next) {
        if (p.z == 0.0) p.z = (scene % 5 == 4 ? 0.3 : -0.3) * std::exp(-(p.x - center) * (p.x - center) * 0.5);
      }
      world.environment.move(next);
      for (Vec3& v : world.velocities) v.z -= 0.05;
      world.step(scene % 3 != 2);
      world.expect_sound("scene " + std::to_string(scene) + ", step " + std::to_string(step));
      if (testing::Test::HasFailure()) return;
    }
  }
}

// Positions, points asked for and targets follow the same rule.
TEST(Range, TinyCoordinatesOfParticlesAndTargetsCountAsZero) {
  for (const unsigned dimension : {2U, 3U}) {
    World world(dimension, false);
    Particles some;
    const Vec3 tiny = {0.5, 1e-310, -5e-324};
    EXPECT_EQ(world.environment.locate(tiny).place, Place::free);
    world.environment.add(some, std::vector<Vec3>{tiny});
    ASSERT_EQ(some.size(), 1U);
    EXPECT_EQ(test::bits(some[0].position), test::bits({0.5, 0.0, 0.0}));
    EXPECT_TRUE(world.environment.add(some, some[0].at(), tiny));
    EXPECT_EQ(test::bits(some[1].position), test::bits({0.5, 0.0, 0.0}));
    const auto traces = world.environment.trace(some, 0, std::vector<Vec3>{{0.75, 0.5, 1e-301}});
    EXPECT_EQ(test::bits(traces.at(0).after.position), test::bits({0.75, 0.5, 0.0}));
    world.environment.advance(some, std::vector<Vec3>{{0.75, 0.5, 1e-301}, {1e-320, 0.25, 0.0}});
    EXPECT_EQ(test::bits(some[0].position), test::bits({0.75, 0.5, 0.0}));
    EXPECT_EQ(test::bits(some[1].position), test::bits({0.0, 0.25, 0.0}));
    EXPECT_EQ(audit(world.environment.complex(), some).failed, 0U);
  }
}

}  // namespace dartcast::range_test
