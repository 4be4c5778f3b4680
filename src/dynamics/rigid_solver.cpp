// Sequential impulses for bodies that turn: rows from contacts, cached impulses, sweeps, rebounds.
#include "dynamics/rigid_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "base/vec3_parts.hpp"

namespace dartcast {

namespace {

// Normals of one wall in two steps: closer than some 25 degrees.
constexpr double same_wall_as_before = 0.9;

// The change of velocity by a unit impulse, along it and at its point.
double mobility(const RigidMover& m, const Vec3& lever, const Vec3& direction) {
  if (!m.turns) return m.inverse_mass;
  const Vec3 moment = cross(lever, direction);
  return m.inverse_mass + dot(moment, m.inverse_inertia * moment);
}

// At least the mobility in any direction: the turning part has no negative eigenvalue, and no greater one than its
// trace.
double max_mobility(const RigidMover& m, const Vec3& lever) {
  if (!m.turns) return m.inverse_mass;
  double trace = 0.0;
  for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    const Vec3 moment = cross(lever, axis);
    trace += dot(moment, m.inverse_inertia * moment);
  }
  return m.inverse_mass + trace;
}

void position_correction(const RigidMover& m, const Vec3& lever, const Vec3& impulse, Vec3& velocity,
                         Vec3& angular_velocity) {
  velocity += impulse * m.inverse_mass;
  if (m.turns) angular_velocity += m.inverse_inertia * cross(lever, impulse);
}

// Forwards and backwards in turn. The last pass is forwards, so that it ends with the walls.
template <class Each>
void back_and_forth(std::size_t rows, unsigned iterations, Each&& each) {
  for (unsigned k = 0; k < iterations; ++k) {
    for (std::size_t i = 0; i < rows; ++i) each((iterations - k) % 2 == 1 ? i : rows - 1 - i);
  }
}

// The ids as a cached impulse has them.
std::tuple<bool, std::uint64_t, std::uint64_t> ids_of(const RigidContact& c) {
  const bool wall = c.a == RigidContact::wall;
  return {wall, wall ? c.b_id : c.a_id, wall ? CachedImpulse::wall : c.b_id};
}
std::tuple<bool, std::uint64_t, std::uint64_t> ids_of(const CachedImpulse& k) {
  return {k.b == CachedImpulse::wall, k.a, k.b};
}

// Pairs by ids, then walls by ids and normals.
auto key_of(const RigidContact& c) {
  return std::tuple_cat(ids_of(c), std::tuple(c.normal.x, c.normal.y, c.normal.z, c.gap));
}

// Sides of a contact: velocities (or displacements) of both, and impulses on them.
struct BothSides {
  const RigidContact& contact;
  const Vec3& lever_a;
  const Vec3& lever_b;
  std::span<RigidMover> movers;
  Vec3 RigidMover::*linear;
  Vec3 RigidMover::*angular;

  [[nodiscard]] Vec3 at(std::uint32_t mover, const Vec3& lever) const {
    const RigidMover& m = movers[mover];
    return m.turns ? m.*linear + cross(m.*angular, lever) : m.*linear;
  }
  [[nodiscard]] Vec3 relative() const {
    const bool wall = contact.a == RigidContact::wall;
    return at(contact.b, lever_b) - (wall ? contact.wall_velocity : at(contact.a, lever_a));
  }
  void apply(const Vec3& impulse) const {
    RigidMover& b = movers[contact.b];
    position_correction(b, lever_b, impulse, b.*linear, b.*angular);
    if (contact.a == RigidContact::wall) return;
    RigidMover& a = movers[contact.a];
    position_correction(a, lever_a, -impulse, a.*linear, a.*angular);
  }
};

}  // namespace

void RigidSolver::make_rows(std::span<const RigidContact> contacts, std::span<const RigidMover> movers,
                            const SolverOptions& options) {
  rows_.clear();
  for (const RigidContact& c : contacts) {
    const bool wall = c.a == RigidContact::wall;
    const RigidMover& b = movers[c.b];
    Row row;
    row.contact = &c;
    row.lever_b = c.point_b - b.centre;
    double normal_impulse = mobility(b, row.lever_b, c.normal);
    double tangent_impulse = max_mobility(b, row.lever_b);
    Vec3 other = c.wall_velocity;
    if (!wall) {
      const RigidMover& a = movers[c.a];
      row.lever_a = c.point_a - a.centre;
      normal_impulse += mobility(a, row.lever_a, c.normal);
      tangent_impulse += max_mobility(a, row.lever_a);
      other = a.velocity_at(c.point_a);
    }
    if (!(normal_impulse > 0.0)) continue;
    row.mass = 1.0 / normal_impulse;
    row.mass_across = 1.0 / tangent_impulse;
    row.bound = c.gap > 0.0 ? -c.gap / options.dt : 0.0;
    row.position_bound = c.gap > 0.0 ? row.bound : -options.position_correction * c.gap / options.dt;
    const double nearing = -dot(b.velocity_at(c.point_b) - other, c.normal);
    if (nearing > options.resting_speed) row.rebound = c.restitution * nearing;
    rows_.push_back(row);
  }
  std::sort(rows_.begin(), rows_.end(),
            [](const Row& x, const Row& y) { return key_of(*x.contact) < key_of(*y.contact); });
}

// Both have the same order, so one pass suffices. A sphere's wall takes the impulse with the nearest normal.
void RigidSolver::load_cached_impulses() {
  std::size_t k = 0;
  for (Row& row : rows_) {
    const RigidContact& c = *row.contact;
    const auto ids = ids_of(c);
    while (k < cached_.size() && ids_of(cached_[k]) < ids) ++k;
    const CachedImpulse* best = nullptr;
    double limit = same_wall_as_before;
    for (std::size_t m = k; m < cached_.size() && ids_of(cached_[m]) == ids; ++m) {
      const double alike = c.a == RigidContact::wall ? dot(cached_[m].normal, c.normal) : 1.0;
      if (alike <= limit) continue;
      limit = alike;
      best = &cached_[m];
    }
    if (best == nullptr) continue;
    row.normal_impulse = best->normal_impulse;
    row.tangent_impulse = across_normal(best->tangent_impulse, c.normal);
    row.loaded = true;
  }
}

// Friction comes first, so that the normal impulse, which keeps bodies apart, is exact at the end.
void RigidSolver::solve_row(Row& row, double bound, std::span<RigidMover> movers) {
  const RigidContact& c = *row.contact;
  const BothSides sides{c, row.lever_a, row.lever_b, movers, &RigidMover::velocity, &RigidMover::angular_velocity};
  if (c.friction > 0.0) {
    Vec3 tangent_impulse = row.tangent_impulse - across_normal(sides.relative(), c.normal) * row.mass_across;
    const double limit = c.friction * row.normal_impulse;
    const double square = dot(tangent_impulse, tangent_impulse);
    if (square > limit * limit) tangent_impulse *= limit / std::sqrt(square);
    sides.apply(tangent_impulse - row.tangent_impulse);
    row.tangent_impulse = tangent_impulse;
  }
  const double normal_impulse =
      std::max(0.0, row.normal_impulse - row.mass * (dot(sides.relative(), c.normal) - bound));
  if (normal_impulse != row.normal_impulse) sides.apply(c.normal * (normal_impulse - row.normal_impulse));
  row.normal_impulse = normal_impulse;
}

// As in ContactSolver: displacements follow from the velocities, and separate impulses, which are not kept, take out
// a share of each penetration.
void RigidSolver::correct_positions(std::span<RigidMover> movers, const SolverOptions& options) {
  for (RigidMover& m : movers) {
    m.position_delta = m.velocity;
    m.rotation_delta = m.angular_velocity;
  }
  back_and_forth(rows_.size(), options.position_iterations, [&](std::size_t i) {
    Row& row = rows_[i];
    const RigidContact& c = *row.contact;
    const BothSides sides{
        c, row.lever_a, row.lever_b, movers, &RigidMover::position_delta, &RigidMover::rotation_delta};
    const double more =
        std::max(0.0, row.position_correction - row.mass * (dot(sides.relative(), c.normal) - row.position_bound));
    if (more == row.position_correction) return;
    sides.apply(c.normal * (more - row.position_correction));
    row.position_correction = more;
  });
  for (RigidMover& m : movers) {
    m.position_delta *= options.dt;
    m.rotation_delta *= options.dt;
  }
}

// As in ContactSolver. Bodies take their ways in a step of their own.
void RigidSolver::rebound_lone_spheres(std::span<RigidMover> movers, const SolverOptions& options) {
  rows_of_.assign(movers.size(), 0);
  const auto count = [&](std::uint32_t m) { rows_of_[m] = rows_of_[m] == 0 ? 1 : 2; };
  for (const Row& row : rows_) {
    count(row.contact->b);
    if (row.contact->a != RigidContact::wall) count(row.contact->a);
  }
  const auto is_lone = [&](std::uint32_t m) {
    return m == RigidContact::wall || (!movers[m].turns && (rows_of_[m] == 1 || !(movers[m].inverse_mass > 0.0)));
  };
  for (const Row& row : rows_) {
    const RigidContact& c = *row.contact;
    if (!is_lone(c.a) || !is_lone(c.b) || !(row.rebound > 0.0) || row.position_bound > 0.0) continue;
    const auto side = [&](std::uint32_t m) {
      return m == RigidContact::wall ? detail::ContactBody{c.wall_velocity, 0.0}
                                     : detail::ContactBody{movers[m].velocity, movers[m].inverse_mass};
    };
    std::array<detail::ContactBody, 2> sides = {side(c.a), side(c.b)};
    const Vec3 impulse = c.normal * row.normal_impulse + row.tangent_impulse;
    const auto ways = rebound_alone(c.normal, row.bound, impulse, sides[0], sides[1], options);
    for (const std::size_t k : {0U, 1U}) {
      if (!(sides[k].inverse_mass > 0.0)) continue;
      movers[k == 0 ? c.a : c.b].velocity = sides[k].velocity;
      movers[k == 0 ? c.a : c.b].position_delta = ways[k];
    }
  }
}

void RigidSolver::rebound(std::span<RigidMover> movers, const SolverOptions& options) {
  bool any = false;
  for (Row& row : rows_) {
    if (!(row.normal_impulse > 0.0)) row.rebound = 0.0;
    any = any || row.rebound > 0.0;
  }
  if (!any) return;
  back_and_forth(rows_.size(), rebound_iterations, [&](std::size_t i) {
    solve_row(rows_[i], rows_[i].rebound > 0.0 ? rows_[i].rebound : rows_[i].bound, movers);
  });
  rebound_lone_spheres(movers, options);
}

// A contact that rebounds needs no impulse in the next step.
void RigidSolver::keep(std::span<const RigidContact> contacts) {
  cached_.clear();
  new_walls_.clear();
  loaded_pairs_ = loaded_walls_ = 0;
  for (const Row& row : rows_) {
    if (!(row.normal_impulse > 0.0)) continue;
    const RigidContact& c = *row.contact;
    const auto [wall, a, b] = ids_of(c);
    ++(wall ? loaded_walls_ : loaded_pairs_);
    if (wall && !row.loaded) new_walls_.push_back(static_cast<std::uint32_t>(&c - contacts.data()));
    if (row.rebound > 0.0) continue;
    cached_.push_back({a, b, c.normal, row.normal_impulse, row.tangent_impulse});
  }
}

void RigidSolver::solve(std::span<const RigidContact> contacts, std::span<RigidMover> movers,
                        const SolverOptions& options) {
  make_rows(contacts, movers, options);
  load_cached_impulses();
  for (const Row& row : rows_) {
    if (row.normal_impulse == 0.0) continue;
    const BothSides sides{*row.contact, row.lever_a,           row.lever_b,
                          movers,       &RigidMover::velocity, &RigidMover::angular_velocity};
    sides.apply(row.contact->normal * row.normal_impulse + row.tangent_impulse);
  }
  back_and_forth(rows_.size(), options.iterations, [&](std::size_t i) { solve_row(rows_[i], rows_[i].bound, movers); });
  correct_positions(movers, options);
  rebound(movers, options);
  keep(contacts);
}

}  // namespace dartcast
