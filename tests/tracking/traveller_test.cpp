// Travellers as bytes: all that a step needs comes back, in few bytes.
#include "tracking/batch/traveller.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "base/bytes.hpp"

namespace dartcast::traveller_test {

class RandomTravellers {
 public:
  Traveller next(StepStage stage, std::size_t walls, std::uint8_t ties) {
    Traveller t;
    t.step.stage = stage;
    t.home = number();
    t.state.position = vector();
    t.state.cell = Cell(number());
    t.state.simplex = static_cast<std::uint16_t>(number());
    t.state.touching_count = static_cast<std::uint8_t>(number() % 4);
    for (unsigned i = 0; i < t.state.touching_count; ++i) t.state.touching[i] = {Cell(number()), 3};
    t.state.held = number() % 2 == 0;
    for (double& w : t.weights) w = real();
    t.step.result = {number() % 2 == 0, Cell(number()), number() % 2 == 0, vector()};
    if (stage == StepStage::done) return t;
    t.step.contact_count = static_cast<std::uint32_t>(walls);
    t.step.first_here = walls > 0 ? number() : 0;
    t.step.last_time = walls > 0 ? real() : -1.0;
    t.step.interval = {real(), real(), vector()};
    t.step.slices = 1 + number() % 2 * 7;
    t.step.slice = t.step.slices > 1 ? 3 : 1;
    if (t.step.slices > 1) t.step.target = vector();
    t.step.slice_target = vector();
    for (std::size_t i = 0; i < walls; ++i) {
      CarriedWall& w = t.walls.emplace_back();
      w.hit.triangle = 2;
      w.hit.patch = Patch{7};
      w.hit.normal = vector();
      for (Vec3& v : w.before) v = vector();
      for (Vec3& v : w.now) v = vector();
    }
    if (stage == StepStage::on_way) put_walk(t, ties);
    return t;
  }

 private:
  void put_walk(Traveller& t, std::uint8_t ties) {
    t.step.walk.end = number() % 2 == 0 ? WalkEnd::wall : WalkEnd::arrived;
    t.step.walk.simplex = {Cell(number()), 4};
    t.step.walk.zeros = 5;
    t.step.walk.wall_facet = 2;
    t.restarted = number() % 2 == 0;
    t.ties.count = ties;
    for (unsigned i = 0; i < ties; ++i) t.ties.corner[i] = vector();
  }
  std::uint32_t number() { return static_cast<std::uint32_t>(random_()); }
  double real() { return static_cast<double>(random_() >> 11U) * 0x1p-53; }
  Vec3 vector() { return {real(), real(), real()}; }
  std::mt19937_64 random_{1};
};

std::string bytes_of(const Traveller& t) {
  ByteWriter out;
  pack(t, out);
  return out.bytes();
}

void expect_same_walk(const Traveller& come, const Traveller& sent) {
  EXPECT_EQ(come.step.walk.end, sent.step.walk.end);
  EXPECT_EQ(come.step.walk.simplex, sent.step.walk.simplex);
  EXPECT_EQ(come.step.walk.wall_simplex, sent.step.walk.simplex);
  EXPECT_EQ(come.step.walk.zeros, sent.step.walk.zeros);
  EXPECT_EQ(come.step.walk.wall_facet, sent.step.walk.wall_facet);
  EXPECT_EQ(come.restarted, sent.restarted);
  EXPECT_EQ(come.ties.count, sent.ties.count);
  EXPECT_EQ(come.ties.corner, sent.ties.corner);
}

TEST(Traveller, ComesBackFromItsBytes) {
  RandomTravellers travellers;
  for (int round = 0; round < 1000; ++round) {
    for (const StepStage stage : {StepStage::walk, StepStage::on_way, StepStage::carry, StepStage::done}) {
      const Traveller sent =
          travellers.next(stage, static_cast<std::size_t>(round % 4), static_cast<std::uint8_t>(round % 4));
      const std::string bytes = bytes_of(sent);
      ByteReader in(bytes);
      Traveller come;
      unpack(in, come);
      EXPECT_TRUE(in.at_end());
      EXPECT_EQ(come.step.stage, sent.step.stage);
      EXPECT_EQ(come.state.position, sent.state.position);
      EXPECT_EQ(come.state.at(), sent.state.at());
      EXPECT_EQ(come.state.held, sent.state.held);
      EXPECT_EQ(come.state.touching_count, sent.state.touching_count);
      EXPECT_EQ(come.state.touching, sent.state.touching);
      if (sent.state.held) EXPECT_EQ(come.weights, sent.weights);
      const bool has_result = sent.step.result.held || sent.step.result.stopped;
      EXPECT_EQ(come.step.result.held, sent.step.result.held);
      EXPECT_EQ(come.step.result.stopped, sent.step.result.stopped);
      if (has_result) EXPECT_EQ(come.step.result.invalid_cell, sent.step.result.invalid_cell);
      if (has_result) EXPECT_EQ(come.step.result.unused, sent.step.result.unused);
      if (stage == StepStage::done) continue;
      EXPECT_EQ(come.home, sent.home);
      EXPECT_EQ(come.step.contact_count, sent.step.contact_count);
      EXPECT_EQ(come.step.first_here, sent.step.first_here);
      EXPECT_EQ(come.step.last_time, sent.step.last_time);
      EXPECT_EQ(come.step.interval.begin, sent.step.interval.begin);
      EXPECT_EQ(come.step.interval.end, sent.step.interval.end);
      EXPECT_EQ(come.step.interval.later, sent.step.interval.later);
      EXPECT_EQ(come.step.slice, sent.step.slice);
      EXPECT_EQ(come.step.slices, sent.step.slices);
      EXPECT_EQ(come.step.slice_target, sent.step.slice_target);
      EXPECT_EQ(come.step.target, sent.step.target);
      ASSERT_EQ(come.walls.size(), sent.walls.size());
      for (std::size_t i = 0; i < sent.walls.size(); ++i) {
        EXPECT_EQ(come.walls[i].hit.triangle, sent.walls[i].hit.triangle);
        EXPECT_EQ(come.walls[i].hit.patch, sent.walls[i].hit.patch);
        EXPECT_EQ(come.walls[i].hit.normal, sent.walls[i].hit.normal);
        EXPECT_EQ(come.walls[i].before, sent.walls[i].before);
        EXPECT_EQ(come.walls[i].now, sent.walls[i].now);
      }
      if (stage == StepStage::on_way) expect_same_walk(come, sent);
    }
  }
}

// A walk that has met no wall, whatever it starts on. The data of a simulation are 45 bytes more.
TEST(Traveller, IsSmall) {
  RandomTravellers travellers;
  for (int round = 0; round < 100; ++round) {
    Traveller t = travellers.next(StepStage::on_way, 0, 3);
    t.state.held = false;
    t.step.result = {};
    EXPECT_LE(bytes_of(t).size(), 299U);
  }
  EXPECT_LE(bytes_of(travellers.next(StepStage::done, 0, 0)).size(), 170U);
}

}  // namespace dartcast::traveller_test
