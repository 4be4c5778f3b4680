// Frames that are read ahead give the same motion as frames in memory; what cannot be read ends a step before it starts.
#include "simulation/frame_read_ahead.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <new>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "dartcast/cutting.hpp"
#include "dartcast/error.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "support/expectations.hpp"
#include "support/meshes.hpp"

namespace dartcast::frame_read_ahead_test {

using Frames = std::vector<std::vector<Vec3>>;

// A box that sways: none of its cells turns over.
Frames swaying(const MeshData& mesh, std::size_t count) {
  Frames frames(count, mesh.points);
  for (std::size_t k = 0; k < count; ++k) {
    for (Vec3& x : frames[k]) x.x += 0.3 * std::sin(0.7 * double(k)) * x.y + 0.01 * double(k * k % 7) * x.z;
  }
  return frames;
}

DeformationStep step_of(std::size_t count) {
  DeformationStep s;
  s.kind = DeformationKind::frames;
  for (std::size_t k = 0; k < count; ++k) s.times.push_back(0.1 * double(k) + 0.001 * double(k * k % 3));
  return s;
}

SampleTimes times(std::size_t count) { return {"frames", step_of(count).times, Interpolation::linear, 0.0}; }

DeformationStep held(const Frames& frames) {
  DeformationStep s = step_of(frames.size());
  s.frames = frames;
  return s;
}

DeformationStep read_by(FrameReader reader, std::size_t count) {
  DeformationStep s = step_of(count);
  s.reader = std::move(reader);
  return s;
}

// The frames that a reader was asked for, by any thread.
class Record {
 public:
  void add(std::size_t frame) {
    const std::lock_guard lock(mutex_);
    frames_.push_back(frame);
  }
  std::vector<std::size_t> frames() const {
    const std::lock_guard lock(mutex_);
    return frames_;
  }
  // Waits until so many frames have been read, and a little longer.
  std::vector<std::size_t> after(std::size_t count) const {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (frames().size() < count && std::chrono::steady_clock::now() < end) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return frames();
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::size_t> frames_;
};

std::vector<std::size_t> range(std::size_t begin, std::size_t end) {
  std::vector<std::size_t> list;
  for (std::size_t k = begin; k < end; ++k) list.push_back(k);
  return list;
}

TEST(FrameReadAhead, ThePositionsAreThoseOfFramesInMemory) {
  const MeshData mesh = test::cubes(4);
  const Frames frames = swaying(mesh, 150);
  DeformationStep rotate;
  const Deformation expected({held(frames), rotate}, mesh.points);
  const Deformation found({read_by([&](std::size_t k) { return frames[k]; }, 150), rotate}, mesh.points);
  std::vector<Vec3> a(mesh.points.size()), b(mesh.points.size());
  const auto expect_same = [&](double time) {
    expected.positions(time, a);
    found.positions(time, b);
    ASSERT_TRUE(a == b) << time;
  };
  for (int i = -3; i < 700; ++i) expect_same(0.023 * i);
  for (int i = 100; i > 0; --i) expect_same(0.14 * i);
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> any(-1.0, 17.0);
  for (int i = 0; i < 300; ++i) expect_same(any(random));
  for (const double time : step_of(150).times) expect_same(time);
}

std::string text_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::exception& e) {
    return e.what();
  }
  return {};
}

// Cubic, and again and again.

std::vector<DeformationStep> series(const Frames& frames) {
  std::vector<DeformationStep> all;
  for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic}) {
    const double span = step_of(frames.size()).times.back() - step_of(frames.size()).times.front();
    for (const double cycle : {0.0, span, span + 0.07}) {
      all.push_back(held(frames));
      all.back().interpolation = interpolation;
      all.back().cycle = cycle;
    }
  }
  return all;
}

TEST(FrameSeries, ReadFramesGiveThePositionsOfThoseInMemory) {
  const MeshData mesh = test::cubes(3);
  for (const std::size_t count : {1U, 2U, 3U, 5U, 100U}) {
    const Frames frames = swaying(mesh, count);
    for (const DeformationStep& in_memory : series(frames)) {
      DeformationStep read = in_memory;
      read.frames.clear();
      read.reader = [&](std::size_t k) { return frames.at(k); };
      const Deformation expected({in_memory}, mesh.points), found({read}, mesh.points);
      std::vector<Vec3> a(mesh.points.size()), b(mesh.points.size());
      for (int i = -30; i < 400; ++i) {
        const double time = 0.0317 * i * (count == 100U ? 1.0 : 0.1);
        expected.positions(time, a);
        found.positions(time, b);
        ASSERT_EQ(a, b) << time;
      }
    }
  }
}

TEST(FrameSeries, FramesAreMetAtTheirTimes) {
  const MeshData mesh = test::cubes(2);
  const Frames frames = swaying(mesh, 6);
  for (const DeformationStep& step : series(frames)) {
    const Deformation deformation({step}, mesh.points);
    std::vector<Vec3> found(mesh.points.size());
    const std::size_t used = step.cycle == step.times.back() - step.times.front() ? 5 : 6;
    for (std::size_t k = 0; k < used; ++k) {
      for (const int turns : {0, 1, -2}) {
        deformation.positions(step.times[k] + turns * step.cycle, found);
        for (std::size_t v = 0; v < found.size(); ++v)
          test::expect_near(found[v], frames[k][v], turns == 0 ? 0.0 : 1e-13);
      }
    }
    deformation.positions(-50.0, found);
    if (step.cycle == 0.0) EXPECT_EQ(found, frames.front());
  }
}

// A motion that is quadratic in time, at unequal distances.
Vec3 thrown(double t) { return {0.3 - 2.0 * t + 1.5 * t * t, 4.0 * t, 0.25 * t * t}; }

TEST(FrameSeries, ACubicIsExactForQuadraticMotions) {
  DeformationStep step;
  step.kind = DeformationKind::frames;
  step.interpolation = Interpolation::cubic;
  step.times = {-1.0, -0.4, 0.1, 0.2, 1.3, 1.5};
  for (const double t : step.times) step.frames.push_back({thrown(t)});
  const Vec3 rest;
  const Deformation deformation({step}, {&rest, 1});
  Vec3 found;
  for (double t = -0.4; t <= 1.3; t += 0.01) {  // inside, where both neighbours are known
    deformation.positions(t, {&found, 1});
    test::expect_near(found, thrown(t), 1e-14);
  }
}

TEST(FrameSeries, ACubicHasNoJumpsOfVelocity) {
  for (const double cycle : {0.0, 1.0, 1.2}) {
    DeformationStep step;
    step.kind = DeformationKind::frames;
    step.interpolation = Interpolation::cubic;
    step.times = {0.0, 0.3, 0.4, 0.8, 1.0};
    for (const double x : {0.0, 2.0, -1.0, 0.5, 0.0}) step.frames.push_back({Vec3{x, 0, 0}});
    step.cycle = cycle;
    const Vec3 rest;
    const Deformation deformation({step}, {&rest, 1});
    const auto at = [&](double t) {
      Vec3 x;
      deformation.positions(t, {&x, 1});
      return x.x;
    };
    constexpr double h = 1e-6;
    for (const double t : {0.3, 0.4, 0.8, 1.0, 1.2, 1.3}) {
      if (cycle == 0.0 && t > 0.8) continue;
      EXPECT_NEAR((at(t) - at(t - h)) / h, (at(t + h) - at(t)) / h, 1e-3) << cycle << " at " << t;
    }
  }
}

// The last frame of a cycle that is as long as its frames stands between others, where it is not needed.
TEST(FrameSeries, AFrameInBetweenThatCannotBeReadIsNamedAndReadAgain) {
  const MeshData mesh = test::cubes(1);
  const Frames frames = swaying(mesh, 8);
  DeformationStep step = step_of(8);
  step.interpolation = Interpolation::cubic;
  step.cycle = step.times.back() - step.times.front();
  std::atomic<bool> broken = true;
  step.reader = [&](std::size_t k) {
    if (k == 7 && broken) throw Error("beat.vtu is not there");
    return frames[k];
  };
  const Deformation deformation({step}, mesh.points);
  std::vector<Vec3> found(mesh.points.size());
  const double time = step.times.front() + step.cycle + 0.01;  // between the frames 0 and 1, beside 6 and 2
  EXPECT_NE(text_of([&] { deformation.positions(time, found); }).find("beat.vtu"), std::string::npos);
  broken = false;
  EXPECT_NO_THROW(deformation.positions(time, found));
}

TEST(FrameSeries, CyclesThatAreTooShortAreRefused) {
  const MeshData mesh = test::cubes(1);
  DeformationStep step = held(swaying(mesh, 4));
  step.cycle = 0.2;
  EXPECT_THROW(Deformation({step}, mesh.points), InvalidArgument);
  step.cycle = -1.0;
  EXPECT_THROW(Deformation({step}, mesh.points), InvalidArgument);
  step.cycle = std::numeric_limits<double>::infinity();
  EXPECT_THROW(Deformation({step}, mesh.points), InvalidArgument);
}

TEST(FrameReadAhead, ReadsInTheOrderOfTimeAndNoMoreThanItMayHold) {
  Record record;
  FrameReadAhead ahead(
      [&](std::size_t k) {
        record.add(k);
        return std::vector<Vec3>(3);
      },
      times(1000), 3);
  ASSERT_EQ(ahead.capacity(), max_frames_held);
  EXPECT_TRUE(record.frames().empty());
  const auto get = [&](std::size_t first, std::size_t count) { ahead.get(range(first, first + count)); };
  get(0, 2);
  EXPECT_EQ(record.after(64), range(0, 64));
  get(2, 2);
  EXPECT_EQ(record.after(66), range(0, 66));
  get(500, 2);
  std::vector<std::size_t> expected = range(0, 66);
  for (const std::size_t k : range(500, 564)) expected.push_back(k);
  EXPECT_EQ(record.after(expected.size()), expected);
  get(999, 1);
  expected.push_back(999);
  EXPECT_EQ(record.after(expected.size()), expected);
}

TEST(FrameReadAhead, TheNumberHeldFollowsFromTheirMemory) {
  const auto capacity = [](std::size_t vertices) { return FrameReadAhead({}, times(1), vertices).capacity(); };
  EXPECT_EQ(capacity(0), max_frames_held);
  EXPECT_EQ(capacity(100000), 13U);  // 2.4 MB each
  EXPECT_LE(capacity(100000) * 100000 * sizeof(Vec3), frame_memory);
  EXPECT_EQ(capacity(100000000), 3U);  // the two that are needed and one more
}

// The frame that is wanted, with what may be wrong with it; all others are good.
struct Fault {
  std::size_t frame;
  std::function<void(std::vector<Vec3>&)> spoil;
  std::string message;
};

std::vector<Fault> faults() {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  return {{6, [](std::vector<Vec3>&) { throw Error("frame 6: beat.vtu: no such file"); }, "beat.vtu"},
          {7, [](std::vector<Vec3>& x) { x.pop_back(); }, "frame 7 has 215 positions; the mesh has 216 vertices"},
          {5, [=](std::vector<Vec3>& x) { x[12].y = nan; }, "frame 5: position 12 is not finite"},
          {6, [](std::vector<Vec3>&) { throw std::bad_alloc(); }, "bad_alloc"}};
}

SimulationOptions options() {
  SimulationOptions o;
  o.dt = 0.05;
  o.gravity = {0, 0, -1};
  return o;
}

// Particles inside, and particles that enter at each step.
void fill(Simulation& simulation) {
  simulation.add_random(200, {1, 2, 3});
  simulation.add_inlet(simulation.environment().map().patch("xmin"), 400.0, {1, 0, 0});
}

Event removal(double at) {
  return {at, Carve{box_tool({1.5, -1.0, -1.0}, {3.0, 2.0, 7.0}), Carving::remove}, OrphanPolicy::relocate};
}

// A run stops at the step that needs the frame, with nothing changed, and goes on once the frame can be read.
TEST(FrameReadAhead, AStepWithoutItsFrameChangesNothingAndCanBeRepeated) {
  const MeshData mesh = test::cubes(5);
  const Frames frames = swaying(mesh, 12);
  for (const bool collides : {false, true}) {
    SimulationOptions o = options();
    if (collides) o.collisions.emplace();
    Environment expected_environment(mesh);
    Simulation expected(expected_environment, o);
    expected.set_deformation(Deformation({held(frames)}, mesh.points));
    fill(expected);
    for (int i = 0; i < 20; ++i) expected.step();
    for (const Fault& fault : faults()) {
      std::atomic<bool> whole = false;
      const FrameReader reader = [&](std::size_t k) {
        std::vector<Vec3> points = frames[k];
        if (k == fault.frame && !whole) fault.spoil(points);
        return points;
      };
      Environment environment(mesh);
      Simulation simulation(environment, o);
      simulation.set_deformation(Deformation({read_by(reader, 12)}, mesh.points));
      fill(simulation);
      std::string error;
      while (simulation.steps() < 20 && error.empty()) error = text_of([&] { simulation.step(); });
      EXPECT_NE(error.find(fault.message), std::string::npos) << error;
      const double needed_after = step_of(12).times[fault.frame - 1];
      EXPECT_LT(double(simulation.steps()) * o.dt, needed_after) << fault.message;
      EXPECT_GE(double(simulation.steps() + 1) * o.dt, needed_after) << fault.message;
      const std::string hash = simulation.state_hash().hex();
      const std::vector<Vec3> positions(environment.positions().begin(), environment.positions().end());
      const std::size_t particles = simulation.particles().size();
      for (int again = 0; again < 2; ++again)
        EXPECT_NE(text_of([&] { simulation.step(); }).find(fault.message), std::string::npos);
      EXPECT_EQ(simulation.state_hash().hex(), hash);
      EXPECT_EQ(simulation.particles().size(), particles);
      EXPECT_TRUE(std::equal(positions.begin(), positions.end(), environment.positions().begin()));
      whole = true;
      while (simulation.steps() < 20) simulation.step();
      EXPECT_EQ(simulation.state_hash().hex(), expected.state_hash().hex()) << fault.message;
    }
  }
}

// An event of a step that cannot be made is not carried out either.
TEST(FrameReadAhead, EventsWaitForTheFramesOfTheirStep) {
  const MeshData mesh = test::cubes(5);
  const Frames frames = swaying(mesh, 3);
  const FrameReader reader = [&](std::size_t k) {
    if (k == 1) throw Error("gone");
    return frames[k];
  };
  Environment environment(mesh);
  Simulation simulation(environment, options());
  simulation.set_deformation(Deformation({read_by(reader, 3)}, mesh.points));
  simulation.set_events({removal(0.0)});
  EXPECT_EQ(test::error_text([&] { simulation.step(); }), "gone");
  EXPECT_EQ(simulation.event_log().events.size(), 0U);
}

TEST(FrameReadAhead, AMotionInThePlaneStaysThere) {
  const std::vector<Vec3> rest = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const FrameReader reader = [&](std::size_t k) {
    std::vector<Vec3> points = rest;
    points[2].z = k == 2 ? -0.5 : 0.0;
    return points;
  };
  Deformation deformation({read_by(reader, 4)}, rest);
  std::vector<Vec3> out(3, {7, 7, 7});
  deformation.positions(0.2, out);
  deformation.check_plane();
  EXPECT_NO_THROW(deformation.load_frames(0.05));
  const std::string error = test::error_text([&] { deformation.positions(0.2, out); });
  EXPECT_NE(error.find("frame 2 must have z = 0 everywhere, and its position 2 has z = -0.5"), std::string::npos)
      << error;
  EXPECT_NO_THROW(deformation.load_frames(0.35));
}

// Vertices that an edit adds go along, wherever the time goes then.
TEST(FrameReadAhead, GoesOnAfterEditsAndCheckpoints) {
  const MeshData mesh = test::cubes(4);
  const Frames frames = swaying(mesh, 40);
  const auto run = [&](DeformationStep motion) {
    const auto make = [&](Environment& environment) {
      auto simulation = std::make_unique<Simulation>(environment, options());
      simulation->set_deformation(Deformation({motion}, mesh.points));
      simulation->set_events({removal(0.5)});
      AdaptiveSubdivisionScene subdivision;
      subdivision.every = 5;
      subdivision.options.max_particles = 6;
      subdivision.options.min_particles = 2;
      simulation->set_adaptive_subdivision(subdivision);
      return simulation;
    };
    Environment environment(mesh);
    const auto simulation = make(environment);
    fill(*simulation);
    for (int i = 0; i < 16; ++i) simulation->step();
    const SimulationCheckpoint saved = simulation->checkpoint();
    for (int i = 0; i < 16; ++i) simulation->step();
    EXPECT_EQ(simulation->event_log().events.size(), 1U);
    EXPECT_GT(simulation->event_log().subdivided, 5U);
    Environment again(mesh);
    const auto resumed = make(again);
    resumed->add_inlet(again.map().patch("xmin"), 400.0, {1, 0, 0});
    resumed->restore(saved);
    for (int i = 0; i < 16; ++i) resumed->step();
    EXPECT_EQ(resumed->state_hash().hex(), simulation->state_hash().hex());
    return simulation->state_hash().hex();
  };
  EXPECT_EQ(run(read_by([&](std::size_t k) { return frames[k]; }, 40)), run(held(frames)));
}

// Copies share one thread, and each may be at another time.
TEST(FrameReadAhead, CopiesMayBeUsedAtOnce) {
  const MeshData mesh = test::cubes(3);
  const Frames frames = swaying(mesh, 300);
  const Deformation expected({held(frames)}, mesh.points);
  const Deformation first({read_by([&](std::size_t k) { return frames[k]; }, 300)}, mesh.points);
  const auto follow = [&](Deformation deformation, double from) {
    std::vector<Vec3> a(mesh.points.size()), b(mesh.points.size());
    for (int i = 0; i < 200; ++i) {
      expected.positions(from + 0.04 * i, a, Threads{1});
      deformation.positions(from + 0.04 * i, b, Threads{1});
      ASSERT_TRUE(a == b);
    }
  };
  std::vector<std::thread> threads;
  for (const double from : {0.0, 0.0, 20.0}) threads.emplace_back(follow, first, from);
  for (std::thread& t : threads) t.join();
}

TEST(FrameReadAhead, MayEndWhileAFrameIsRead) {
  const std::vector<Vec3> rest(10);
  for (int i = 0; i < 20; ++i) {
    std::atomic<int> begun = 0, ended = 0;
    {
      const FrameReader slow = [&](std::size_t) {
        ++begun;
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        ++ended;
        return rest;
      };
      const Deformation deformation({read_by(slow, 1000)}, rest);
      if (i % 2 == 0) deformation.load_frames(0.0);
    }
    EXPECT_EQ(begun, ended);
    EXPECT_LT(begun, 10);
  }
}

TEST(FrameReadAhead, RefusesFramesAndAReaderAtOnce) {
  const std::vector<Vec3> rest(1);
  DeformationStep both = held({rest});
  both.reader = [&](std::size_t) { return rest; };
  test::expect_refused([&] { Deformation({both}, rest); }, "not both");
  DeformationStep no_times = read_by(both.reader, 0);
  test::expect_refused([&] { Deformation({no_times}, rest); }, "at least one frame");
  DeformationStep twist;
  twist.kind = DeformationKind::twist;
  twist.length = 0.0;
  test::expect_refused([&] { Deformation({held({rest}), twist}, rest); }, "deformation 2 (twist)");
  twist.length = 1.0;
  twist.axis = {1, 0, 0};
  test::expect_refused([&] { Deformation({held({rest}), twist}, rest).check_plane(); }, "deformation 2 (twist)");
}

}  // namespace dartcast::frame_read_ahead_test
