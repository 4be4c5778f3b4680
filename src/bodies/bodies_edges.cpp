// Bodies with edges: the surfaces that they carry are solids, and meet walls.
//
// The particles lead, the surface follows: move_surfaces() comes after both passes of a step.
//  1. The targets of a surface are where its particles carry it. SolidSet::advance() takes it there, as far as walls let it.
//  2. Its contacts become conditions on the particles, which move to fulfil them, as far as walls let them and the body's
//     energy covers it. Velocities towards the walls are taken out.
// While walls move, surfaces are partners of a joint move: the cells around the particles carry them along.
#include <algorithm>
#include <cstddef>
#include <utility>

#include "bodies/bodies_impl.hpp"
#include "bodies/bodies_moves.hpp"
#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"

namespace dartcast {

namespace {

// Sorts weights by particle, and leaves one for each.
void add_up(std::vector<std::pair<std::uint32_t, double>>& weights) {
  const auto by_particle = [](const auto& a, const auto& b) { return a.first < b.first; };
  std::stable_sort(weights.begin(), weights.end(), by_particle);
  std::size_t last = 0;
  for (std::size_t i = 1; i < weights.size(); ++i) {
    if (weights[i].first == weights[last].first) weights[last].second += weights[i].second;
    if (weights[i].first != weights[last].first) weights[++last] = weights[i];
  }
  if (!weights.empty()) weights.resize(last + 1);
}

}  // namespace

// Adds a body's surface, if it has room.
SolidPlacement Bodies::Impl::add_surface(const SolidMesh& mesh) {
  if (!surfaces_.set) surfaces_.set = std::make_unique<SolidSet>(environment_);
  return surfaces_.set->add(mesh);
}

// The body of each surface.
std::vector<std::uint32_t> Bodies::Impl::bodies_with_surface() const {
  std::vector<std::uint32_t> all;
  for (std::uint32_t b = 0; b < bodies_.size(); ++b) {
    if (bodies_[b].carried) all.push_back(b);
  }
  return all;
}

std::span<const Vec3> Bodies::Impl::surface(std::size_t body) const {
  if (!bodies_[body].carried) return {};
  const std::vector<std::uint32_t> owners = bodies_with_surface();
  const auto s = static_cast<std::size_t>(std::lower_bound(owners.begin(), owners.end(), body) - owners.begin());
  const auto first = surfaces_.set->first_vertices();
  return surfaces_.set->positions().subspan(first[s], first[s + 1] - first[s]);
}

// Where particles at these places carry all surfaces. A surface stays if none of them moves (from `from`, if that is not
// empty), or if it would leave the range of numbers.
std::vector<Vec3> Bodies::Impl::surface_targets(std::vector<Vec3>& places, std::span<const Vec3> from) const {
  const auto now = surfaces_.set->positions();
  std::vector<Vec3> targets(now.begin(), now.end());
  const auto first = surfaces_.set->first_vertices();
  const std::vector<std::uint32_t> owners = bodies_with_surface();
  for (std::size_t s = 0; s < owners.size(); ++s) {
    const Body& body = bodies_[owners[s]];
    const auto own = std::span<Vec3>(targets).subspan(first[s], first[s + 1] - first[s]);
    const auto particles = of(body, places);
    if (!from.empty() &&
        std::equal(particles.begin(), particles.end(), from.begin() + static_cast<std::ptrdiff_t>(body.first)))
      continue;
    body.carried->positions(particles, own);
    if (!std::all_of(own.begin(), own.end(), in_exact_range))
      std::copy_n(now.begin() + first[s], own.size(), own.begin());
  }
  return targets;
}

void Bodies::Impl::check_surfaces(const char* caller) const {
  if (!surfaces_.set || surfaces_.set->size() == 0) return;
  environment_.check_advance(surfaces_.set->particles(), options_.step, caller);
  if (environment_.awaits_advance(surfaces_.set->particles()))
    throw InvalidArgument(
        "bodies: the environment was moved without the surfaces of its bodies: move it by Bodies::move_with()");
}

void Bodies::Impl::check_move() const {
  check_surfaces("move_with");
  if (bodies_.empty()) return;
  environment_.check_advance(particles_, options_.step, "move_with");
  if (environment_.awaits_advance(particles_))
    throw InvalidArgument("bodies: the environment was moved before: call step() after each move");
}

void Bodies::Impl::move_surfaces() {
  if (!surfaces_.set || surfaces_.set->size() == 0) return;
  const SolidStep& step = surfaces_.set->advance(surface_targets(reached_, {}));
  if (step.contacts.empty() && surfaces_.set->stuck().empty()) return;
  const std::vector<std::uint32_t> owners = bodies_with_surface();
  std::vector<std::vector<SurfaceRow>> rows(bodies_.size());
  std::vector<std::uint8_t> stuck(bodies_.size(), 0);
  for (const SolidContact& contact : step.contacts) {
    const std::uint32_t b = owners[contact.solid];
    last_.edges.push_back(contact);
    last_.edges.back().solid = b;
    const WallResponseKind kind = responses_.of(contact.patch).kind;
    if (kind == WallResponseKind::absorb) fates_[bodies_[b].first] = ParticleStatus::absorbed;
    if (kind == WallResponseKind::escape) fates_[bodies_[b].first] = ParticleStatus::escaped;
    rows[b].push_back(row_of(contact, bodies_[b]));
  }
  for (const SolidPlacement& p : surfaces_.set->stuck()) {
    stuck[owners[p.solid]] = 1;
    last_.stuck.push_back(bodies_[owners[p.solid]].id);
  }
  answer_surfaces(rows, stuck);
}

// The condition on the particles for a contact of their surface. Those that a wall or an invalid cell holds do not move.
SurfaceRow Bodies::Impl::row_of(const SolidContact& contact, const Body& body) const {
  SurfaceRow row;
  for (unsigned i = 0; i < contact.count; ++i) {
    body.carried->for_each_weight(contact.vertices[i], [&](std::uint32_t sample, double weight) {
      row.weights.emplace_back(static_cast<std::uint32_t>(body.first) + sample, weight * contact.weights[i]);
    });
  }
  add_up(row.weights);
  row.normal = contact.normal;
  row.least = contact.point;
  row.friction = responses_.of(contact.patch).friction;
  const auto is_fixed = [&](std::uint32_t p) { return fates_[p] != ParticleStatus::alive || particles_[p].held; };
  for (const auto& [p, weight] : row.weights) {
    if (is_fixed(p)) row.least -= reached_[p] * weight;
    if (!is_fixed(p)) row.mobility += weight * weight / masses_[p];
  }
  std::erase_if(row.weights, [&](const auto& w) { return is_fixed(w.first); });
  return row;
}

// Moves the particles of bodies whose surfaces met walls or are stuck, and changes their velocities. A body whose energy
// does not cover its new place goes back to where its own motion took it.
void Bodies::Impl::answer_surfaces(std::span<const std::vector<SurfaceRow>> rows, std::span<const std::uint8_t> stuck) {
  targets_ = reached_;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const auto mine = of(bodies_[b], targets_);
    if (stuck[b] != 0)
      std::copy_n(positions_.begin() + static_cast<std::ptrdiff_t>(bodies_[b].first), mine.size(), mine.begin());
    if (stuck[b] == 0) correct_positions(rows[b], masses_, targets_);
    const bool good = std::all_of(mine.begin(), mine.end(), in_exact_range);
    for (std::size_t i = 0; i < mine.size(); ++i) mine[i] = good ? flushed(mine[i]) : reached_[bodies_[b].first + i];
  }
  const Particles before = particles_;
  environment_.advance(particles_, targets_, {}, options_.step);
  std::vector<std::uint32_t> back;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (stuck[b] == 0 && rows[b].empty()) continue;
    Body& body = bodies_[b];
    const auto own = of(body, reached_);
    const std::vector<Vec3> led(own.begin(), own.end());
    for (std::size_t i = 0; i < own.size(); ++i) own[i] = particles_[body.first + i].position;
    fit(body);
    if (body.allowed < 0.0 && stuck[b] == 0) {
      std::copy(led.begin(), led.end(), own.begin());
      for (std::size_t i = 0; i < own.size(); ++i) back.push_back(static_cast<std::uint32_t>(body.first + i));
      fit(body);
    }
    accept(body);
    if (stuck[b] != 0) {
      const auto v = of(body, velocities_);
      std::fill(v.begin(), v.end(), Vec3{});
    }
    stop_approach(rows[b], masses_, velocities_);
    body.met = true;
    limit_energy(body);
  }
  put_back(back, before);
}

// Gives these particles their earlier states.
void Bodies::Impl::put_back(std::span<const std::uint32_t> which, const Particles& before) {
  if (which.empty()) return;
  std::vector<std::uint8_t> others(before.size(), 1);
  for (const std::uint32_t p : which) others[p] = 0;
  Particles theirs = before;
  theirs.remove(others);
  particles_.replace(which, theirs);
}

double Bodies::Impl::move_with(std::span<const Vec3> positions) {
  check_move();
  if (!surfaces_.set) {
    environment_.move(positions);
    return 1.0;
  }
  MovePartner* const self = this;
  return move_together(environment_, {&self, 1}, positions);
}

// The cells carry the particles along, and these the surfaces.
double Bodies::Impl::plan(const VertexMotion& walls) {
  std::vector<Vec3> carried;
  for (const ParticleState& p : particles_.states())
    carried.push_back(carried_by_cell(environment_.complex(), p, walls));
  partner_ = &JointMoves::prepare(*surfaces_.set, {surface_targets(carried, positions_)}, {});
  return partner_->plan(walls);
}

bool Bodies::Impl::shorten(double share, const VertexMotion& walls) { return partner_->shorten(share, walls); }
void Bodies::Impl::after_move() { partner_->after_move(); }

MovePartner* BodiesMoves::prepare(Bodies& bodies) {
  bodies.impl_->check_move();
  return bodies.impl_->surfaces_.set ? bodies.impl_.get() : nullptr;
}

}  // namespace dartcast
