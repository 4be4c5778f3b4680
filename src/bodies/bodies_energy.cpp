// The limits of energy: budgets of bodies, and the velocities that they pay for. docs/method.md, "Bodies", says why
// energy never grows.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "bodies/bodies_impl.hpp"

namespace dartcast {

// Sets for each body whether its energy covers the positions of its particles, with new fits. If new fits cost more
// than the body has, and are not those of least energy, the last fits count.
void Bodies::Impl::measure() {
  for_each_body([&](Body& body) {
    body.input = given(body) + action_work(body);
    body.work = 0.0;
    for (std::size_t p = body.first; p < body.first + body.shape.size(); ++p)
      body.work += masses_[p] * dot(contact_forces_[p] - outer_forces_[p], reached_[p] - positions_[p]);
  });
  // Bodies gain at most as much energy from each other as others lose.
  double gained = 0.0;
  double lost = 0.0;
  for (const Body& body : bodies_) (body.work > 0.0 ? gained : lost) += std::abs(body.work);
  const double share = gained > lost ? lost / gained : 1.0;
  for_each_body([&](Body& body) {
    body.budget = body.before + body.input + (body.work > 0.0 ? body.work * share : body.work);
    fit(body);
    body.moving = 0.0;
  });
  share_energy();
  for (Body& body : bodies_)
    body.pays = body.allowed >= -energy_slack * body.budget || (body.limited && !body.collided);
}

// Energy from outer forces on the way.
double Bodies::Impl::action_work(const Body& body) const {
  double work = 0.0;
  for (std::size_t p = body.first; p < body.first + body.shape.size(); ++p)
    work += masses_[p] * dot(outer_forces_[p], reached_[p] - positions_[p]);
  return work;
}

// Energy from moving walls that particles met, with the potentials of the start of the step.
double Bodies::Impl::given(const Body& body) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < body.shape.size(); ++i) {
    const std::size_t p = body.first + i;
    const Leg& leg = legs_[p];
    if (!leg.pushed) continue;
    const double gain = potential_of(body, p).rise(positions_[p], reached_[p] - positions_[p]) +
                        0.5 * (dot(leg.after, leg.after) - dot(velocities_[p], velocities_[p]));
    sum += masses_[p] * std::max(0.0, gain);
  }
  return sum;
}

// Fits the shape to the positions of the particles, and sets the part of the budget that remains for motion.
void Bodies::Impl::fit(Body& body) {
  const auto reached = of(body, reached_);
  body.trial = body.fits;
  body.fallbacks += body.shape.match(reached, body.trial);
  body.trial_constant = body.shape.goals(body.trial, of(body, trial_goals_));
  const double without = body.budget - potential(body, reached);
  const double fresh =
      without - body.stiffness * matching_energy(body.shape, reached, of(body, trial_goals_), body.trial_constant);
  body.accepted = fresh >= 0.0 || body.shape.has_least_fits();
  body.allowed = body.accepted
                     ? fresh
                     : without - body.stiffness * matching_energy(body.shape, reached, of(body, goals_), body.constant);
}

void Bodies::Impl::accept(Body& body) {
  if (!body.accepted) return;
  body.fits.swap(body.trial);
  body.constant = body.trial_constant;
  const auto fresh = of(body, trial_goals_);
  std::copy(fresh.begin(), fresh.end(), of(body, goals_).begin());
}

// Cuts velocities to the energy that the body has. If it met no wall, it cuts those relative to the rigid motion
// alone, if that suffices up to the slack. Then momentum and angular momentum stay.
void Bodies::Impl::limit_energy(Body& body) {
  const double has = kinetic(body);
  const double allowed = std::max(0.0, body.allowed);
  if (has <= allowed) return;
  const auto velocities = of(body, velocities_);
  if (!body.met) {
    const auto places = of(body, reached_);
    const RigidMotion rigid = rigid_motion(body.shape.masses(), places, velocities);
    const double lowest = rigid.kinetic_energy();
    if (lowest <= allowed + energy_slack * body.budget) {
      const double kept = lowest < allowed ? std::sqrt((allowed - lowest) / (has - lowest)) : 0.0;
      for (std::size_t i = 0; i < velocities.size(); ++i) {
        const Vec3 common = rigid.velocity_at(places[i]);
        velocities[i] = common + (velocities[i] - common) * kept;
      }
      return;
    }
  }
  for (Vec3& v : velocities) v *= std::sqrt(allowed / has);
}

// Whether limit_energy() would cut the rigid motion, too.
bool Bodies::Impl::lacks_motion(const Body& body) {
  const double allowed = std::max(0.0, body.allowed);
  if (kinetic(body) <= allowed) return false;
  const RigidMotion rigid = rigid_motion(body.shape.masses(), of(body, reached_), of(body, velocities_));
  return rigid.kinetic_energy() > allowed + energy_slack * body.budget;
}

// Cuts bodies that touch, and meet no wall, as one body if one of them lacks energy for its rigid motion. Velocities
// relative to the rigid motion of all of them fall, so that momentum and angular momentum stay.
void Bodies::Impl::limit_energy_together() {
  if (std::none_of(bodies_.begin(), bodies_.end(), [](const Body& b) { return b.collided; })) return;
  std::vector<std::uint32_t> joined(bodies_.size());
  std::iota(joined.begin(), joined.end(), 0U);
  for (const SpherePair& p : collisions_.pairs()) {
    const std::uint32_t a = joined[body_of_[p.a]];
    const std::uint32_t b = joined[body_of_[p.b]];
    if (a == b || !bodies_[body_of_[p.a]].collided || !bodies_[body_of_[p.b]].collided) continue;
    std::replace(joined.begin(), joined.end(), std::max(a, b), std::min(a, b));
  }
  for (std::uint32_t first = 0; first < joined.size(); ++first) {
    if (joined[first] != first || !bodies_[first].collided) continue;
    std::vector<std::uint32_t> group;
    for (std::uint32_t b = first; b < joined.size(); ++b) {
      if (joined[b] == first) group.push_back(b);
    }
    const auto any = [&](auto&& is) {
      return std::any_of(group.begin(), group.end(), [&](std::uint32_t b) { return is(bodies_[b]); });
    };
    if (group.size() > 1 && !any([](const Body& b) { return b.met; }) &&
        any([&](const Body& b) { return lacks_motion(b); }))
      cut_together(group);
  }
}

void Bodies::Impl::cut_together(std::span<const std::uint32_t> group) {
  std::vector<double> masses;
  std::vector<Vec3> places;
  std::vector<Vec3> velocities;
  double has = 0.0;
  double allowed = 0.0;
  for (const std::uint32_t b : group) {
    const auto append = [&](auto& all, const auto& values) { all.insert(all.end(), values.begin(), values.end()); };
    append(masses, bodies_[b].shape.masses());
    append(places, of(bodies_[b], reached_));
    append(velocities, of(bodies_[b], velocities_));
    has += kinetic(bodies_[b]);
    allowed += bodies_[b].allowed;
  }
  const RigidMotion common = rigid_motion(masses, places, velocities);
  const double lowest = common.kinetic_energy();
  if (!(lowest < allowed)) return;
  const double kept = has > allowed ? std::sqrt((allowed - lowest) / (has - lowest)) : 1.0;
  for (const std::uint32_t b : group) {
    Body& body = bodies_[b];
    for (std::size_t p = body.first; p < body.first + body.shape.size(); ++p) {
      const Vec3 v = common.velocity_at(reached_[p]);
      velocities_[p] = v + (velocities_[p] - v) * kept;
    }
    const double transfer = kinetic(body) - body.allowed;
    body.allowed += transfer;
    body.budget += transfer;
  }
}

// Gives the spare energy of bodies that collide to those that lack it. The exact transfer at their contacts is unknown,
// because the impulses come from a prediction of the step.
void Bodies::Impl::share_energy() {
  double spare = 0.0;
  double wanted = 0.0;
  for (Body& body : bodies_) {
    if (!body.collided) continue;
    spare += std::max(0.0, body.allowed - body.moving);
    wanted += std::max(0.0, body.moving - body.allowed);
  }
  if (!(spare > 0.0 && wanted > 0.0)) return;
  const double given_share = std::min(1.0, wanted / spare);
  const double taken_share = std::min(1.0, spare / wanted);
  for (Body& body : bodies_) {
    if (!body.collided) continue;
    const double more = body.moving - body.allowed;
    const double transfer = more * (more > 0.0 ? taken_share : given_share);
    body.allowed += transfer;
    body.budget += transfer;
  }
}

}  // namespace dartcast
