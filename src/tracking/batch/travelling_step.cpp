// Steps that leave a part of an environment, and that come to it. The recorder decides where a step leaves, and writes down
// all that it needs to go on.
//
// The phases of a walk here: go to the wall or to the target's simplex; if that is another rank's, and its surroundings
// matter, leave; else end the walk as tracking/walk.hpp does.
#include "tracking/batch/travelling_step.hpp"

#include <utility>

#include "tracking/step_run.hpp"

namespace dartcast {

namespace {

const ContactCallback no_response;

Vec3 place_of(const Stored&, const CarriedWall& wall, unsigned i) { return wall.now[i]; }
Vec3 place_of(const Between& positions, const CarriedWall& wall, unsigned i) {
  if (positions.s == 1.0) return wall.now[i];
  return wall.before[i] + (wall.now[i] - wall.before[i]) * positions.s;
}

// Whether this rank has its cell, and those of the walls that it touches.
bool is_known(const ParticleState& s) {
  const auto touching = std::span(s.touching).first(s.touching_count);
  return s.cell.valid() &&
         std::all_of(touching.begin(), touching.end(), [](const CellFace& f) { return f.cell.valid(); });
}

template <std::size_t N>
class TravelRecorder {
  using Run = detail::RunOf<TravelRecorder>;

 public:
  static constexpr bool pausing = true;
  static constexpr bool travels = true;

  TravelRecorder(const CellComplex& complex, const PartCells& cells, TravellingPause& pause)
      : complex_(&complex), cells_(&cells), pause_(&pause) {
    pause.step.waits = false;
  }

  // As the recorder of steps that pause.
  static NoVisitor visitor() { return {}; }
  template <class... Arguments>
  static void walked(const Arguments&...) {}
  static void put(const ParticleState&, double) {}
  void pause(const TimeInterval& interval) {
    pause_->step.waits = true;
    pause_->step.interval = interval;
    pause_->step.part = 1;
    pause_->step.parts = 1;
  }
  [[nodiscard]] bool waits() const { return pause_->step.waits || left_; }
  void in_part(unsigned part, unsigned parts) {
    pause_->step.part = part;
    pause_->step.parts = parts;
    traveller().part = part;
    traveller().parts = parts;
  }

  [[nodiscard]] bool left() const { return left_; }
  /// The next walk is the rest of the traveller's.
  void take_up_walk() { takes_up_ = true; }

  [[nodiscard]] bool leaves_to_walk(const Run& run, const Vec3& q, const TimeInterval& interval) {
    if (is_own(run.state.cell)) return false;
    leave(TravelStage::walk, q, interval);
    return true;
  }

  [[nodiscard]] bool leaves_to_carry(const Run& run, const Vec3& planned, unsigned part, unsigned parts) {
    if (is_own(run.state.cell)) return false;
    leave(TravelStage::carry, {}, {0.0, 1.0, planned});
    in_part(part, parts);
    return true;
  }

  // Precondition: it does not leave before.
  template <class Positions>
  Walk walk(const Space<Positions, N>& space, Run& run, const PartialStep* partial, const Vec3& p, const Vec3& q,
            const TimeInterval& interval) {
    if (takes_up_) {
      takes_up_ = false;
      const TieCorners ties = traveller().ties;
      const bool restarted = traveller().restarted;
      return end(space, run, take_up(space, ties, p, q, run.tests), ties, restarted, p, q, interval);
    }
    const SimplexId start = run.state.at();
    const TieCorners ties = ties_of(space, start, p);
    NoVisitor none;
    const Walk walk = partial != nullptr ? partial->walk : detail::walk_to_wall(space, start, p, q, run.tests, none);
    return end(space, run, walk, ties, false, p, q, interval);
  }

  template <class Positions>
  WallPlane carried_plane(const Space<Positions, N>& space, const Run& run, const WallHit& wall) const {
    const auto index = static_cast<std::size_t>(&wall - run.contacts.walls.data()) - run.first_wall;
    const CarriedWall& carried = traveller().walls[index];
    std::array<Vec3, N> v{};  // the facet's corners, where facet 0 has them
    for (unsigned i = 0; i + 1 < N; ++i) {
      Vec3& corner = v[facet_corner<N>(0, i)];
      corner = place_of(space.positions, carried, i);
      if constexpr (N == 3) corner.z = 0.0;
    }
    return facet_plane(v, 0);
  }

  // At the end of a call: the step waits or leaves.
  void save(const Run& run, SimplexId, const Vec3&) {
    PausedStep& step = pause_->step;
    step.particle = run.particle;
    step.contact_count = run.contact_count;
    if (is_known(run.state)) {  // else it is what it was when it came here
      traveller().state = whole_state(*cells_, run.state);
      traveller().home = cells_->owner(run.state.cell);
    }
    if (left_) save_traveller(run);
  }

 private:
  [[nodiscard]] Traveller& traveller() const { return pause_->traveller; }
  [[nodiscard]] bool is_own(Cell c) const { return c.valid() && cells_->is_own(c); }

  void leave(TravelStage stage, const Vec3& q, const TimeInterval& interval) {
    left_ = true;
    Traveller& t = traveller();
    t.stage = stage;
    t.target = q;
    t.interval = interval;
    t.part = t.parts = 1;
  }

  // Whether cells around the end of a walk matter that this rank may not know.
  [[nodiscard]] bool needs_others(const Walk& walk) const {
    const bool matters = walk.end == WalkEnd::wall || (walk.end == WalkEnd::arrived && walk.zeros != 0);
    return matters && !cells_->is_own(walk.simplex.cell);
  }

  template <class Positions>
  static TieCorners ties_of(const Space<Positions, N>& space, SimplexId start, const Vec3& p) {
    TieCorners ties;
    const std::array<Vec3, N> v = space.corners(start);
    const unsigned zeros = detail::zeros_of(v, p);
    for (unsigned i = 0; i < N; ++i) {
      if (ties.count < N - 1 && ((zeros >> i) & 1U) != 0) ties.corner[ties.count++] = v[i];
    }
    return ties;
  }

  // The traveller's walk as this rank's own cells have it: it leaves its simplex by the facet, or meets a wall there.
  template <class Positions>
  Walk take_up(const Space<Positions, N>& space, const TieCorners& ties, const Vec3& p, const Vec3& q,
               TestCounts& counts) const {
    Walk walk = traveller().walk;
    walk.simplex = cells_->here(walk.simplex);
    walk.wall_simplex = walk.simplex;
    if (walk.end == WalkEnd::arrived) return walk;
    const CellView cell = space.map->view(walk.simplex.cell);
    const Across across = cell.shape().simplices()[walk.simplex.simplex].across[walk.wall_facet];
    if (across.outer() && cell.is_wall(across.face())) return walk;
    constexpr unsigned all = (1U << N) - 1U;
    const Passage next = pass(*space.map, walk.simplex, cell, across);
    detail::Ties<Positions, N> tie_breaker(space, p, q, std::span(ties.corner).first(ties.count));
    NoVisitor none;
    return detail::walk_on(space, next.simplex, all & ~(1U << next.facet), N - 1, p, q, tie_breaker, counts, none);
  }

  void leave_on_way(const Walk& walk, const TieCorners& ties, bool restarted, const Vec3& q,
                    const TimeInterval& interval) {
    leave(TravelStage::on_way, q, interval);
    Traveller& t = traveller();
    t.walk = walk;
    t.walk.simplex = t.walk.wall_simplex = cells_->whole(walk.simplex);
    t.to = cells_->owner(walk.simplex.cell);
    t.ties = ties;
    t.restarted = restarted;
  }

  // As detail::end_walk(), where it does not leave.
  template <class Positions>
  Walk end(const Space<Positions, N>& space, Run& run, Walk walk, const TieCorners& ties, bool restarted, const Vec3& p,
           const Vec3& q, const TimeInterval& interval) {
    if (needs_others(walk)) {
      leave_on_way(walk, ties, restarted, q, interval);
      return walk;
    }
    if (walk.end == WalkEnd::wall && !walk.at_end && !restarted) {
      ++run.tests.tests;
      if (orient_facet(space.corners(walk.wall_simplex), walk.wall_facet, p) == Sign::zero) {
        const SimplexId restart = detail::simplex_towards(space, walk.wall_simplex, p, q, run.tests);
        walk.at_start = !restart.valid();
        if (restart.valid()) {
          NoVisitor none;
          walk = detail::walk_to_wall(space, restart, p, q, run.tests, none);
          if (needs_others(walk)) {
            leave_on_way(walk, ties_of(space, restart, p), true, q, interval);
            return walk;
          }
        }
      }
    }
    if (walk.end == WalkEnd::arrived && walk.zeros != 0) detail::find_wall_at_end<N>(*space.map, walk);
    return walk;
  }

  [[nodiscard]] CarriedWall carried(const WallHit& hit) const {
    CarriedWall wall{hit, {}, {}};
    wall.hit.face = {};
    const CellView cell = complex_->map().view(hit.face.cell);
    const Across behind = cell.shape().entry(hit.face.face, hit.triangle);
    const auto vertices = complex_->vertices({hit.face.cell, behind.index});
    for (unsigned i = 0; i + 1 < N; ++i) {
      const std::uint32_t v = vertices[facet_corner<N>(behind.place, i)].value;
      wall.before[i] = complex_->previous_positions()[v];
      wall.now[i] = complex_->positions()[v];
    }
    return wall;
  }

  void save_traveller(const Run& run) {
    Traveller& t = traveller();
    t.particle = run.particle;
    if (t.stage != TravelStage::on_way) t.to = t.home;
    t.result = run.result;
    t.result.invalid_cell = cells_->whole(run.result.invalid_cell);
    t.contact_count = run.contact_count;
    t.last_time = run.last_time;
    const auto walls = std::span(run.contacts.walls).subspan(run.first_wall);
    t.together = static_cast<std::uint32_t>(walls.size()) - (run.first_here - run.first_wall);
    for (std::size_t i = t.walls.size(); i < walls.size(); ++i) t.walls.push_back(carried(walls[i]));
  }

  const CellComplex* complex_;
  const PartCells* cells_;
  TravellingPause* pause_;
  bool left_ = false;
  bool takes_up_ = false;
};

template <std::size_t N>
TravelResult result_of(const detail::RunOf<TravelRecorder<N>>& run, const StepResult& result,
                       const TravellingPause& pause) {
  return {pause.step.waits, run.recorder.left(), result};
}

// The part of a step that the traveller is in, in its geometry. Returns as StepPart::move().
template <class Positions, std::size_t N>
Vec3 rest_of_walk(const CellComplex& complex, bool moved, const StepOptions& options, const Space<Positions, N>& space,
                  detail::RunOf<TravelRecorder<N>>& run, const Traveller& t, const PartialStep* partial) {
  return detail::StepPart<Positions, N, TravelRecorder<N>>(complex, moved, space, options, no_response)
      .move(run, t.target, t.interval, partial);
}

}  // namespace

template <std::size_t N>
TravelResult TravellingStepper::start_in(std::uint32_t particle, ParticleState& state, Weights& weights,
                                         const Vec3& target, ContactList& contacts, Counters& counters,
                                         const PartialStep* partial, TravellingPause& pause) const {
  using Recorder = TravelRecorder<N>;
  pause.traveller = {};
  pause.traveller.step_target = target;
  pause.traveller.home = cells_.rank();
  detail::RunOf<Recorder> run{
      particle, state, contacts, counters, {}, 0, 0, 0, -1.0, {}, Recorder(complex_, cells_, pause)};
  run.first_wall = run.first_here = static_cast<std::uint32_t>(contacts.walls.size());
  const Space<Stored, N> space = current_space<N>(complex_);
  const detail::StepPart<Stored, N, Recorder> whole(complex_, moved_, space, options_, no_response);
  if (partial != nullptr) {
    if (partial->parts > 1) {
      detail::MovingStep<N, Recorder>(complex_, options_, no_response).resume(run, weights, target, *partial);
    } else {
      state.position = partial->from;
      whole.move(run, target, {0.0, 1.0, {}}, partial);
    }
  } else if (moved_) {
    detail::MovingStep<N, Recorder>(complex_, options_, no_response).run(run, weights, target);
  } else if (state.held && (!detail::positive(space.corners(state.at())) || !complex_.map().is_free(state.cell))) {
    run.result.held = true;
    run.result.invalid_cell = state.cell;
  } else {
    state.held = false;
    whole.move(run, target, {0.0, 1.0, {}});
  }
  const StepResult result = detail::finish<N>(complex_, moved_, run, {}, {});
  return result_of<N>(run, result, pause);
}

template <std::size_t N>
TravelResult TravellingStepper::go_on_in(ParticleState& state, Weights& weights, ContactList& contacts,
                                         Counters& counters, TravellingPause& pause) const {
  using Recorder = TravelRecorder<N>;
  const Traveller t = pause.traveller;
  const std::size_t contact_count = contacts.contacts.size();
  const auto first_wall = static_cast<std::uint32_t>(contacts.walls.size());
  for (const CarriedWall& wall : t.walls) contacts.walls.push_back(wall.hit);
  const auto end_wall = static_cast<std::uint32_t>(contacts.walls.size());
  StepResult so_far = t.result;
  so_far.invalid_cell = cells_.here(t.result.invalid_cell);
  detail::RunOf<Recorder> run{t.particle,
                              state,
                              contacts,
                              counters,
                              so_far,
                              t.contact_count,
                              first_wall,
                              end_wall - t.together,
                              t.last_time,
                              {},
                              Recorder(complex_, cells_, pause)};
  const detail::MovingStep<N, Recorder> moving(complex_, options_, no_response);
  if (t.stage == TravelStage::carry) {
    moving.go_on(run, weights, t.step_target, t.interval.later, t.part, t.parts);
  } else {
    const PartialStep on_way(state.position, t.walk, {});
    const PartialStep* const partial = t.stage == TravelStage::on_way ? &on_way : nullptr;
    if (partial != nullptr) run.recorder.take_up_walk();
    if (t.parts == 1) {
      rest_of_walk(complex_, moved_, options_, current_space<N>(complex_), run, t, partial);
    } else {
      const Vec3 planned =
          rest_of_walk(complex_, moved_, options_, space_between<N>(complex_, static_cast<double>(t.part) / t.parts),
                       run, t, partial);
      if (run.recorder.waits())
        run.recorder.in_part(t.part, t.parts);
      else
        moving.go_on(run, weights, t.step_target, planned, t.part + 1, t.parts);
    }
  }
  const StepResult result = detail::finish<N>(complex_, moved_, run, {}, {});
  if (contacts.contacts.size() == contact_count) contacts.walls.resize(first_wall);
  return result_of<N>(run, result, pause);
}

template <std::size_t N>
TravelResult TravellingStepper::answer_in(const ContactList& met, const Contact& contact, const AfterContact& next,
                                          ParticleState& state, Weights& weights, ContactList& contacts,
                                          Counters& counters, TravellingPause& pause) const {
  using Recorder = TravelRecorder<N>;
  const std::size_t contact_count = contacts.contacts.size();
  const std::size_t wall_count = contacts.walls.size();
  const Contact here = detail::with_walls(met, contact, contacts);
  const PausedStep step = pause.step;
  detail::RunOf<Recorder> run{step.particle,
                              state,
                              contacts,
                              counters,
                              {},
                              step.contact_count,
                              here.first_wall - here.earlier,
                              here.first_wall - here.together,
                              here.time_of_impact,
                              {},
                              Recorder(complex_, cells_, pause)};
  if (step.parts > 1)
    detail::MovingStep<N, Recorder>(complex_, options_, no_response)
        .move_on(run, weights, here, next, step.interval, step.part, step.parts);
  else
    detail::StepPart<Stored, N, Recorder>(complex_, moved_, current_space<N>(complex_), options_, no_response)
        .move_on(run, here, next, step.interval);
  const StepResult result = detail::finish<N>(complex_, moved_, run, {}, {});
  if (contacts.contacts.size() == contact_count) contacts.walls.resize(wall_count);
  return result_of<N>(run, result, pause);
}

TravelResult TravellingStepper::start(std::uint32_t particle, ParticleState& state, Weights& weights,
                                      const Vec3& target, ContactList& contacts, Counters& counters,
                                      const PartialStep* partial, TravellingPause& pause) const {
  if (complex_.map().dimension() == 2)
    return start_in<3>(particle, state, weights, target, contacts, counters, partial, pause);
  return start_in<4>(particle, state, weights, target, contacts, counters, partial, pause);
}

TravelResult TravellingStepper::go_on(ParticleState& state, Weights& weights, ContactList& contacts, Counters& counters,
                                      TravellingPause& pause) const {
  if (complex_.map().dimension() == 2) return go_on_in<3>(state, weights, contacts, counters, pause);
  return go_on_in<4>(state, weights, contacts, counters, pause);
}

TravelResult TravellingStepper::answer(const ContactList& met, const Contact& contact, const AfterContact& next,
                                       ParticleState& state, Weights& weights, ContactList& contacts,
                                       Counters& counters, TravellingPause& pause) const {
  if (complex_.map().dimension() == 2)
    return answer_in<3>(met, contact, next, state, weights, contacts, counters, pause);
  return answer_in<4>(met, contact, next, state, weights, contacts, counters, pause);
}

}  // namespace dartcast
