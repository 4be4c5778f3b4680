// Points: every step by the batch, by each particle alone, and in rounds; first contacts by all walls.
#include <fmt/format.h>

#include <atomic>

#include "dartcast/cell_complex.hpp"
#include "dartcast/error.hpp"
#include "dartcast/replay.hpp"
#include "dartcast/spheres.hpp"
#include "soak/guests.hpp"
#include "soak/periodic.hpp"
#include "soak/truth.hpp"
#include "support/particle_checks.hpp"
#include "support/report_words.hpp"
#include "support/sphere_checks.hpp"

namespace dartcast::soak {

namespace {

// Throws at a call, of all calls of a step.
ContactCallback throwing(ContactCallback respond, std::uint32_t at) {
  if (!respond) return respond;
  auto calls = std::make_shared<std::atomic<std::uint32_t>>(0);
  return [respond = std::move(respond), calls, at](const Contact& c, std::span<const WallHit> walls,
                                                   std::span<const WallHit> earlier) {
    if (calls->fetch_add(1) == at) throw Thrown();
    return respond(c, walls, earlier);
  };
}

void note_report(const StepReport& report, Seen& seen) {
  constexpr std::array kinds = {Mark::vertex_contact, Mark::edge_contact, Mark::face_contact};
  for (std::size_t k = 0; k < kinds.size(); ++k)
    if (report.counters.contacts[k] > 0) seen.note(kinds[k]);
  if (!report.held.empty()) seen.note(Mark::held);
  if (report.counters.steps_split > 0) seen.note(Mark::slices);
  if (report.counters.unfinished > 0) seen.note(Mark::unfinished);
  if (!report.contacts.crossings.empty()) seen.note(Mark::passage);
  for (const Contact& c : report.contacts.contacts) {
    if (c.wall_count > 1) seen.note(Mark::several_walls);
    if (c.earlier > 2) seen.note(Mark::many_contacts);
  }
}

// A step that throws changes nothing; the next one is as if it had not been. `step` takes the callback.
template <class TakeStep>
std::string throw_first(const Case& c, const Step& step, Crowd& crowd, Answers& answers, Seen& seen, TakeStep&& take) {
  if (c[Knob::throws] == 0 || c.is(Knob::response, "stop")) return "";
  const std::vector<ParticleState> before = test::copy_of(crowd.particles);
  const Particles copy = crowd.particles;
  const std::uint32_t at = random_for(c, Use::throwing, step.number).below(4);
  bool thrown = false;
  try {
    take(throwing(answers.one_by_one(), at));
  } catch (const Thrown&) {
    thrown = true;
  }
  if (!thrown) {
    crowd.particles = copy;
  } else {
    seen.note(Mark::thrown);
    if (!test::same_bits(before, crowd.particles)) return "a step that threw has changed a particle";
    for (std::size_t i = 0; i < copy.size(); ++i)
      if (copy.vertex_numbers()[i] != crowd.particles.vertex_numbers()[i])
        return "a step that threw has changed vertex numbers";
  }
  return "";
}

// The first contact of each particle; null: none.
template <class Visit>
void for_each_first(const StepReport& report, std::size_t particles, Visit&& visit) {
  std::size_t next = 0;
  const auto& contacts = report.contacts.contacts;
  for (std::size_t i = 0; i < particles; ++i) {
    const Contact* first = next < contacts.size() && contacts[next].particle == i ? &contacts[next] : nullptr;
    visit(i, first, first != nullptr ? report.contacts.walls_of(*first) : std::span<const WallHit>{});
    while (next < contacts.size() && contacts[next].particle == i) ++next;
  }
}

class Points : public Guest {
 public:
  Points(const Case& c, const SceneMesh& scene, Environment& environment)
      : case_(c), scene_(scene), crowd_(c, scene, environment, Crowd::points) {
    if (is_periodic()) truth_ = std::make_unique<PeriodicTruth>(c, scene, environment);
  }

  [[nodiscard]] std::string name() const override { return "points"; }
  Crowd& crowd() override { return crowd_; }

  std::string step(Environment& environment, const Step& step, Seen& seen) override {
    const std::vector<Vec3> targets = crowd_.targets(environment, step.number);
    crowd_.head_for(targets);
    const auto answers = crowd_.answers(step.number), in_rounds = crowd_.answers(step.number),
               alone = crowd_.answers(step.number), thrown = crowd_.answers(step.number);
    std::string wrong = throw_first(case_, step, crowd_, *thrown, seen, [&](const ContactCallback& f) {
      const Crossings crossings(*this, environment, *thrown);
      environment.advance(crowd_.particles, targets, f, options());
    });
    if (!wrong.empty()) return wrong;
    const Particles before = crowd_.particles;
    const auto crossings = std::make_unique<Crossings>(*this, environment, *answers);
    const StepReport report = environment.advance(crowd_.particles, targets, answers->one_by_one(), options());
    note_report(report, seen);
    wrong = check_report(report, crowd_.size());
    if (wrong.empty()) wrong = compare_with_traces(environment, before, targets, report, *alone);
    if (wrong.empty()) wrong = take_again(environment, step, before, targets, seen);
    if (wrong.empty() && truth_)
      wrong = truth_->check(
          environment, crowd_,
          {step.number, step.moved, step.valid, before, targets, report, *answers, crossings->crossed, options()});
    // A trace calls nothing at crossings, so nobody turns the velocities.
    const bool turns = case_.is(Knob::periodic, "turned");
    if (wrong.empty() && ((!turns && alone->velocities != answers->velocities) || alone->statuses != answers->statuses))
      wrong = "traces have other velocities";
    if (wrong.empty() && case_[Knob::rounds] != 0) {
      const Crossings again_crossed(*this, environment, *in_rounds);
      Particles again = before;
      const StepReport rounds = environment.advance_in_rounds(again, targets, in_rounds->in_rounds(), options());
      if (!test::same_bits(test::copy_of(crowd_.particles), again)) wrong = "rounds have other states";
      if (test::words_of(report) != test::words_of(rounds)) wrong = "rounds have another report";
      if (test::words_of(report.counters) != test::words_of(rounds.counters)) wrong = "rounds have other counts";
      if (in_rounds->velocities != answers->velocities) wrong = "rounds have other velocities";
    }
    if (wrong.empty() && step.valid && !step.moved && !is_periodic())
      wrong = compare_with_walls(environment, before, targets, report, seen);
    if (wrong.empty() && !step.moved) wrong = check_energy(*answers);
    for (const ParticleStatus fate : answers->statuses)
      if (fate != ParticleStatus::alive) seen.note(Mark::left);
    if (!wrong.empty() && at_fault_) seen.replay = record(environment, step, before, targets, *at_fault_);
    crowd_.answered(*answers);
    return wrong;
  }

 private:
  // Hears of crossings, in a mesh with pairs, as long as it lives.
  struct Crossings {
    Crossings(const Points& points, Environment& environment, Answers& answers)
        : crossed(points.scene_, answers.velocities), heard(environment) {
      if (points.is_periodic()) heard.set_crossing_callback(crossed.callback());
    }
    ~Crossings() { heard.set_crossing_callback({}); }
    Crossings(const Crossings&) = delete;
    Crossings& operator=(const Crossings&) = delete;

    Crossed crossed;
    Environment& heard;
  };

  [[nodiscard]] bool is_periodic() const { return case_[Knob::periodic] != 0; }
  [[nodiscard]] StepReplay record(const Environment& environment, const Step& step, const Particles& before,
                                  const std::vector<Vec3>& targets, std::size_t particle) const {
    const auto answers = crowd_.answers(step.number);
    return environment.record(before, particle, targets[particle], answers->one_by_one(), options());
  }

  // A step that is recorded, written and read does the same among its few cells.
  std::string take_again(const Environment& environment, const Step& step, const Particles& before,
                         const std::vector<Vec3>& targets, Seen& seen) {
    if (before.size() == 0 || environment.complex().steiner_point_count() > 0) return "";
    const std::size_t i = random_for(case_, Use::throwing, step.number, 1).below(std::uint32_t(before.size()));
    if (is_periodic()) return "";  // faces of pairs are walls in it
    const StepReplay recorded = record(environment, step, before, targets, i);
    ReplayResult result;
    try {
      result = replay(replay_of_text(replay_text(recorded)));
    } catch (const Error&) {  // cells that are not valid then, or get a Steiner point
      if (step.valid) throw;
      return "";
    }
    std::string wrong = result.wrong;
    if (wrong.empty() && step.valid && !result.cut &&
        test::bits(result.state.position) != test::bits(crowd_.particles[i].position))
      wrong = "it ends elsewhere";
    seen.note(Mark::taken_again);
    if (wrong.empty()) return "";
    seen.replay = recorded;
    return fmt::format("the replay of particle {}: {}", crowd_.ids[i], wrong);
  }

  [[nodiscard]] StepOptions options() const {
    StepOptions o;
    if (case_.seed % 5 == 0) o.max_contacts = 1 + static_cast<unsigned>(case_.seed % 3);
    if (case_.seed % 7 == 0) o.max_slices = 3;
    if (case_.seed % 11 == 0) o.tolerance = 1e-3;
    return o;
  }

  std::string compare_with_traces(const Environment& environment, const Particles& before,
                                  const std::vector<Vec3>& targets, const StepReport& report, Answers& alone) {
    std::size_t next = 0;
    auto crossing = report.contacts.crossings.begin();
    const auto& contacts = report.contacts.contacts;
    const ContactCallback respond = alone.one_by_one();
    for (std::size_t i = 0; i < before.size(); ++i) {
      const Trace trace = environment.trace(before, i, {&targets[i], 1}, respond, options()).at(0);
      std::string difference = test::same_bits(trace.after, crowd_.particles[i]) ? "" : "another state";
      for (const Contact& c : trace.contacts.contacts) {
        const bool same = next < contacts.size() &&
                          test::words_of(trace.contacts, c) == test::words_of(report.contacts, contacts[next]);
        if (!same) difference += ", another contact";
        ++next;
      }
      for (const PeriodicCrossing& c : trace.contacts.crossings) {
        const bool same = crossing != report.contacts.crossings.end() && crossing->to == c.to &&
                          test::bits(crossing->point) == test::bits(c.point) && crossing->time == c.time;
        if (!same) difference += ", another passage";
        ++crossing;
      }
      for (std::size_t k = 1; k < trace.crossings.size(); ++k)
        if (trace.crossings[k].time < trace.crossings[k - 1].time ||
            trace.crossings[k].from != trace.crossings[k - 1].to)
          difference += ", crossings out of order";
      if (difference.empty()) continue;
      at_fault_ = i;
      return fmt::format("particle {} alone has {}", crowd_.ids[i], difference);
    }
    return next == contacts.size() ? "" : "contacts that no particle alone has";
  }

  std::string compare_with_walls(const Environment& environment, const Particles& before,
                                 const std::vector<Vec3>& targets, const StepReport& report, Seen& seen) {
    const Walls walls(environment, false);
    std::string wrong;
    for_each_first(report, before.size(), [&](std::size_t i, const Contact* first, std::span<const WallHit> hits) {
      if (!wrong.empty() || before[i].held || crowd_.particles[i].held) return;
      wrong = walls.check_first(before[i], targets[i], first, hits);
      seen.note_true_step();
      if (wrong.empty()) return;
      at_fault_ = i;
      wrong = fmt::format("particle {}: {}", crowd_.ids[i], wrong);
    });
    return wrong;
  }

  // A response gives no particle energy among walls at rest.
  std::string check_energy(const Answers& answers) {
    if (case_.is(Knob::response, "any answer") || case_.is(Knob::response, "into the wall")) return "";
    for (std::size_t i = 0; i < crowd_.size(); ++i)
      if (norm(answers.velocities[i]) > norm(crowd_.velocities[i]) * (1.0 + 1e-12))
        return fmt::format("particle {} has got energy", crowd_.ids[i]);
    return "";
  }

  const Case& case_;
  const SceneMesh& scene_;
  Crowd crowd_;
  std::unique_ptr<PeriodicTruth> truth_;  // null without pairs
  std::optional<std::size_t> at_fault_;   // the particle whose step is wrong
};

// Steps of one particle alone, to compare with those of many.
template <class Advance>
std::string compare_with_single(const Particles& before, const Crowd& crowd, const StepReport& report,
                                Advance&& advance) {
  std::size_t next = 0;
  const auto& contacts = report.contacts.contacts;
  for (std::uint32_t i = 0; i < before.size(); ++i) {
    Particles one = before.selected(std::vector<std::uint32_t>{i});
    const StepReport alone = advance(one, i);
    std::string difference = test::same_bits(one[0], crowd.particles[i]) ? "" : "another state";
    for (Contact c : alone.contacts.contacts) {
      c.particle = i;
      const bool same = next < contacts.size() &&
                        test::words_of(alone.contacts, c) == test::words_of(report.contacts, contacts[next]);
      if (!same) difference += ", another contact";
      ++next;
    }
    if (!difference.empty()) return fmt::format("particle {} alone has {}", crowd.ids[i], difference);
  }
  return next == contacts.size() ? "" : "contacts that no particle alone has";
}

class Simultaneous : public Guest {
 public:
  Simultaneous(const Case& c, const SceneMesh& scene, Environment& environment)
      : case_(c), crowd_(c, scene, environment, Crowd::simultaneous) {}

  [[nodiscard]] std::string name() const override { return "simultaneous points"; }
  Crowd& crowd() override { return crowd_; }

  std::string step(Environment& environment, const Step& step, Seen& seen) override {
    const std::vector<Vec3> targets = crowd_.targets(environment, step.number);
    crowd_.head_for(targets);
    const auto all = crowd_.answers(step.number), thrown = crowd_.answers(step.number);
    std::string wrong = throw_first(case_, step, crowd_, *thrown, seen, [&](const ContactCallback& f) {
      stepper_.advance(environment, crowd_.particles, targets, f);
    });
    if (!wrong.empty()) return wrong;
    const Particles before = crowd_.particles;
    const StepReport report = stepper_.advance(environment, crowd_.particles, targets, all->one_by_one());
    note_report(report, seen);
    wrong = check_report(report, crowd_.size());
    if (wrong.empty())
      wrong = compare_with_single(before, crowd_, report, [&](Particles& one, std::uint32_t i) {
        const auto answers = crowd_.answers(step.number, i, 1);
        return single_.advance(environment, one, {&targets[i], 1}, answers->one_by_one());
      });
    if (wrong.empty() && step.valid && step.moved)
      wrong = compare_with_walls(environment, step.number, before, targets, report, seen);
    crowd_.answered(*all);
    return wrong;
  }

 private:
  std::string compare_with_walls(const Environment& environment, std::uint64_t number, const Particles& before,
                                 const std::vector<Vec3>& targets, const StepReport& report, Seen& seen) {
    const Walls walls(environment, true);
    std::string wrong;
    for_each_first(report, before.size(), [&](std::size_t i, const Contact* first, std::span<const WallHit> hits) {
      if (!wrong.empty() || before[i].held || crowd_.particles[i].held || before[i].touching_count > 0) return;
      if ((crowd_.ids[i] + number) % 4 != 0) return;  // exact roots take long
      wrong = walls.check_first_simultaneous(before[i], targets[i], first, hits);
      if (!wrong.empty()) wrong = fmt::format("particle {}: {}", crowd_.ids[i], wrong);
      seen.note_true_step();
    });
    return wrong;
  }

  const Case& case_;
  Crowd crowd_;
  SimultaneousStepper stepper_, single_;
};

class Spheres : public Guest {
 public:
  Spheres(const Case& c, const SceneMesh& scene, Environment& environment)
      : case_(c), scene_(scene), crowd_(c, scene, environment, Crowd::spheres) {}

  [[nodiscard]] std::string name() const override { return "spheres"; }
  Crowd& crowd() override { return crowd_; }

  std::string step(Environment& environment, const Step& step, Seen& seen) override {
    const std::vector<Vec3> targets = crowd_.targets(environment, step.number);
    std::vector<double> radii;
    for (const std::uint64_t id : crowd_.ids) {
      Random random = random_for(case_, Use::place, 99, id);
      const bool point = random.below(4) == 0;
      radii.push_back(point ? 0.0 : random.uniform(0.01, 0.4) * scene_.edge);
    }
    crowd_.head_for(targets);
    const auto all = crowd_.answers(step.number), thrown = crowd_.answers(step.number);
    std::string wrong = throw_first(case_, step, crowd_, *thrown, seen, [&](const ContactCallback& f) {
      stepper_.advance(environment, crowd_.particles, radii, targets, f);
    });
    if (!wrong.empty()) return wrong;
    const Particles before = crowd_.particles;
    const SphereReport report = stepper_.advance(environment, crowd_.particles, radii, targets, all->one_by_one());
    note_report(report.step, seen);
    if (!report.overlaps.empty()) seen.note(Mark::overlap);
    wrong = check_report(report.step, crowd_.size());
    if (wrong.empty())
      wrong = compare_with_single(before, crowd_, report.step, [&](Particles& one, std::uint32_t i) {
        const auto answers = crowd_.answers(step.number, i, 1);
        return single_.advance(environment, one, {&radii[i], 1}, {&targets[i], 1}, answers->one_by_one()).step;
      });
    if (wrong.empty() && step.valid && !step.moved)
      wrong = compare_with_walls(environment, before, radii, targets, report, seen);
    crowd_.answered(*all);
    return wrong;
  }

 private:
  // A first contact is never late, and early by no more than the bound.
  std::string compare_with_walls(const Environment& environment, const Particles& before,
                                 const std::vector<double>& radii, const std::vector<Vec3>& targets,
                                 const SphereReport& report, Seen& seen) {
    if (environment.map().dimension() == 2) return "";
    const auto walls = test::all_walls(environment.complex(), false);
    std::string wrong;
    for_each_first(report.step, before.size(), [&](std::size_t i, const Contact* first, std::span<const WallHit>) {
      const Vec3& p = before[i].position;
      const Vec3& q = targets[i];
      if (!wrong.empty() || radii[i] == 0.0 || before[i].held) return;
      const double room = test::clearance(walls, p) - radii[i];
      if (room < 1e-9 * scene_.edge) return;  // it touches or overlaps a wall at the start
      const double length = norm(q - p);
      double latest = 2.0;  // the first time at which the swept sphere is in a wall by more than rounding
      constexpr int samples = 8;
      for (int k = 1; k <= samples && latest > 1.0; ++k) {
        const double t = static_cast<double>(k) / samples;
        if (test::clearance(walls, p + (q - p) * t) < radii[i] - 1e-9 * scene_.edge) latest = t;
      }
      seen.note_true_step();
      const double time = first != nullptr ? first->time_of_impact : 2.0;
      if (time > latest + 1e-12 && length < 4.0 * scene_.edge)
        wrong = fmt::format("sphere {} is in a wall at {}, its contact at {}", crowd_.ids[i], latest, time);
      if (first != nullptr &&
          test::clearance(walls, p + (q - p) * time) > radii[i] + (1e-9 + 1e-8 * length / scene_.edge) * scene_.edge)
        wrong = fmt::format("sphere {} has a contact at {} where no wall is", crowd_.ids[i], time);
    });
    return wrong;
  }

  const Case& case_;
  const SceneMesh& scene_;
  Crowd crowd_;
  SphereStepper stepper_, single_;
};

}  // namespace

std::unique_ptr<Guest> make_points(const Case& c, const SceneMesh& scene, Environment& environment) {
  return std::make_unique<Points>(c, scene, environment);
}
std::unique_ptr<Guest> make_simultaneous(const Case& c, const SceneMesh& scene, Environment& environment) {
  return std::make_unique<Simultaneous>(c, scene, environment);
}
std::unique_ptr<Guest> make_spheres(const Case& c, const SceneMesh& scene, Environment& environment) {
  return std::make_unique<Spheres>(c, scene, environment);
}

}  // namespace dartcast::soak
