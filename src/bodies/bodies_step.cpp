// A step of the bodies. docs/method.md, "Bodies", says why energy never grows.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/elementary.hpp"
#include "bodies/bodies_impl.hpp"
#include "complex/simplex.hpp"
#include "tracking/carry.hpp"

namespace dartcast {

// A step, in order:
//  1. rebound()              bodies that hit each other fast take the velocities of an impact (bodies_collide.cpp)
//  2. start(), spread_action()   each body's energy; impulses from outside become forces on its particles
//  3. collide()              forces between bodies that touch (bodies_collide.cpp)
//  4. integrate(), set_legs()    targets by Runge-Kutta's method, and the first leg of each particle
//  5. limit_targets(), hold_stuck()   for bodies that start at rest, and particles that stick to walls
//  6. advance()              particles go there; answer_motion() answers at walls (body_contact.cpp)
//  7. measure()              energy of the new positions; bodies that cannot pay repeat 4 to 6 with limited targets
//  8. accept(), limit_energy()   new fits; velocities that the energy does not cover are cut (bodies_energy.cpp)
//  9. aim_pull(), advance()  the second pass: particles go towards their goals; answer_pull() answers at walls
// 10. fit(), damp(), limit_energy()   new fits, damping, and the limits of energy once more
// 11. move_surfaces()        surfaces follow; if they meet walls, particles give way (bodies_edges.cpp)
// 12. remove_gone(), find_pairs()   bodies that left; pairs that may touch in the next step
const BodiesStep& Bodies::Impl::step() {
  check_surfaces("bodies");
  last_ = {};
  first_pass();
  second_pass();
  move_surfaces();
  for (Body& body : bodies_) {
    last_.fallbacks += body.fallbacks;
    last_.input += body.input;
    body.action = {};
  }
  counters_ += last_.motion.counters;
  counters_ += last_.pull.counters;
  on_.swap(next_on_);
  positions_.swap(reached_);
  ++steps_;
  remove_gone();
  find_pairs();
  return last_;
}

// --- the first pass

void Bodies::Impl::first_pass() {
  const std::uint64_t impacts = rebound();
  for_each_body([&](Body& body) {
    start(body);
    spread_action(body);
  });
  std::copy(outer_forces_.begin(), outer_forces_.end(), contact_forces_.begin());
  if (options_.collisions) collide();
  last_.collisions.impacts = impacts;
  for_each_body([&](Body& body) {
    integrate(body);
    set_legs(body);
    if (body.limited) limit_targets(body);
  });
  hold_stuck();
  const Particles before = particles_;
  const std::vector<ParticleStatus> statuses = fates_;
  last_.motion = advance(false);
  measure();
  // Energy always covers limited targets of a body that touches no other. If bodies that collide still lack it,
  // the last try leaves the collision out.
  for (const bool collides : {true, false}) {
    if (std::all_of(bodies_.begin(), bodies_.end(), [](const Body& b) { return b.pays; })) return;
    particles_ = before;
    fates_ = statuses;
    if (!collides) std::copy(outer_forces_.begin(), outer_forces_.end(), contact_forces_.begin());
    for_each_body([&](Body& body) {
      body.limited = body.limited || !body.pays;
      if (!collides) integrate(body);
      set_legs(body);
      if (body.limited) limit_targets(body);
      if (collides && body.collided && !body.pays) stay(body);
    });
    for (const Body& body : bodies_) last_.repeated += body.pays ? 0 : 1;
    hold_stuck();
    last_.motion = advance(false);
    measure();
  }
}

void Bodies::Impl::start(Body& body) {
  body.trial = body.fits;
  body.fallbacks = 0;
  body.constant = body.shape.goals(body.fits, of(body, goals_));
  const auto positions = of(body, positions_);
  body.pushed = body.action.position_delta != Vec3{} || body.action.turn != Vec3{};
  body.collided = false;
  body.before = (kinetic(body) + potential(body, positions)) +
                body.stiffness * matching_energy(body.shape, positions, of(body, goals_), body.constant);
  // Only forces move a body at rest, and its energy always covers that motion.
  body.limited = kinetic(body) <= energy_slack * body.before;
}

// Runge-Kutta's method of order 4. The positions of a stage depend on the accelerations of the stage before alone.
void Bodies::Impl::integrate(Body& body) {
  struct Stage {
    double time;  // share of the step
    double way;   // weights of its accelerations, for positions and for velocities
    double speed;
  };
  constexpr std::array<Stage, 4> stages = {{{0.0, 1.0, 1.0}, {0.5, 1.0, 2.0}, {0.5, 1.0, 2.0}, {1.0, 0.0, 1.0}}};
  const double dt = options_.dt;
  const auto sums = of(body, sums_);
  const auto places = of(body, targets_);
  std::fill(sums.begin(), sums.end(), Sums{});
  for (const Stage& stage : stages) {
    const bool first = stage.time == 0.0;
    const double t = stage.time * dt;
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const std::size_t p = body.first + i;
      places[i] = (positions_[p] + velocities_[p] * t) + sums[i].earlier * (0.5 * dt * t);
    }
    if (!first) {
      body.fallbacks += body.shape.match(places, body.trial);
      body.shape.goals(body.trial, of(body, trial_goals_));
    }
    const auto goals = of(body, first ? goals_ : trial_goals_);
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const Vec3 a =
          PotentialEnergy{body.stiffness, goals[i], options_.gravity + contact_forces_[body.first + i]}.acceleration(
              places[i]);
      sums[i] = {sums[i].last, a, sums[i].way + a * stage.way, sums[i].speed + a * stage.speed};
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const std::size_t p = body.first + i;
    places[i] = flushed((positions_[p] + velocities_[p] * dt) + sums[i].way * (dt * dt / 6.0));
  }
}

void Bodies::Impl::set_legs(Body& body) {
  body.met = false;
  for (std::size_t i = 0; i < body.shape.size(); ++i) {
    const std::size_t p = body.first + i;
    const Vec3& v = velocities_[p];
    Leg& leg = legs_[p];
    leg = {};
    leg.from = positions_[p];
    leg.before = v;
    leg.after = v + sums_[p].speed * (options_.dt / 6.0);
    leg.early = potential_of(body, p).acceleration(positions_[p]);
    leg.late = sums_[p].last;
    leg.kinetic = 0.5 * dot(v, v);
    next_on_[p] = {};
  }
}

void Bodies::Impl::limit_targets(const Body& body) {
  for (std::size_t i = 0; i < body.shape.size(); ++i) {
    const std::size_t p = body.first + i;
    const Vec3 way = targets_[p] - positions_[p];
    const double share = potential_of(body, p).affordable_share(positions_[p], way, legs_[p].kinetic);
    if (share < 1.0) targets_[p] = flushed(positions_[p] + way * share);
  }
}

// The body stays where it is: its energy is that of its position alone.
void Bodies::Impl::stay(const Body& body) {
  for (std::size_t p = body.first; p < body.first + body.shape.size(); ++p) {
    targets_[p] = positions_[p];
    legs_[p].after = {};
  }
}

// A particle that sticks to a wall moves exactly with it, so that no contact follows.
void Bodies::Impl::hold_stuck() {
  const bool moving = environment_.awaits_advance(particles_);
  const CellComplex& complex = environment_.complex();
  for (std::size_t p = 0; p < fates_.size(); ++p) {
    if (fates_[p] != ParticleStatus::stuck) continue;
    const ParticleState& s = particles_[p];
    targets_[p] = s.position;
    legs_[p].after = {};
    if (!moving || s.held || volume_sign(complex.corners(s.at())) != Sign::positive) continue;
    const Weights w = detail::barycentric(complex.previous_corners(s.at()), s.position);
    targets_[p] = detail::carried(current_space<4>(complex), s.at(), w).position;
    legs_[p].after = (targets_[p] - s.position) * (1.0 / options_.dt);
    legs_[p].pushed = true;
  }
}

// Advances all particles to their targets, and reads their new positions.
StepReport Bodies::Impl::advance(bool pulls) {
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    pass_bodies_[b] = {bodies_[b].stiffness, bodies_[b].limited, bodies_[b].slides};
  const Pass pass{&responses_, options_.gravity, options_.dt, pass_bodies_, body_of_, goals_, contact_forces_,
                  on_,         next_on_,         fates_,      legs_};
  const auto answer = pulls ? answer_pull : answer_motion;
  StepReport report = environment_.advance(
      particles_, targets_,
      [&](const Contact& contact, std::span<const WallHit> walls, std::span<const WallHit> earlier) {
        return answer(pass, contact, walls, earlier);
      },
      options_.step);
  for (const Contact& c : report.contacts.contacts) bodies_[body_of_[c.particle]].met = true;
  for (const StoppedParticle& s : report.stopped) legs_[s.particle].after = {};
  for (const HeldParticle& h : report.held) {
    legs_[h.particle].after = legs_[h.particle].before;
    legs_[h.particle].pushed = true;
  }
  for (std::size_t p = 0; p < reached_.size(); ++p) reached_[p] = particles_[p].position;
  return report;
}

// --- the second pass

void Bodies::Impl::second_pass() {
  const double kept = exponential(-options_.drag * options_.dt);
  for_each_body([&](Body& body) {
    accept(body);
    for (std::size_t p = body.first; p < body.first + body.shape.size(); ++p) {
      velocities_[p] = legs_[p].after * kept;
      legs_[p].from = reached_[p];
    }
    body.moving = kinetic(body);
  });
  share_energy();
  limit_energy_together();
  for_each_body([&](Body& body) {
    limit_energy(body);
    if (body.changes()) body.rigid = rigid_motion(body.shape.masses(), of(body, reached_), of(body, velocities_));
    aim_pull(body);
  });
  if (std::none_of(bodies_.begin(), bodies_.end(), [](const Body& b) { return b.changes(); })) return;
  last_.pull = advance(true);
  for_each_body([&](Body& body) {
    if (!body.changes()) return;
    fit(body);
    accept(body);
    damp(body);
    body.moving = kinetic(body);
    charge_lift(body);
  });
  share_energy();
  limit_energy_together();
  for_each_body([&](Body& body) { limit_energy(body); });
}

// Targets of the second pass.
// - A body that met no wall: where the matching and the centrifugal force are in balance. Its centre of mass stays, and
//   so does the shape of a body that spins. Its energy must cover this even if walls stop some of the particles.
// - Else: the minimum of each particle's potential, which costs nothing.
// - Particles that touch other bodies: the contact forces join the balance, and overlaps are taken out, as far as that
//   costs nothing.
// - Displacements from apply_impulse(): on top of all that. Their energy counts as input.
void Bodies::Impl::aim_pull(Body& body) {
  const double softness = 1.0 / body.stiffness;
  double cost = 0.0;
  for (std::size_t p = body.first; p < body.first + body.shape.size(); ++p) {
    const Vec3& x = reached_[p];
    const Vec3 centrifugal =
        cross(cross(body.rigid.angular_velocity, x - body.rigid.centre), body.rigid.angular_velocity);
    targets_[p] = x + ((goals_[p] + centrifugal * softness) - x) * body.pull;
    const PotentialEnergy potential{body.stiffness, goals_[p], options_.gravity};
    cost += masses_[p] * std::max(0.0, potential.rise(x, targets_[p] - x));
  }
  body.slides = body.met || cost > body.allowed;
  body.lift = 0.0;
  for (std::size_t p = body.first; p < body.first + body.shape.size(); ++p) {
    const Vec3& x = reached_[p];
    if (!body.changes() || fates_[p] != ParticleStatus::alive || particles_[p].held) {
      targets_[p] = x;
      continue;
    }
    const PotentialEnergy potential{body.stiffness, goals_[p], options_.gravity};
    if (body.slides) targets_[p] = x + ((goals_[p] + options_.gravity * softness) - x) * body.pull;
    if (contact_forces_[p] != Vec3{} || (body.pushed && corrections_[p] != Vec3{})) {
      const Vec3 way = ((targets_[p] - x) + contact_forces_[p] * (softness * body.pull)) + corrections_[p];
      targets_[p] = x + way * potential.affordable_share(x, way, 0.0);
    }
    if (const Vec3 position_delta = body.action.position_delta_at(x); body.pushed && position_delta != Vec3{}) {
      const double paid = std::max(0.0, potential.rise(x, targets_[p] - x));
      targets_[p] += position_delta;
      body.lift += masses_[p] * std::max(0.0, potential.rise(x, targets_[p] - x) - paid);
    }
    targets_[p] = flushed(targets_[p]);
  }
}

// Counts the part of a displacement's energy that nothing else covers as input. A body that is displaced as a whole
// costs its weight alone, because the minima of its potentials move along.
void Bodies::Impl::charge_lift(Body& body) {
  const double cost = std::min(body.lift, body.moving - body.allowed);
  if (!(cost > 0.0)) return;
  body.input += cost;
  body.budget += cost;
  body.allowed += cost;
}

// Damps velocities relative to the rigid motion. Neither this nor the pull of positions changes momentum or angular
// momentum.
void Bodies::Impl::damp(Body& body) {
  const auto velocities = of(body, velocities_);
  const auto places = of(body, reached_);
  const auto masses = body.shape.masses();
  for (std::size_t i = 0; i < velocities.size(); ++i)
    velocities[i] = (velocities[i] - body.rigid.velocity_at(legs_[body.first + i].from)) * body.kept;
  const RigidMotion left = rigid_motion(masses, places, velocities);
  const RigidMotion rigid = with_angular_momentum(masses, places, body.rigid.velocity, body.rigid.angular_momentum);
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    const std::size_t p = body.first + i;
    velocities[i] = rigid.velocity_at(places[i]) + (velocities[i] - left.velocity_at(places[i]));
    if (fates_[p] != ParticleStatus::alive) velocities[i] = legs_[p].after;
  }
}

}  // namespace dartcast
