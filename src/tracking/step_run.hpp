// The step of one particle. step.cpp compiles it without a recorder, trace.cpp with one that records crossings,
// pausing_step.cpp with one that stops at each contact. They are three files so that the compiler inlines functions that
// are called from one place. batch/travelling_step.cpp compiles it for a part of an environment: a step leaves where it
// needs cells around a cell that is another's.
//
// The phases of a step, in order (Stepper::step_in()):
// 1. Where the mesh has moved (MovingStep): a particle whose simplex is not positive before or after is held. Otherwise
//    the step is split in parts, mostly one, and the mesh carries the particle along at the start of each.
// 2. Walk to the target of the part (StepPart::move()).
// 3. At a wall: describe the contact, put the particle there, ask the response, aim at the new target, and walk again.
// 4. Count.
#pragma once

#include <cmath>
#include <string>

#include "base/elementary.hpp"
#include "dartcast/error.hpp"
#include "tracking/contact_geometry.hpp"
#include "tracking/step.hpp"

namespace dartcast {

namespace detail {

// The state of one particle's step.
template <class Recorder>
struct RunOf {
  std::uint32_t particle;
  ParticleState& state;
  ContactList& contacts;
  Counters& counters;
  StepResult result{};
  unsigned contact_count = 0;
  std::uint32_t first_wall = 0;  // of this particle in this step
  std::uint32_t first_here = 0;  // of those at the place of the last contact
  double last_time = -1.0;       // of the last contact
  TestCounts tests{};
  [[no_unique_address]] Recorder recorder{};
};

// No test can be made out of the exact range: the particle stops where it is. Returns that place.
template <class Run>
[[gnu::cold]] Vec3 stop_out_of_range(Run& run, const Vec3& unused) {
  if (!is_finite(unused))
    throw InvalidArgument("the response for particle " + std::to_string(run.particle) +
                          " returned a displacement that is not finite");
  ++run.counters.unfinished;
  run.result.stopped = true;
  run.result.unused = unused;
  return run.state.position;
}

// The base of recorders whose steps call the response at each contact, and do not wait there for an answer.
struct NeverWaits {
  static constexpr bool pausing = false;
  static constexpr bool travels = false;
  static constexpr bool waits() { return false; }
  static void in_part(unsigned, unsigned) {}
  template <class Run>
  static void save(const Run&, SimplexId, const Vec3&) {}
};

inline constexpr int lift_doublings = 16;  // for targets along walls

inline void touch(ParticleState& state, std::span<const WallHit> walls) {
  state.touching_count = 0;
  for (const WallHit& wall : walls) {
    if (state.touching_count == state.touching.size()) break;
    const auto end = state.touching.begin() + state.touching_count;
    if (std::find(state.touching.begin(), end, wall.face) == end) state.touching[state.touching_count++] = wall.face;
  }
}

template <class Positions, std::size_t N, class Recorder>
class StepPart {
  using Run = RunOf<Recorder>;

 public:
  StepPart(const CellComplex& complex, bool moved, const Space<Positions, N>& space, const StepOptions& options,
           const ContactCallback& respond)
      : complex_(complex), moved_(moved), space_(space), options_(options), respond_(respond) {}

  // Walks to q, with the contacts on the way. Returns the displacement still planned after this interval.
  Vec3 move(Run& run, Vec3 q, TimeInterval interval, const PartialStep* partial = nullptr) const {
    while (q != run.state.position) {
      if constexpr (Recorder::travels) {
        if (partial == nullptr && run.recorder.leaves_to_walk(run, q, interval)) return {};
      }
      const Vec3 p = run.state.position;
      const WallImpact* const impact = partial != nullptr && partial->impact ? &*partial->impact : nullptr;
      Walk walked;
      if constexpr (Recorder::travels) {
        if (impact == nullptr) walked = run.recorder.walk(space_, run, partial, p, q, interval);
        if (run.recorder.waits()) return {};
      } else if (partial == nullptr) {
        walked = walk(space_, run.state.at(), p, q, run.tests, run.recorder.visitor());
      } else if (impact == nullptr) {
        walked = end_walk(space_, partial->walk, p, q, run.tests, run.recorder.visitor());
      }
      const Walk& w = impact != nullptr ? partial->walk : walked;
      partial = nullptr;
      if (w.end == WalkEnd::invalid_cell) {
        run.result.held = true;
        run.result.invalid_cell = w.simplex.cell;
        return {};
      }
      run.recorder.walked(space_, w, p, q, interval.begin, interval.end);
      if (w.end == WalkEnd::arrived) {
        run.state.put(w.simplex, q);
        run.state.touching_count = 0;
        return interval.later;
      }
      const AfterContact next = handle_contact(run, w, p, q, interval, impact);
      if (run.result.stopped || run.recorder.waits()) return {};
      q = redirect(run, run.contacts.contacts.back(), next, interval);
    }
    return interval.later;
  }

  // The same from a contact on, after its answer.
  Vec3 move_on(Run& run, const Contact& contact, const AfterContact& next, TimeInterval interval) const {
    const Vec3 q = redirect(run, contact, next, interval);
    return move(run, q, interval);
  }

 private:
  // The target after a contact. Sets the displacement planned after the interval.
  [[gnu::always_inline]] Vec3 redirect(Run& run, const Contact& contact, const AfterContact& next,
                                       TimeInterval& interval) const {
    const double share = interval.end < 1.0 ? (interval.end - interval.begin) / (1.0 - interval.begin) : 1.0;
    interval.later = next.displacement * (1.0 - share) + contact.wall_displacement * (1.0 - interval.end);
    return aim(run, contact, next, share);
  }

  // Records the contact, puts the particle there, and asks the response.
  AfterContact handle_contact(Run& run, const Walk& w, const Vec3& p, const Vec3& q, TimeInterval& interval,
                              const WallImpact* impact) const {
    Contact& contact = run.contacts.contacts.emplace_back();
    contact.particle = run.particle;
    const double t = impact != nullptr ? use_impact(run, w, *impact, contact) : find_contact(run, w, p, q, contact);
    contact.earlier = contact.first_wall - run.first_wall;
    contact.last = ++run.contact_count >= options_.max_contacts;
    interval.begin += t * (interval.end - interval.begin);
    contact.time_of_impact = std::max(interval.begin, run.last_time);
    if (interval.begin - run.last_time >= share_together) run.first_here = contact.first_wall;
    contact.together = contact.first_wall - run.first_here;
    run.last_time = contact.time_of_impact;
    run.recorder.put(run.state, contact.time_of_impact);
    const Vec3 later = interval.later - contact.wall_displacement * (1.0 - interval.end);
    contact.displacement = (q - p) + later;
    contact.unused = (q - p) * (1.0 - t) + later;
    ++run.counters.contacts[static_cast<std::size_t>(contact.kind)];
    touch(run.state, run.contacts.walls_of(contact));
    return respond(run, contact, interval);
  }

  // Describes the contact, and puts the particle there. Returns the fraction of the segment.
  double find_contact(Run& run, const Walk& w, const Vec3& p, const Vec3& q, Contact& contact) const {
    const std::array<Vec3, N> corners = space_.corners(w.wall_simplex);
    const WallPlane wall = flushed_plane(facet_plane(corners, w.wall_facet));
    const double t = describe_contact(space_, w, corners, wall, p, q, contact, run.contacts);
    place(run, w, corners, p, contact);
    if (moved_)
      contact.wall_displacement =
          wall_displacement(complex_, w.wall_simplex, w.wall_facet, corners, wall, contact.point);
    return t;
  }

  // The same from an impact that the batch has computed.
  double use_impact(Run& run, const Walk& w, const WallImpact& impact, Contact& contact) const {
    describe_impact(*space_.map, w, impact, contact, run.contacts);
    run.state.put(w.wall_simplex, impact.position);
    return impact.fraction;
  }

  AfterContact respond(Run& run, const Contact& contact, const TimeInterval& interval) const {
    const bool responds = Recorder::pausing || respond_;
    if (!responds || run.contact_count > options_.max_contacts) {
      run.counters.unfinished += responds ? 1 : 0;
      run.result.stopped = true;
      run.result.unused = contact.unused;
      return {};
    }
    if constexpr (Recorder::pausing) {
      run.recorder.pause(interval);
      return {};
    }
    return respond_(contact, run.contacts.walls_of(contact), run.contacts.earlier_walls_of(contact));
  }

  // The contact point is rounded, so that it may lie outside the simplex at the wall: the particle is put near by,
  // inside it. Where that is farther from the point than p is, the particle stays at p, in the simplex where the
  // segment starts.
  void place(Run& run, const Walk& w, const std::array<Vec3, N>& corners, const Vec3& p, const Contact& contact) const {
    if (w.at_end) return run.state.put(w.simplex, contact.point);
    if (const auto proved = proved_inside(corners, contact.point)) return run.state.put(w.wall_simplex, *proved);
    const SimplexPlacement placed = next_to(w.wall_simplex, corners, contact.point);
    const auto distance = [&](const Vec3& x) {
      return hypotenuse(x.x - contact.point.x, x.y - contact.point.y, x.z - contact.point.z);
    };
    const double unit = lift_distance(contact.point, contact.point, 0);
    if (distance(placed.position) > std::max(distance(p), max_units * unit)) return;
    run.state.put(placed.simplex, placed.position);
  }

  // Where the filter proves nothing: at a corner that is within rounding of x; else where place_in_simplex() puts x, or
  // at a corner that is nearer.
  [[nodiscard]] SimplexPlacement next_to(SimplexId simplex, const std::array<Vec3, N>& v, const Vec3& x) const {
    const SimplexPlacement corner = {simplex, nearest_corner(v, x)};
    if (is_rounded_off(corner.position, x)) return corner;
    const SimplexPlacement placed = place_in_simplex(space_, simplex, v, x);
    return norm(corner.position - x) < norm(placed.position - x) ? corner : placed;
  }

  // The target after a contact. Along walls, it is lifted off the planes that rounding put it behind. It is not lifted
  // off planes that the response wants it to be behind: those walls are met again.
  [[nodiscard]] Vec3 aim(Run& run, const Contact& contact, const AfterContact& next, double share) const {
    Vec3 q = flushed(run.state.position + next.displacement * share);
    if (!in_exact_range(q)) return stop_out_of_range(run, next.displacement);
    if (!next.along || q == run.state.position) return q;
    const Vec3& d = next.displacement;
    const double slack = along_share * std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    WallPlanes<N> planes;
    const auto add = [&](std::span<const WallHit> walls) {
      for (const WallHit& wall : walls) {
        const WallPlane plane = plane_of(run, wall);
        if (dot(d, plane.normal) >= -slack) planes.add(plane);
      }
    };
    add(run.contacts.walls_of(contact));
    add(run.contacts.earlier_walls_of(contact));
    lift_off(planes, run.state.position, q, lift_doublings);
    return flushed(q);
  }

  [[gnu::always_inline]] WallPlane plane_of(const Run& run, const WallHit& wall) const {
    if constexpr (Recorder::travels) {
      if (!wall.face.valid()) return run.recorder.carried_plane(space_, run, wall);
    }
    const CellView cell = space_.map->view(wall.face.cell);
    const Across behind = cell.shape().entry(wall.face.face, wall.triangle);
    return facet_plane(space_.corners(cell, cell.shape().simplices()[behind.index]), behind.place);
  }

  const CellComplex& complex_;
  bool moved_;
  const Space<Positions, N>& space_;
  const StepOptions& options_;
  const ContactCallback& respond_;
};

template <std::size_t N>
bool positive(const std::array<Vec3, N>& v) {
  return Determinants(v, v[0]).proves_positive() || volume_sign(v) == Sign::positive;
}

// Whether p, at rest, would be outside the simplex by the motion of the vertices alone. Only for the statistics.
template <std::size_t N>
bool left_behind(const std::array<Vec3, N>& moved, const Vec3& p) {
  const Determinants d(moved, p);
  return std::any_of(d.value.begin(), d.value.end(), [&](double v) { return v < -d.bound; });
}

// One particle's step while the vertices move.
template <std::size_t N, class Recorder>
class MovingStep {
  using Run = RunOf<Recorder>;

 public:
  MovingStep(const CellComplex& complex, const StepOptions& options, const ContactCallback& respond)
      : complex_(complex), options_(options), respond_(respond) {}

  void run(Run& run, Weights& weights, const Vec3& target) const {
    const Simplex before = previous_space<N>(complex_).corners(run.state.at());
    const Simplex after = current_space<N>(complex_).corners(run.state.at());
    if (!run.state.held) {
      if (!positive(before)) return hold(run, weights, barycentric(before, run.state.position), run.state.cell);
      weights = barycentric(before, run.state.position);
    }
    if (!positive(after) || !is_free(run)) return hold(run, weights, weights, run.state.cell);
    const unsigned parts = run.state.held ? 1 : part_count(before, after, weights, target, options_);
    run.state.held = false;
    if (parts == 1) {
      const SimplexId start = run.state.at();
      carry(current_space<N>(complex_), run, weights, 0.0);
      // Nothing is in the way within the simplex, wherever rounding has put the particle.
      if (Determinants(after, target).all_proved_positive()) run.state.put(start, run.state.position);
      StepPart<Stored, N, Recorder>(complex_, true, space_, options_, respond_).move(run, target, {0.0, 1.0, {}});
      return;
    }
    ++run.counters.steps_split;
    in_parts(run, weights, target, target - run.state.position, 1, parts);
  }

  // The rest of a step from `time` on, in one part.
  void ride_on(Run& run, Weights& weights, double time, const std::optional<Vec3>& target) const {
    weights = barycentric(space_between<N>(complex_, time).corners(run.state.at()), run.state.position);
    if (!positive(space_.corners(run.state.at()))) return hold(run, weights, weights, run.state.cell);
    carry(space_, run, weights, time);
    if (!target) return;
    StepPart<Stored, N, Recorder>(complex_, true, space_, options_, respond_).move(run, *target, {time, 1.0, {}});
  }

  // The rest of a step of several parts, from where the walk of the first one has ended.
  void resume(Run& run, Weights& weights, const Vec3& target, const PartialStep& partial) const {
    ++run.counters.steps_split;
    const unsigned parts = partial.parts;
    const double time = 1.0 / parts;
    const auto [share, end] = next_part(run.state.position, target - run.state.position, parts);
    const Vec3 later = (target - run.state.position) - share;
    run.state.position = partial.from;
    const Space<Between, N> to = space_between<N>(complex_, time);
    const Vec3 planned = StepPart<Between, N, Recorder>(complex_, true, to, options_, respond_)
                             .move(run, end, {0.0, time, later}, &partial);
    if (run.recorder.waits()) return run.recorder.in_part(1, parts);
    in_parts(run, weights, target, planned, 2, parts);
  }

  // The rest of a step from the start of a part on.
  void go_on(Run& run, Weights& weights, const Vec3& target, const Vec3& planned, unsigned part, unsigned parts) const {
    in_parts(run, weights, target, planned, part, parts);
  }

  // The same from a contact on, after its answer. Precondition: it was in that part of several.
  void move_on(Run& run, Weights& weights, const Contact& contact, const AfterContact& next,
               const TimeInterval& interval, unsigned part, unsigned parts) const {
    const Space<Between, N> to = space_between<N>(complex_, static_cast<double>(part) / parts);
    const Vec3 planned =
        StepPart<Between, N, Recorder>(complex_, true, to, options_, respond_).move_on(run, contact, next, interval);
    if (run.recorder.waits()) return run.recorder.in_part(part, parts);
    in_parts(run, weights, {}, planned, part + 1, parts);
  }

 private:
  using Simplex = std::array<Vec3, N>;

  // Only a held particle can be in a blocked cell.
  [[nodiscard]] bool is_free(const Run& run) const { return !run.state.held || complex_.map().is_free(run.state.cell); }

  // The particle takes no step, and is carried along. It is held where its simplex is not positive at the end of the
  // move, or its cell is blocked. Otherwise only its way leads through an invalid cell, and it is free again at once.
  void hold(Run& run, Weights& kept, const Weights& weights, Cell cell) const {
    kept = weights;
    run.result.held = true;
    run.result.invalid_cell = cell;
    const Simplex after = space_.corners(run.state.at());
    if (positive(after) && is_free(run)) return carry(space_, run, weights, 1.0);
    run.state.held = true;
    const Vec3 carried = flushed(combine(after, weights));
    if (in_exact_range(carried)) run.state.position = carried;  // else a corner is not finite, and it stays
  }

  template <class Positions>
  void carry(const Space<Positions, N>& space, Run& run, const Weights& weights, double time) const {
    const SimplexPlacement placed = carried(space, run.state.at(), weights);
    run.state.put(placed.simplex, placed.position);
    run.recorder.put(run.state, time);
  }

  // Each part, from `first` on, is carried and walks in the geometry at its end. Its target lies on the line along the
  // remaining motion. Without a contact so far, that of the last part is `target`.
  void in_parts(Run& run, Weights& weights, const Vec3& target, Vec3 planned, unsigned first, unsigned parts) const {
    bool own_motion = !run.result.stopped && !run.result.held;
    for (unsigned j = first; j <= parts; ++j) {
      if constexpr (Recorder::travels) {
        if (run.recorder.leaves_to_carry(run, planned, j, parts)) return;
      }
      const Space<Between, N> from = space_between<N>(complex_, static_cast<double>(j - 1) / parts);
      const Space<Between, N> to = space_between<N>(complex_, static_cast<double>(j) / parts);
      const Simplex before = from.corners(run.state.at());
      const Vec3 here = run.state.position;
      weights = barycentric(before, here);
      if (!positive(to.corners(run.state.at()))) return hold(run, weights, weights, run.state.cell);
      carry(to, run, weights, static_cast<double>(j - 1) / parts);
      if (!own_motion) continue;
      const auto [share, end] = next_part(here, planned, parts - j + 1);
      const Vec3 q = j == parts && run.contact_count == 0 ? target : end;
      if (!in_exact_range(q)) {
        own_motion = false;
        stop_out_of_range(run, planned);
        continue;
      }
      planned =
          StepPart<Between, N, Recorder>(complex_, true, to, options_, respond_)
              .move(run, q, {static_cast<double>(j - 1) / parts, static_cast<double>(j) / parts, planned - share});
      if (run.recorder.waits()) return run.recorder.in_part(j, parts);
      own_motion = !run.result.stopped && !run.result.held;
    }
  }

  const CellComplex& complex_;
  const StepOptions& options_;
  const ContactCallback& respond_;
  Space<Stored, N> space_ = current_space<N>(complex_);
};

// The contact as one of `contacts`, to which its walls and the earlier ones are added.
inline Contact with_walls(const ContactList& met, const Contact& contact, ContactList& contacts) {
  const auto walls =
      std::span(met.walls).subspan(contact.first_wall - contact.earlier, contact.earlier + contact.wall_count);
  Contact here = contact;
  here.first_wall = static_cast<std::uint32_t>(contacts.walls.size()) + contact.earlier;
  contacts.walls.insert(contacts.walls.end(), walls.begin(), walls.end());
  return here;
}

// Saves a step that waits at a contact, and counts one that is complete. It started at p in the simplex `start`.
template <std::size_t N, class Recorder>
[[gnu::always_inline]] inline StepResult finish(const CellComplex& complex, bool moved, RunOf<Recorder>& run,
                                                SimplexId start, const Vec3& p) {
  if (run.recorder.waits()) {
    run.recorder.save(run, start, p);
    return {};
  }
  Counters& counters = run.counters;
  ++counters.particle_steps;
  if constexpr (Recorder::travels) return run.result;  // its tests are not counted
  counters.orientation.tests += run.tests.tests;
  counters.orientation.exact += run.tests.exact;
  ++counters.histogram[std::min<std::size_t>(run.tests.tests, Counters::histogram_size - 1)];
  const bool kept = run.state.at() == start && run.contact_count == 0 && !run.result.held;
  counters.forecast_kept += kept ? 1 : 0;
  if (moved && run.state.at() != start && left_behind(current_space<N>(complex).corners(start), p))
    ++counters.updated_by_deformation;
  return run.result;
}

}  // namespace detail

template <std::size_t N, class Recorder>
StepResult Stepper::step_in(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                            ContactList& contacts, Counters& counters, const PartialStep* partial,
                            const Recorder& recorder) const {
  detail::RunOf<Recorder> run{particle, state, contacts, counters, {}, 0, 0, 0, -1.0, {}, recorder};
  run.first_wall = static_cast<std::uint32_t>(contacts.walls.size());
  const SimplexId start = state.at();
  const Vec3 p = state.position;
  if (partial != nullptr) {
    run.tests = partial->tests;
    if (partial->parts > 1) {
      detail::MovingStep<N, Recorder>(complex_, options_, respond_).resume(run, weights, target, *partial);
    } else {
      state.position = partial->from;
      detail::StepPart<Stored, N, Recorder>(complex_, moved_, current_space<N>(complex_), options_, respond_)
          .move(run, target, {0.0, 1.0, {}}, partial);
    }
  } else if (moved_) {
    detail::MovingStep<N, Recorder>(complex_, options_, respond_).run(run, weights, target);
  } else {
    const Space<Stored, N> space = current_space<N>(complex_);
    if (state.held && (!detail::positive(space.corners(start)) || !complex_.map().is_free(start.cell))) {
      run.result.held = true;
      run.result.invalid_cell = state.cell;
    } else {
      state.held = false;
      detail::StepPart<Stored, N, Recorder>(complex_, false, space, options_, respond_)
          .move(run, target, {0.0, 1.0, {}});
    }
  }
  return detail::finish<N>(complex_, moved_, run, start, p);
}

template <std::size_t N, class Recorder>
StepResult Stepper::ride_on_in(std::uint32_t particle, ParticleState& state, Weights& weights, const TakenPart& taken,
                               ContactList& contacts, Counters& counters, const Recorder& recorder) const {
  detail::RunOf<Recorder> run{particle, state, contacts, counters, {}, 0, 0, 0, -1.0, {}, recorder};
  run.contact_count = taken.contact_count;
  run.first_wall = taken.first_wall;
  run.first_here = taken.first_wall;
  run.last_time = taken.last_contact;
  const SimplexId start = state.at();
  const Vec3 p = state.position;
  detail::MovingStep<N, Recorder>(complex_, options_, respond_).ride_on(run, weights, taken.time, taken.target);
  return detail::finish<N>(complex_, moved_, run, start, p);
}

}  // namespace dartcast
