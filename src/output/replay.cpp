// Takes the step of a replay again, in all ways that must agree, and checks its end.
#include "dartcast/replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <unordered_set>
#include <vector>

#include "dartcast/audit.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/spheres.hpp"
#include "environment/environment_members.hpp"

namespace dartcast {

namespace {

constexpr std::size_t copies = 4;  // as many as the kernels take at once

bool same_bits(const Vec3& a, const Vec3& b) {
  using Bits = std::array<std::uint64_t, 3>;
  return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}
bool same(const ParticleState& a, const ParticleState& b) {
  return same_bits(a.position, b.position) && a.at() == b.at() && a.held == b.held &&
         std::equal(a.touching.begin(), a.touching.begin() + a.touching_count, b.touching.begin(),
                    b.touching.begin() + b.touching_count);
}
bool same(const Contact& a, const Contact& b) {
  return a.time_of_impact == b.time_of_impact && a.kind == b.kind && same_bits(a.point, b.point) &&
         a.wall_count == b.wall_count;
}

// The recorded answers to the contacts of each of several equal particles.
class Answers {
 public:
  explicit Answers(const StepReplay& step) : step_(step) {}

  ContactCallback one_by_one() {
    if (!step_.responds) return {};
    return [this](const Contact& c, std::span<const WallHit>, std::span<const WallHit>) { return next(c.particle); };
  }
  RoundCallback in_rounds() {
    if (!step_.responds) return {};
    return [this](const ContactList& list, std::span<AfterContact> after) {
      for (std::size_t i = 0; i < after.size(); ++i) after[i] = next(list.contacts[i].particle);
    };
  }

 private:
  AfterContact next(std::uint32_t particle) {
    const std::size_t n = given_[particle]++;
    return n < step_.answers.size() ? step_.answers[n] : AfterContact{};
  }

  const StepReplay& step_;
  std::array<std::size_t, copies> given_{};
};

class Replay {
 public:
  explicit Replay(const StepReplay& step)
      : step_(step), environment_of_(environment_as_it_is(step.mesh)), environment_(*environment_of_) {
    for (Particles* set : {&several_, &in_rounds_, &alone_}) {
      const std::size_t count = set == &alone_ ? 1 : copies;
      *set = environment_.restored(std::vector(count, step.state), std::vector(count, step.weights));
    }
    if (!step.moved.empty()) environment_.move(step.moved);
  }

  ReplayResult run() {
    try {
      if (!step_.simultaneous) trace();
      advance_several();
      if (!step_.simultaneous) advance_in_rounds();
      advance_alone();
      check_end();
    } catch (const Error& e) {
      wrong(e.what());
    }
    return std::move(result_);
  }

 private:
  void wrong(const std::string& what) {
    if (result_.wrong.empty()) result_.wrong = what;
  }

  StepReport advance(Particles& particles) {
    Answers answers(step_);
    const std::vector<Vec3> targets(particles.size(), step_.target);
    if (step_.simultaneous)
      return SimultaneousStepper().advance(environment_, particles, targets, answers.one_by_one(), step_.options);
    return environment_.advance(particles, targets, answers.one_by_one(), step_.options);
  }

  void trace() {
    Answers answers(step_);
    const Trace trace = environment_.trace(alone_, 0, {&step_.target, 1}, answers.one_by_one(), step_.options).at(0);
    result_.state = trace.after;
    result_.contacts = trace.contacts;
  }
  void advance_several() {
    const StepReport report = advance(several_);
    if (!step_.simultaneous) return compare("a batch", several_, report);
    result_.state = several_[0];
    for (const Contact& c : report.contacts.contacts)
      if (c.particle == 0) result_.contacts.contacts.push_back(c);
    result_.contacts.walls = report.contacts.walls;
    compare("a batch", several_, report);
  }
  void advance_in_rounds() {
    Answers answers(step_);
    const std::vector<Vec3> targets(copies, step_.target);
    compare("rounds", in_rounds_,
            environment_.advance_in_rounds(in_rounds_, targets, answers.in_rounds(), step_.options));
  }
  void advance_alone() { compare("the particle alone", alone_, advance(alone_)); }

  // Every particle does the same.
  void compare(const char* how, const Particles& particles, const StepReport& report) {
    const auto& expected = result_.contacts.contacts;
    const auto& contacts = report.contacts.contacts;
    bool equal = contacts.size() == expected.size() * particles.size();
    for (std::size_t i = 0; equal && i < contacts.size(); ++i) equal = same(contacts[i], expected[i % expected.size()]);
    if (!equal) wrong(fmt::format("{} has other contacts", how));
    for (const ParticleState& s : particles.states())
      if (!same(s, result_.state)) wrong(fmt::format("{} ends elsewhere", how));
  }

  void check_end() {
    const CombinatorialMap& map = environment_.map();
    for (const Contact& c : result_.contacts.contacts)
      for (const WallHit& w : result_.contacts.walls_of(c))
        result_.cut = result_.cut || map.patch_names()[w.patch.value] == StepReplay::cut_patch;
    const Audit audited = audit(environment_.complex(), alone_, Threads{1});
    if (audited.failed > 0) wrong(audited.first);
    if (!is_same_chamber(step_.state.cell, result_.state.cell)) wrong("the particle has passed a wall");
  }

  [[nodiscard]] bool is_same_chamber(Cell from, Cell to) const {
    std::vector<Cell> front = {from};
    std::unordered_set<std::uint32_t> seen = {from.value};
    while (!front.empty()) {
      const Cell c = front.back();
      front.pop_back();
      if (c == to) return true;
      const CellView cell = environment_.map().view(c);
      for (std::uint16_t f = 0; f < cell.shape().face_count(); ++f) {
        const Cell next = cell.neighbour(f);
        if (!cell.is_wall(f) && next.valid() && seen.insert(next.value).second) front.push_back(next);
      }
    }
    return false;
  }

  const StepReplay& step_;
  std::unique_ptr<Environment> environment_of_;
  Environment& environment_;
  Particles several_, in_rounds_, alone_;
  ReplayResult result_;
};

}  // namespace

ReplayResult replay(const StepReplay& step) { return Replay(step).run(); }

}  // namespace dartcast
