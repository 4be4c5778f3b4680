// Steps in a part of an environment. The batch takes those that it can, TravellingStepper the others. Steps that need
// another rank's cells go there.
//
// The phases, in order:
// 1. The chunks of the batch. It passes ghosts like any cells. A step that it has ended on a facet in a ghost is taken
//    back, because walls around the ghost may be unknown here. The same holds for a walk to a wall of a ghost.
// 2. Until no rank has a step under way: answer contacts round by round; send the steps that leave; go on with those that
//    come.
// 3. Send particles that have ended in ghosts to their ranks.
// 4. Put the contacts in the order of particles.
#include <algorithm>
#include <utility>

#include "base/parallel.hpp"
#include "dartcast/error.hpp"
#include "tracking/batch/batch_stepper.hpp"

namespace dartcast::detail {

namespace {

// Steps that go from rank to rank are not the batch's: it would have asked other questions.
Counters without_tests(Counters c) {
  c.orientation = {};
  c.histogram = {};
  c.forecast_kept = 0;
  c.updated_by_deformation = 0;
  return c;
}

}  // namespace

class PartSteps {
 public:
  PartSteps(const BatchStepper& batch, const ContactCallback& respond, const GrowingParticles& particles,
            PartTraffic& traffic, std::vector<std::uint8_t>& gone)
      : batch_(batch),
        respond_(respond),
        complex_(batch.complex_),
        cells_(traffic.cells()),
        stepper_(complex_, cells_, batch.moved_, batch.options_),
        particles_(particles),
        traffic_(traffic),
        gone_(gone) {}

  StepReport advance(std::span<const Vec3> targets) {
    gone_.assign(particles_.states.size(), 0);
    met_.assign(particles_.states.size(), 0);
    start(targets);
    while (true) {
      answer_all();
      bool over = false;
      std::vector<Traveller> come = traffic_.exchange(std::exchange(leaving_, {}), over);
      if (over) break;
      take_in(std::move(come));
    }
    send_home();
    const auto lower = [](const auto& a, const auto& b) { return a.particle < b.particle; };
    std::sort(report_.held.begin(), report_.held.end(), lower);
    std::sort(report_.stopped.begin(), report_.stopped.end(), lower);
    report_.contacts = by_particle();
    report_.counters = without_tests(report_.counters);
    return std::move(report_);
  }

 private:
  // Phase 1.
  void start(std::span<const Vec3> targets) {
    const std::size_t count = targets.size();
    const BatchScene scene = batch_.scene_of(particles_.cache, count);
    const std::vector<ParticleState> before = particles_.states;
    const std::vector<Weights> weights_before = particles_.weights;
    ContactList met;
    for (std::size_t begin = 0; begin < count; begin += max_batch)
      start_chunk(scene, before, weights_before, targets, begin, std::min(count, begin + max_batch), met);
    rounds_.push_back(std::move(met));
  }

  void start_chunk(const BatchScene& scene, const std::vector<ParticleState>& before,
                   const std::vector<Weights>& weights_before, std::span<const Vec3> targets, std::size_t begin,
                   std::size_t end, ContactList& met) {
    const std::size_t size = end - begin;
    std::vector<StepStatus> status(size);
    std::vector<StepState> partial;
    partial.reserve(size);
    ParticleCache& cache = particles_.cache;
    const BatchSteps steps{std::span(particles_.states).subspan(begin, size),
                           std::span(cache.vertices_).subspan(begin, size),
                           cache.simplices_.from(begin),
                           targets.subspan(begin, size),
                           status,
                           partial};
    step_batch(scene, steps, report_.counters);
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t p = begin + i;
      const bool complete = status[i] == step_complete;
      if (complete) {
        if (!must_be_taken_back(particles_.states[p])) continue;
        particles_.states[p] = before[p];
        particles_.weights[p] = weights_before[p];
      }
      if (complete) --report_.counters.particle_steps;  // the batch has counted it
      const bool untouched = complete || status[i] == step_untouched;
      Traveller t;
      t.home = cells_.rank();
      if (!untouched && cells_.is_own(partial[status[i]].walk.simplex.cell)) t.step = partial[status[i]];
      t.step.begin(static_cast<std::uint32_t>(p), particles_.states[p], targets[p], met);
      stepper_.run(t, particle(p, met));
      take(std::move(t), met, waiting_);
    }
  }

  [[nodiscard]] SteppedParticle particle(std::size_t p, ContactList& list) {
    return {particles_.states[p], particles_.weights[p], list, report_.counters};
  }

  // Whether a step that the batch has ended may lie on walls that this rank does not know.
  [[nodiscard]] bool must_be_taken_back(const ParticleState& s) const {
    return !cells_.is_own(s.cell) && zeros_of(complex_.corners(s.at()), s.position) != 0;
  }

  // A step that has come as far as it can, here and now.
  void take(Traveller t, const ContactList& list, std::vector<Traveller>& waiting) {
    const std::uint32_t p = t.step.particle;
    if (t.step.waits()) {
      ++met_[p];
      t.contact = list.contacts.size() - 1;
      waiting.push_back(std::move(t));
      return;
    }
    const bool done = t.step.stage == StepStage::done;
    if (done && particles_.states[p].cell.valid()) return end(t.step);
    if (done) {  // it stays where it was, on another rank
      t.to = t.home;
      t.step.result.invalid_cell = cells_.whole(t.step.result.invalid_cell);
    }
    go(std::move(t));
  }

  void go(Traveller t) {
    const std::uint32_t p = t.step.particle;
    t.met = met_[p];
    t.weights = particles_.weights[p];
    gone_[p] = 1;
    leaving_.push_back(std::move(t));
  }

  void end(const StepState& step) {
    const std::uint32_t p = step.particle;
    if (step.result.held) report_.held.push_back({p, step.result.invalid_cell});
    if (step.result.stopped) report_.stopped.push_back({p, step.result.unused});
    particles_.cache.place(p, complex_, particles_.states[p]);
  }

  // The contacts that wait are in the list of the last round, among those of particles that may not go on.
  void answer_all() {
    while (!waiting_.empty()) {
      const ContactList& met = rounds_.back();
      ContactList next;
      std::vector<Traveller> waiting;
      for (Traveller& t : waiting_) {
        const Contact& contact = met.contacts[t.contact];
        const AfterContact after = respond_(contact, met.walls_of(contact), met.earlier_walls_of(contact));
        stepper_.answer(met, contact, after, t, particle(t.step.particle, next));
        take(std::move(t), next, waiting);
      }
      waiting_ = std::move(waiting);
      rounds_.push_back(std::move(next));
    }
  }

  void take_in(std::vector<Traveller> come) {
    ContactList met;
    for (Traveller& t : come) {
      const auto p = static_cast<std::uint32_t>(particles_.states.size());
      t.step.particle = p;
      particles_.states.push_back(state_here(cells_, t.state));
      particles_.weights.push_back(t.weights);
      gone_.push_back(0);
      met_.push_back(0);
      add_cache(t);
      if (t.step.stage == StepStage::done) {
        arrive(t);
        continue;
      }
      stepper_.run(t, particle(p, met));
      take(std::move(t), met, waiting_);
    }
    rounds_.push_back(std::move(met));
  }

  // The entry is made anew where the step ends; a cell that is not here has none.
  void add_cache(const Traveller& t) {
    const Cell here = cells_.here(t.state.cell);
    const SimplexId any = {here.valid() ? here : complex_.map().cells().front(), 0};
    particles_.cache.add(complex_, here.valid() ? SimplexId{here, t.state.simplex} : any, t.state.position);
  }

  void arrive(Traveller& t) {
    const ParticleState& s = particles_.states[t.step.particle];
    const auto touching = std::span(s.touching).first(s.touching_count);
    const bool known = std::all_of(touching.begin(), touching.end(), [](const CellFace& f) { return f.cell.valid(); });
    if (!s.cell.valid() || !known)
      throw InternalError("a particle has come to a rank that does not have its cell " +
                          std::to_string(t.state.cell.value) +
                          " and the walls that it touches; please report it with the scene and the number of ranks");
    t.step.result.invalid_cell = cells_.here(t.step.result.invalid_cell);
    end(t.step);
  }

  // Phase 3.
  void send_home() {
    for (std::uint32_t p = 0; p < particles_.states.size(); ++p) {
      if (gone_[p] != 0 || cells_.is_own(particles_.states[p].cell)) continue;
      Traveller t;
      t.step.particle = p;
      t.step.stage = StepStage::done;
      t.to = cells_.owner(particles_.states[p].cell);
      t.state = whole_state(cells_, particles_.states[p]);
      go(std::move(t));
    }
    bool over = false;
    take_in(traffic_.exchange(std::exchange(leaving_, {}), over));
  }

  // Phase 4. A particle may have contacts in any rounds; those met earlier have fewer walls in front of them.
  [[nodiscard]] ContactList by_particle() const {
    struct Place {
      std::size_t round, contact;
    };
    std::vector<Place> places;
    for (std::size_t r = 0; r < rounds_.size(); ++r) {
      for (std::size_t c = 0; c < rounds_[r].contacts.size(); ++c) places.push_back({r, c});
    }
    const auto at = [&](const Place& p) -> const Contact& { return rounds_[p.round].contacts[p.contact]; };
    std::stable_sort(places.begin(), places.end(), [&](const Place& a, const Place& b) {
      return std::pair{at(a).particle, at(a).earlier} < std::pair{at(b).particle, at(b).earlier};
    });
    ContactList all;
    for (const Place& p : places) {
      Contact c = at(p);
      const auto walls = all_walls_of(rounds_[p.round], c);
      c.first_wall = static_cast<std::uint32_t>(all.walls.size()) + c.earlier;
      all.walls.insert(all.walls.end(), walls.begin(), walls.end());
      all.contacts.push_back(c);
    }
    return all;
  }

  const BatchStepper& batch_;
  const ContactCallback& respond_;
  const CellComplex& complex_;
  const PartCells& cells_;
  TravellingStepper stepper_;
  const GrowingParticles& particles_;
  PartTraffic& traffic_;
  std::vector<std::uint8_t>& gone_;
  StepReport report_;
  std::vector<Traveller> waiting_;  // one for each contact of the last round
  std::vector<Traveller> leaving_;
  std::vector<ContactList> rounds_;
  std::vector<std::uint32_t> met_;  // contacts, by particle
};

StepReport BatchStepper::advance_in_part(const GrowingParticles& particles, std::span<const Vec3> targets,
                                         const ContactCallback& respond, PartTraffic& traffic,
                                         std::vector<std::uint8_t>& gone) const {
  const std::vector<Vec3> decided = decided_targets(targets);
  return PartSteps(*this, respond, particles, traffic, gone).advance(decided.empty() ? targets : decided);
}

}  // namespace dartcast::detail
