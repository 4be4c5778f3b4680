// Steps in a part of an environment: the batch takes those that it can, TravellingStepper the others, and steps that need
// another rank's cells go there.
//
// The phases, in order:
// 1. The chunks of the batch. It passes ghosts like any cells. A step that it has ended on a facet in a ghost is taken
//    back, because walls around the ghost may be unknown here; the same holds for a walk to a wall of a ghost.
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
    std::vector<PartialStep> partial;
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
      const bool untouched = complete || status[i] == step_untouched;
      const PartialStep* const so_far =
          untouched || !cells_.is_own(partial[status[i]].walk.simplex.cell) ? nullptr : &partial[status[i]];
      TravellingPause pause;
      const TravelResult result =
          stepper_.start(static_cast<std::uint32_t>(p), particles_.states[p], particles_.weights[p], targets[p], met,
                         report_.counters, so_far, pause);
      if (complete) --report_.counters.particle_steps;  // the batch has counted it, too
      take(result, std::move(pause), static_cast<std::uint32_t>(p), met, waiting_);
    }
  }

  // Whether a step that the batch has ended may lie on walls that this rank does not know.
  [[nodiscard]] bool must_be_taken_back(const ParticleState& s) const {
    return !cells_.is_own(s.cell) && zeros_of(complex_.corners(s.at()), s.position) != 0;
  }

  // A step that has come as far as it can, here and now.
  void take(const TravelResult& result, TravellingPause pause, std::uint32_t particle, const ContactList& list,
            std::vector<TravellingPause>& waiting) {
    if (result.waits) {
      ++met_[particle];
      pause.contact = list.contacts.size() - 1;
      waiting.push_back(std::move(pause));
      return;
    }
    const ParticleState& state = particles_.states[particle];
    if (result.leaves) {
      go(std::move(pause.traveller), particle);
      return;
    }
    if (!state.cell.valid()) {  // it stays where it was, on another rank
      Traveller& t = pause.traveller;
      t.stage = TravelStage::done;
      t.to = t.home;
      t.result = result.result;
      t.result.invalid_cell = cells_.whole(t.result.invalid_cell);
      go(std::move(t), particle);
      return;
    }
    note(result.result, particle);
    particles_.cache.place(particle, complex_, state);
  }

  void go(Traveller traveller, std::uint32_t particle) {
    traveller.particle = particle;
    traveller.met = met_[particle];
    traveller.weights = particles_.weights[particle];
    gone_[particle] = 1;
    leaving_.push_back(std::move(traveller));
  }

  void note(const StepResult& result, std::uint32_t particle) {
    if (result.held) report_.held.push_back({particle, result.invalid_cell});
    if (result.stopped) report_.stopped.push_back({particle, result.unused});
  }

  // The contacts that wait are in the list of the last round, among those of particles that may not go on.
  void answer_all() {
    while (!waiting_.empty()) {
      const ContactList& met = rounds_.back();
      ContactList next;
      std::vector<TravellingPause> waiting;
      for (TravellingPause& pause : waiting_) {
        const std::uint32_t p = pause.step.particle;
        const Contact& contact = met.contacts[pause.contact];
        const AfterContact after = respond_(contact, met.walls_of(contact), met.earlier_walls_of(contact));
        const TravelResult result = stepper_.answer(met, contact, after, particles_.states[p], particles_.weights[p],
                                                    next, report_.counters, pause);
        take(result, std::move(pause), p, next, waiting);
      }
      waiting_ = std::move(waiting);
      rounds_.push_back(std::move(next));
    }
  }

  void take_in(std::vector<Traveller> come) {
    ContactList met;
    for (Traveller& t : come) {
      const auto p = static_cast<std::uint32_t>(particles_.states.size());
      t.particle = p;
      particles_.states.push_back(state_here(cells_, t.state));
      particles_.weights.push_back(t.weights);
      gone_.push_back(0);
      met_.push_back(0);
      add_cache(t);
      if (t.stage == TravelStage::done) {
        arrive(t, p);
        continue;
      }
      TravellingPause pause;
      pause.traveller = std::move(t);
      const TravelResult result =
          stepper_.go_on(particles_.states[p], particles_.weights[p], met, report_.counters, pause);
      take(result, std::move(pause), p, met, waiting_);
    }
    rounds_.push_back(std::move(met));
  }

  // The entry is made anew where the step ends; a cell that is not here has none.
  void add_cache(const Traveller& t) {
    const Cell here = cells_.here(t.state.cell);
    const SimplexId any = {here.valid() ? here : complex_.map().cells().front(), 0};
    particles_.cache.add(complex_, here.valid() ? SimplexId{here, t.state.simplex} : any, t.state.position);
  }

  void arrive(const Traveller& t, std::uint32_t p) {
    const ParticleState& s = particles_.states[p];
    const auto touching = std::span(s.touching).first(s.touching_count);
    const bool known = std::all_of(touching.begin(), touching.end(), [](const CellFace& f) { return f.cell.valid(); });
    if (!s.cell.valid() || !known)
      throw InternalError("a particle has come to a rank that does not have its cell " +
                          std::to_string(t.state.cell.value) +
                          " and the walls that it touches; please report it with the scene and the number of ranks");
    StepResult result = t.result;
    result.invalid_cell = cells_.here(result.invalid_cell);
    note(result, p);
    particles_.cache.place(p, complex_, s);
  }

  // Phase 3.
  void send_home() {
    for (std::uint32_t p = 0; p < particles_.states.size(); ++p) {
      if (gone_[p] != 0 || cells_.is_own(particles_.states[p].cell)) continue;
      Traveller t;
      t.stage = TravelStage::done;
      t.to = cells_.owner(particles_.states[p].cell);
      t.state = whole_state(cells_, particles_.states[p]);
      go(std::move(t), p);
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
  std::vector<TravellingPause> waiting_;  // one for each contact of the last round
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
