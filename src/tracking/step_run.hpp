// One step of one particle, from any stage (tracking/step_state.hpp) until it is complete, waits at a contact, or needs a
// cell that another rank has.
//
// The stages, in order (StepRun::run()):
// 1. start: a particle whose simplex is not positive, before or after the mesh has moved, is held. A step among vertices
//    that have moved may be taken in several time slices.
// 2. carry, if the mesh has moved: each slice begins with the vertices, which carry the particle along.
// 3. walk: to the target of the slice, up to a wall. Batches (in_batch) and other ranks (on_way) begin walks, too.
//    A wall face of a periodic pair is no contact: the particle is put at its partner, and walks on from there.
// 4. contact: describe it, put the particle there, ask for an answer, aim at the new target, and walk again.
// 5. done: count.
//
// A driver is a class that says where a step waits or leaves, and that sees its walks: NoRecords (step.cpp), one that waits
// (pausing_step.cpp), CrossingRecorder (trace.cpp) and the driver of steps between ranks (batch/travelling_step.cpp). Each
// has a file of its own, and some functions are marked always_inline. Both serve the inliner of g++ 12, which else leaves
// calls in steps. tests/instructions counts what they cost.
#pragma once

#include <cmath>
#include <string>

#include "base/elementary.hpp"
#include "dartcast/error.hpp"
#include "tracking/contact_geometry.hpp"
#include "tracking/periodic_passage.hpp"
#include "tracking/step.hpp"

namespace dartcast::detail {

// A driver that sees nothing, at no cost.
template <bool waits_at_contacts>
struct NoRecords {
  static constexpr bool waits = waits_at_contacts;  // else the response is called
  static constexpr bool travels = false;
  static NoVisitor visitor() { return {}; }  // of the next walk
  template <class... Arguments>
  static void walked(const Arguments&...) {}
  static void put(const ParticleState&, double) {}
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

template <std::size_t N>
bool positive(const std::array<Vec3, N>& v) {
  return Determinants(v, v[0]).proves_positive() || volume_sign(v) == Sign::positive;
}

// Whether p, at rest, would be outside the simplex because of the motion of the vertices alone. Only for the statistics.
template <std::size_t N>
bool left_behind(const std::array<Vec3, N>& moved, const Vec3& p) {
  const Determinants d(moved, p);
  return std::any_of(d.value.begin(), d.value.end(), [&](double v) { return v < -d.bound; });
}

template <std::size_t N, class Driver>
class StepRun {
 public:
  StepRun(const StepSetting& setting, StepState& step, const SteppedParticle& particle, Driver& driver)
      : complex_(setting.complex),
        moved_(setting.moved),
        options_(setting.options),
        respond_(setting.respond),
        crossed_(setting.crossed),
        pairs_(setting.complex.periodic()),
        s_(step),
        state_(particle.state),
        weights_(particle.weights),
        contacts_(particle.contacts),
        counters_(particle.counters),
        driver_(driver) {}

  void run() {
    if (s_.stage == StepStage::start) {
      if (moved_)
        begin_moving();
      else
        begin();
    }
    if (s_.stage == StepStage::in_batch) {
      aim_in_batch();
      state_.position = s_.walk_start;
    }
    if (s_.stage == StepStage::carry || s_.slices > 1) {
      if (!take_slices()) return;
    } else if (s_.stage != StepStage::done && !walk(current())) {
      return;
    }
    s_.stage = StepStage::done;
    count();
  }

  // The same if the step stops at the impact that a batch has computed: its end is known.
  [[gnu::always_inline]] void stop_at_impact() {
    aim_in_batch();
    const Vec3 way = s_.slice_target - s_.walk_start;
    Contact& contact = contacts_.contacts.emplace_back();
    note(contact, way, use_impact(s_.walk, *s_.impact, contact));
    stop(contact.unused);
    s_.stage = StepStage::done;
    count();
  }

  // Goes on after the answer to a contact in the list `met`. Its walls are added in front of the next contact's.
  void answer(const ContactList& met, const Contact& contact, const AfterContact& next) {
    const Contact here = add_walls(met, contact);
    s_.stage = StepStage::walk;
    if (s_.slices == 1)
      redirect(current(), here, next);
    else
      redirect(between(time_of_slice(s_.slice)), here, next);
    run();
  }

 private:
  using Simplex = std::array<Vec3, N>;

  [[nodiscard]] Space<Stored, N> current() const { return current_space<N>(complex_); }
  [[nodiscard]] Space<Between, N> between(double time) const { return space_between<N>(complex_, time); }
  // At the end of a slice.
  [[nodiscard]] double time_of_slice(unsigned slice) const { return static_cast<double>(slice) / s_.slices; }
  // Only a held particle can be in a blocked cell.
  [[nodiscard]] bool is_free() const { return !state_.held || complex_.map().is_free(state_.cell); }

  // --- start

  void begin() {
    if (state_.held && (!positive(current().corners(state_.at())) || !is_free())) {
      s_.result.held = true;
      s_.result.invalid_cell = state_.cell;
      s_.stage = StepStage::done;
      return;
    }
    state_.held = false;
    aim_at_target();
  }

  void begin_moving() {
    const Simplex before = previous_space<N>(complex_).corners(state_.at());
    const Simplex after = current().corners(state_.at());
    if (!state_.held) {
      if (!positive(before)) return hold(barycentric(before, state_.position));
      weights_ = barycentric(before, state_.position);
    }
    if (!positive(after) || !is_free()) return hold(weights_);
    s_.slices = state_.held ? 1 : slice_count(before, after, weights_, s_.target, options_);
    state_.held = false;
    if (s_.slices > 1) {
      ++counters_.steps_split;
      s_.interval.later = s_.target - state_.position;
      s_.stage = StepStage::carry;
      return;
    }
    const SimplexId start = state_.at();
    carry(current(), 0.0);
    // Nothing is in the way within the simplex, wherever rounding has put the particle.
    if (Determinants(after, s_.target).all_proved_positive()) state_.put(start, state_.position);
    aim_at_target();
  }

  void aim_at_target() {
    s_.slice_target = s_.target;
    s_.stage = StepStage::walk;
  }

  // At the target of the walk that a batch has begun.
  [[gnu::always_inline]] void aim_in_batch() {
    s_.slice_target = s_.target;
    if (s_.slices > 1) {
      ++counters_.steps_split;
      const Vec3 planned = s_.target - state_.position;
      const auto [share, end] = next_slice(state_.position, planned, s_.slices);
      s_.interval = {0.0, time_of_slice(1), planned - share};
      s_.slice_target = end;
    }
  }

  // --- carry

  // Each slice is walked in the geometry at its end. Returns false if the step waits or leaves.
  bool take_slices() {
    while (true) {
      const Space<Between, N> to = between(time_of_slice(s_.slice));
      if (s_.stage == StepStage::carry) {
        if constexpr (Driver::travels) {
          if (driver_.leaves(state_)) return false;
        }
        begin_slice(to);
      }
      if (s_.stage == StepStage::done) return true;
      if (s_.stage != StepStage::carry && !walk(to)) return false;
      if (s_.slice == s_.slices) return true;
      s_.interval.begin = time_of_slice(s_.slice++);
      s_.stage = StepStage::carry;
    }
  }

  // The slice's target lies on the line along the remaining motion. Without a contact so far, that of the last slice is
  // the step's. A particle that has stopped is only carried.
  void begin_slice(const Space<Between, N>& to) {
    const double time = s_.interval.begin;
    const Vec3 here = state_.position;
    weights_ = barycentric(between(time).corners(state_.at()), here);
    if (!positive(to.corners(state_.at()))) return hold(weights_);
    carry(to, time);
    if (!s_.moves_itself()) return;
    const Vec3 planned = s_.interval.later;
    const auto [share, end] = next_slice(here, planned, s_.slices - s_.slice + 1);
    const bool is_last = s_.slice == s_.slices && (s_.contact_count == 0 || s_.slices == 1);
    s_.slice_target = is_last ? s_.target : end;
    if (!in_exact_range(s_.slice_target)) return static_cast<void>(stop_out_of_range(planned));
    s_.interval = {time, to.positions.s, planned - share};
    s_.stage = StepStage::walk;
  }

  // The particle takes no step, and is carried along. It is held if its simplex is not positive at the end of the
  // move, or its cell is blocked. Otherwise only its way leads through an invalid cell, and it is free again at once.
  void hold(const Weights& weights) {
    weights_ = weights;
    s_.result.held = true;
    s_.result.invalid_cell = state_.cell;
    s_.stage = StepStage::done;
    const Simplex after = current().corners(state_.at());
    if (positive(after) && is_free()) return carry(current(), 1.0);
    state_.held = true;
    const Vec3 carried = flushed(combine(after, weights));
    if (in_exact_range(carried)) state_.position = carried;  // else a corner is not finite, and it stays
  }

  template <class Positions>
  void carry(const Space<Positions, N>& space, double time) {
    const SimplexPlacement placed = carried(space, state_.at(), weights_);
    state_.put(placed.simplex, placed.position);
    driver_.put(state_, time);
  }

  // --- walk

  // To the target of the slice, with the contacts on the way. Returns false if the step waits or leaves.
  template <class Positions>
  bool walk(const Space<Positions, N>& space) {
    while (s_.slice_target != state_.position) {
      const Vec3 p = state_.position;
      const Vec3 q = s_.slice_target;
      const WallImpact* const impact = s_.stage == StepStage::in_batch && s_.impact ? &*s_.impact : nullptr;
      Walk w = s_.walk;
      if (impact == nullptr && !walk_to_end(space, p, q, w)) return false;
      s_.stage = StepStage::walk;
      if (w.end == WalkEnd::invalid_cell) {
        s_.result.held = true;
        s_.result.invalid_cell = w.simplex.cell;
        return true;
      }
      driver_.walked(space, w, p, q, s_.interval.begin, s_.interval.end);
      if (!Driver::travels && pairs_ != nullptr && w.end == WalkEnd::wall && crosses(space, w, p, q, impact)) {
        if (!s_.moves_itself()) return true;
        continue;
      }
      if (w.end == WalkEnd::arrived) {
        state_.put(w.simplex, q);
        state_.touching_count = 0;
        return true;
      }
      const Contact& contact = meet(space, w, p, q, impact);
      if (must_stop(contact)) return true;
      if constexpr (Driver::waits) {
        s_.stage = StepStage::contact;
        return false;
      } else {
        redirect(space, contact, respond_(contact, contacts_.walls_of(contact), contacts_.earlier_walls_of(contact)));
        if (s_.result.stopped) return true;
      }
    }
    return true;
  }

  // Returns false if it leaves.
  template <class Positions>
  [[gnu::always_inline]] bool walk_to_end(const Space<Positions, N>& space, const Vec3& p, const Vec3& q, Walk& w) {
    if constexpr (Driver::travels)
      return driver_.walk(space, s_, state_, q, w);
    else if (s_.stage == StepStage::in_batch)
      w = end_walk(space, s_.walk, p, q, s_.tests, driver_.visitor());
    else
      w = dartcast::walk(space, state_.at(), p, q, s_.tests, driver_.visitor());
    return true;
  }

  // No test can be made out of the exact range: the particle stops where it is. Returns that place.
  [[gnu::cold]] Vec3 stop_out_of_range(const Vec3& unused) {
    if (!is_finite(unused))
      throw InvalidArgument("the response for particle " + std::to_string(s_.particle) +
                            " returned a displacement that is not finite");
    ++counters_.unfinished;
    stop(unused);
    return state_.position;
  }

  // --- periodic faces

  // Whether the walk passes a face of a pair. Then the particle is at the partner, and is aimed at the image of the target,
  // or it goes no further. If not, `w` says how it ends.
  template <class Positions>
  [[gnu::noinline]] bool crosses(const Space<Positions, N>& space, Walk& w, const Vec3& p, const Vec3& q,
                                 const WallImpact* impact) {
    const PeriodicPartner* const partner = periodic_end(space, *pairs_, w, p, q);
    if (partner != nullptr) cross(space, w, p, q, impact, *partner);
    return partner != nullptr;
  }

  template <class Positions>
  void cross(const Space<Positions, N>& space, const Walk& w, const Vec3& p, const Vec3& q, const WallImpact* impact,
             const PeriodicPartner& to) {
    PeriodicEntry<N> entry = periodic_entry(space, *pairs_, to, w, p, q, impact);
    if (!place(space, entry)) {  // as where a walk comes to such a cell
      s_.result.held = true;
      s_.result.invalid_cell = entry.simplex.cell;
      return;
    }
    // It entered: rounding must not lead it out again. At an edge it may pass this face to come to another one: then its
    // target may be far behind this one, and stays.
    WallPlanes<N> planes;
    planes.add(flushed_plane(entry.plane));
    Vec3 lifted = entry.target;
    lift_off(planes, state_.position, lifted, lift_doublings);
    if (planes.none_behind(lifted)) entry.target = lifted;
    note(w, to, entry.fraction);
    s_.slice_target = flushed(entry.target);
    const Vec3 unused = s_.slice_target - state_.position + s_.interval.later;
    if (!in_exact_range(s_.slice_target)) return static_cast<void>(stop_out_of_range(unused));
    if (++s_.crossing_count <= options_.max_crossings) return;
    ++counters_.unfinished;
    stop(unused);
  }

  // As at a contact: near the place, inside the simplex. Returns false if the simplex is not positive.
  template <class Positions>
  bool place(const Space<Positions, N>& space, const PeriodicEntry<N>& entry) {
    const auto proved = proved_inside(entry.corners, entry.point);
    if (!proved && !positive(entry.corners)) return false;
    // On an edge it stays there, so that the walk finds the cells around it that periodic_end() has found.
    SimplexPlacement placed{entry.simplex, entry.point};
    if (proved)
      placed.position = *proved;
    else if (!in_closed_simplex(entry.corners, entry.point))
      placed = next_to(space, entry.simplex, entry.corners, entry.on_plane());
    state_.put(placed.simplex, placed.position);
    state_.touching_count = 0;
    return true;
  }

  // The time of a crossing at the fraction t of the way; the rest of the step is turned. Walls met before are those
  // of another image: nothing joins them from now on.
  void note(const Walk& w, const PeriodicPartner& to, double t) {
    TimeInterval& i = s_.interval;
    const PeriodicMotion& motion = pairs_->motion(to);
    i.begin += t * (i.end - i.begin);
    i.later = motion.vector(i.later);
    s_.target = flushed(motion.point(s_.target));
    s_.first_wall = s_.first_here = static_cast<std::uint32_t>(contacts_.walls.size());
    const CellView cell = complex_.map().view(w.wall_simplex.cell);
    const CellFace from = {w.wall_simplex.cell,
                           cell.shape().simplices()[w.wall_simplex.simplex].across[w.wall_facet].face()};
    contacts_.crossings.push_back({s_.particle, to.pair, to.back, s_.contact_count, std::max(i.begin, s_.last_time),
                                   from, to.face, state_.position, motion.rows()});
    if (crossed_ != nullptr && *crossed_) (*crossed_)(contacts_.crossings.back());
    driver_.put(state_, i.begin);
  }

  // Faces of periodic pairs are no walls of a contact beside them. The wall that was met stays.
  [[gnu::cold]] void drop_periodic_walls(Contact& contact) {
    const auto first = contacts_.walls.begin() + contact.first_wall;
    const auto is_periodic = [&](const WallHit& wall) { return pairs_->partner(wall.face) != nullptr; };
    contacts_.walls.erase(std::remove_if(first + 1, contacts_.walls.end(), is_periodic), contacts_.walls.end());
    contact.wall_count = static_cast<std::uint32_t>(contacts_.walls.size()) - contact.first_wall;
  }

  // --- contact

  // Records the contact, and puts the particle there. `impact`: if a batch has computed it.
  template <class Positions>
  Contact& meet(const Space<Positions, N>& space, const Walk& w, const Vec3& p, const Vec3& q,
                const WallImpact* impact) {
    Contact& contact = contacts_.contacts.emplace_back();
    note(contact, q - p, impact != nullptr ? use_impact(w, *impact, contact) : find_contact(space, w, p, q, contact));
    return contact;
  }

  // The times and displacements of a contact, which is at the fraction t of the way.
  [[gnu::always_inline]] void note(Contact& contact, const Vec3& way, double t) {
    const TimeInterval i = s_.interval;
    const double begin = i.begin + t * (i.end - i.begin);
    const double time = std::max(begin, s_.last_time);
    const std::uint32_t first_here = begin - s_.last_time >= share_together ? contact.first_wall : s_.first_here;
    const Vec3 later = i.later - contact.wall_displacement * (1.0 - i.end);
    contact.particle = s_.particle;
    contact.earlier = contact.first_wall - s_.first_wall;
    contact.together = contact.first_wall - first_here;
    contact.last = ++s_.contact_count >= options_.max_contacts;
    contact.time_of_impact = time;
    contact.displacement = way + later;
    contact.unused = way * (1.0 - t) + later;
    ++counters_.contacts[static_cast<std::size_t>(contact.kind)];
    s_.interval.begin = begin;
    s_.last_time = time;
    s_.first_here = first_here;
    driver_.put(state_, time);
  }

  // Describes the contact, and puts the particle there. Returns the fraction of the segment.
  template <class Positions>
  double find_contact(const Space<Positions, N>& space, const Walk& w, const Vec3& p, const Vec3& q, Contact& contact) {
    const Simplex corners = space.corners(w.wall_simplex);
    const WallPlane wall = flushed_plane(facet_plane(corners, w.wall_facet));
    const double t = describe_contact(space, w, corners, wall, p, q, contact, contacts_);
    if (pairs_ != nullptr) drop_periodic_walls(contact);
    place(space, w, corners, p, contact);
    touch(state_, contacts_.walls_of(contact));
    if (moved_)
      contact.wall_displacement =
          wall_displacement(complex_, w.wall_simplex, w.wall_facet, corners, wall, contact.point);
    return t;
  }

  // The same from an impact that the batch has computed.
  [[gnu::always_inline]] double use_impact(const Walk& w, const WallImpact& impact, Contact& contact) {
    describe_impact(complex_.map(), w, impact, contact, contacts_);
    state_.put(w.wall_simplex, impact.position);
    state_.touching_count = 1;
    state_.touching[0] = contacts_.walls.back().face;
    return impact.fraction;
  }

  // Whether nothing answers, or the contact is one too many.
  bool must_stop(const Contact& contact) {
    const bool responds = Driver::waits || respond_;
    if (responds && s_.contact_count <= options_.max_contacts) return false;
    counters_.unfinished += responds ? 1 : 0;
    stop(contact.unused);
    return true;
  }

  void stop(const Vec3& unused) {
    s_.result.stopped = true;
    s_.result.unused = unused;
  }

  // The contact point is rounded, so that it may lie outside the simplex at the wall: the particle is put near by,
  // inside it. If that is farther from the point than p is, the particle stays at p, in the simplex where the
  // segment starts.
  template <class Positions>
  void place(const Space<Positions, N>& space, const Walk& w, const Simplex& corners, const Vec3& p,
             const Contact& contact) {
    if (w.at_end) return state_.put(w.simplex, contact.point);
    if (const auto proved = proved_inside(corners, contact.point)) return state_.put(w.wall_simplex, *proved);
    const SimplexPlacement placed = next_to(space, w.wall_simplex, corners, contact.point);
    const auto distance = [&](const Vec3& x) {
      return hypotenuse(x.x - contact.point.x, x.y - contact.point.y, x.z - contact.point.z);
    };
    const double unit = lift_distance(contact.point, contact.point, 0);
    if (distance(placed.position) > std::max(distance(p), max_units * unit)) return;
    state_.put(placed.simplex, placed.position);
  }

  // If the filter proves nothing: at a corner that is within rounding of x; else where place_in_simplex() puts x, or
  // at a corner that is nearer.
  template <class Positions>
  static SimplexPlacement next_to(const Space<Positions, N>& space, SimplexId simplex, const Simplex& v,
                                  const Vec3& x) {
    const SimplexPlacement corner = {simplex, nearest_corner(v, x)};
    if (is_rounded_off(corner.position, x)) return corner;
    const SimplexPlacement placed = place_in_simplex(space, simplex, v, x);
    return norm(corner.position - x) < norm(placed.position - x) ? corner : placed;
  }

  // The target after a contact, and the displacement planned after the slice.
  template <class Positions>
  [[gnu::always_inline]] void redirect(const Space<Positions, N>& space, const Contact& contact,
                                       const AfterContact& next) {
    TimeInterval& i = s_.interval;
    const double share = i.end < 1.0 ? (i.end - i.begin) / (1.0 - i.begin) : 1.0;
    i.later = next.displacement * (1.0 - share) + contact.wall_displacement * (1.0 - i.end);
    s_.slice_target = aim(space, contact, next, share);
  }

  // Along walls, the target is lifted off the planes that rounding put it behind. It is not lifted off planes that the
  // response wants it to be behind: those walls are met again.
  template <class Positions>
  [[nodiscard]] Vec3 aim(const Space<Positions, N>& space, const Contact& contact, const AfterContact& next,
                         double share) {
    Vec3 q = flushed(state_.position + next.displacement * share);
    if (!in_exact_range(q)) return stop_out_of_range(next.displacement);
    if (!next.along || q == state_.position) return q;
    const Vec3& d = next.displacement;
    const double slack = along_share * std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    WallPlanes<N> planes;
    const auto add = [&](std::span<const WallHit> walls) {
      for (const WallHit& wall : walls) {
        const WallPlane plane = plane_of(space, wall);
        if (dot(d, plane.normal) >= -slack) planes.add(plane);
      }
    };
    add(contacts_.walls_of(contact));
    add(contacts_.earlier_walls_of(contact));
    lift_off(planes, state_.position, q, lift_doublings);
    return flushed(q);
  }

  template <class Positions>
  [[gnu::always_inline]] WallPlane plane_of(const Space<Positions, N>& space, const WallHit& wall) const {
    if constexpr (Driver::travels) {
      const auto number = static_cast<std::size_t>(&wall - contacts_.walls.data()) - s_.first_wall;
      if (!wall.face.valid()) return driver_.carried_plane(space, number);
    }
    const CellView cell = complex_.map().view(wall.face.cell);
    const Across behind = cell.shape().entry(wall.face.face, wall.triangle);
    return facet_plane(space.corners(cell, cell.shape().simplices()[behind.index]), behind.place);
  }

  // A contact of another list, with its walls and the earlier ones in this one.
  Contact add_walls(const ContactList& met, const Contact& contact) {
    const auto walls =
        std::span(met.walls).subspan(contact.first_wall - contact.earlier, contact.earlier + contact.wall_count);
    Contact here = contact;
    s_.first_wall = static_cast<std::uint32_t>(contacts_.walls.size());
    here.first_wall = s_.first_wall + contact.earlier;
    s_.first_here = here.first_wall - contact.together;
    contacts_.walls.insert(contacts_.walls.end(), walls.begin(), walls.end());
    return here;
  }

  // --- done

  void count() const {
    ++counters_.particle_steps;
    if constexpr (!Driver::travels) {
      counters_.orientation.tests += s_.tests.tests;
      counters_.orientation.exact += s_.tests.exact;
      ++counters_.histogram[std::min<std::size_t>(s_.tests.tests, Counters::histogram_size - 1)];
      if (s_.contact_count == 0 && state_.at() == s_.start && !s_.result.held) ++counters_.forecast_kept;
      if (moved_ && state_.at() != s_.start && is_left_behind()) ++counters_.updated_by_deformation;
    }
  }
  [[nodiscard]] bool is_left_behind() const {
    return s_.impact ? s_.left_behind : left_behind(current().corners(s_.start), s_.start_position);
  }

  const CellComplex& complex_;
  bool moved_;
  const StepOptions& options_;
  const ContactCallback& respond_;
  const CrossingCallback* crossed_;
  const PeriodicFaces* pairs_;
  StepState& s_;
  ParticleState& state_;
  Weights& weights_;
  ContactList& contacts_;
  Counters& counters_;
  Driver& driver_;
};

// Takes walls back that were put in front of a contact, if the step has had none.
class EarlierWalls {
 public:
  explicit EarlierWalls(ContactList& list) : list_(list) {}
  EarlierWalls(const EarlierWalls&) = delete;
  EarlierWalls& operator=(const EarlierWalls&) = delete;
  ~EarlierWalls() {
    if (list_.contacts.size() == contacts_) list_.walls.resize(walls_);
  }

 private:
  ContactList& list_;
  std::size_t contacts_ = list_.contacts.size();
  std::size_t walls_ = list_.walls.size();
};

template <class Driver>
void run_step(const StepSetting& setting, StepState& step, const SteppedParticle& particle, Driver& driver) {
  if (setting.complex.map().dimension() == 2)
    StepRun<3, Driver>(setting, step, particle, driver).run();
  else
    StepRun<4, Driver>(setting, step, particle, driver).run();
}

}  // namespace dartcast::detail
