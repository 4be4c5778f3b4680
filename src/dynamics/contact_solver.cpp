// Sequential impulses for spheres: rows from contacts, cached impulses, sweeps, rebounds.
#include "dynamics/contact_solver.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "dartcast/error.hpp"

namespace dartcast {

namespace {

// Normals of one wall in two steps: closer than some 25 degrees.
constexpr double same_normal = 0.9;

bool is_share(double x) { return x >= 0.0 && x <= 1.0; }
bool is_amount(double x) { return x >= 0.0 && std::isfinite(x); }

void check_solver(const SolverOptions& o) {
  if (!(o.dt > 0.0) || !std::isfinite(o.dt)) throw InvalidArgument("contacts: dt must be positive and finite");
  if (!is_share(o.restitution) || !is_share(o.position_correction))
    throw InvalidArgument("contacts: restitution and position_correction must be between 0 and 1");
  if (!is_amount(o.friction) || !is_amount(o.resting_speed))
    throw InvalidArgument("contacts: friction and resting_speed must be finite and not negative");
}

void check_contacts(std::span<const PairContact> pairs, std::span<const WallContact> walls,
                    const SolverSpheres& spheres) {
  const std::size_t count = spheres.ids.size();
  if (spheres.inverse_masses.size() != count || spheres.velocities.size() != count ||
      spheres.displacements.size() != count)
    throw InvalidArgument("contacts: one id, mass, velocity and displacement per sphere are needed");
  for (const PairContact& p : pairs) {
    if (p.a >= count || p.b >= count || p.a == p.b) throw InvalidArgument("contacts: a pair does not name two spheres");
  }
  for (const WallContact& w : walls) {
    if (w.sphere >= count) throw InvalidArgument("contacts: a wall's contact does not name a sphere");
    if (!is_share(w.restitution) || !is_amount(w.friction))
      throw InvalidArgument("contacts: a wall's restitution or friction is out of range");
  }
}

Vec3 on_tangent(const Vec3& v, const Vec3& normal) { return v - normal * dot(v, normal); }

}  // namespace

// Spheres, then the walls of contacts, then the body that fills packets.
void ContactSolver::make_bodies(std::span<const WallContact> walls, const SolverSpheres& spheres) {
  const std::size_t count = spheres.ids.size();
  bodies_.clear();
  bodies_.reserve(count + walls.size() + 1);
  for (std::size_t i = 0; i < count; ++i) bodies_.push_back({spheres.velocities[i], spheres.inverse_masses[i]});
  for (const WallContact& w : walls) bodies_.push_back({w.wall_velocity, 0.0});
  bodies_.emplace_back();
}

// Reads the impulses of the last step along with the rows, which have the same order.
class ContactSolver::ImpulseCacheReader {
 public:
  explicit ImpulseCacheReader(const ContactSolver& solver)
      : cached_(solver.cached_), pairs_(solver.cached_pairs_), next_wall_(solver.cached_pairs_) {}

  const CachedImpulse* of_pair(std::uint64_t a, std::uint64_t b) {
    const std::pair key(a, b);
    while (next_pair_ < pairs_ && std::pair(cached_[next_pair_].a, cached_[next_pair_].b) < key) ++next_pair_;
    const bool found = next_pair_ < pairs_ && std::pair(cached_[next_pair_].a, cached_[next_pair_].b) == key;
    return found ? &cached_[next_pair_] : nullptr;
  }

  // The sphere's wall with the nearest normal.
  const CachedImpulse* of_wall(std::uint64_t sphere, const Vec3& normal) {
    while (next_wall_ < cached_.size() && cached_[next_wall_].a < sphere) ++next_wall_;
    const CachedImpulse* best = nullptr;
    double limit = same_normal;
    for (std::size_t k = next_wall_; k < cached_.size() && cached_[k].a == sphere; ++k) {
      const double alike = dot(cached_[k].normal, normal);
      if (alike <= limit) continue;
      limit = alike;
      best = &cached_[k];
    }
    return best;
  }

 private:
  std::span<const CachedImpulse> cached_;
  std::size_t pairs_;
  std::size_t next_pair_ = 0;
  std::size_t next_wall_;
};

// Leaves out pairs of spheres that nothing can push.
void ContactSolver::add_row(detail::ContactEnds ends, const Surface& surface, const CachedImpulse* cached_impulses,
                            const SolverOptions& options) {
  const detail::ContactBody& a = bodies_[ends.a];
  const detail::ContactBody& b = bodies_[ends.b];
  const double inverse = a.inverse_mass + b.inverse_mass;
  if (!(inverse > 0.0)) return;
  ends.loaded = cached_impulses != nullptr;
  ends_.push_back(ends);
  detail::ContactTerms& terms = terms_.emplace_back();
  terms.normal = surface.normal;
  terms.mass = 1.0 / inverse;
  terms.friction = surface.friction;
  terms.bound = surface.gap > 0.0 ? -surface.gap / options.dt : 0.0;
  terms.position_bound = surface.gap > 0.0 ? terms.bound : -options.position_correction * surface.gap / options.dt;
  const double nearing = -dot(b.velocity - a.velocity, surface.normal);
  if (nearing > options.resting_speed) terms.rebound = surface.restitution * nearing;
  if (cached_impulses == nullptr) return;
  terms.normal_impulse = cached_impulses->normal_impulse;
  terms.tangent_impulse = on_tangent(cached_impulses->tangent_impulse, surface.normal);
}

void ContactSolver::list_pairs(std::span<const PairContact> pairs, std::span<const std::uint64_t> ids,
                               const SolverOptions& options) {
  pair_order_.clear();
  bool sorted = true;
  for (std::uint32_t i = 0; i < pairs.size(); ++i) {
    const auto [low, high] = std::minmax(ids[pairs[i].a], ids[pairs[i].b]);
    pair_order_.push_back({low, high, i});
    sorted = sorted && (i == 0 || pair_order_[i - 1] < pair_order_[i]);
  }
  if (!sorted) std::sort(pair_order_.begin(), pair_order_.end());
  ImpulseCacheReader cached_impulses(*this);
  for (const PairKey& key : pair_order_) {
    const PairContact& p = pairs[key.pair];
    const bool swapped = ids[p.a] != key.low;
    const detail::ContactEnds ends = {swapped ? p.b : p.a, swapped ? p.a : p.b};
    const Vec3 normal = swapped ? -p.normal : p.normal;
    add_row(ends, {normal, p.gap, options.restitution, options.friction}, cached_impulses.of_pair(key.low, key.high),
            options);
  }
  pair_rows_ = ends_.size();
}

// Sorts the walls of a sphere by their normals, so that the order of the search does not matter. They come after all
// pairs, so that no sphere ends with a velocity into a wall.
void ContactSolver::list_walls(std::span<const WallContact> walls, std::span<const std::uint64_t> ids,
                               const SolverOptions& options) {
  wall_order_.resize(walls.size());
  std::iota(wall_order_.begin(), wall_order_.end(), 0U);
  const auto key = [&](std::uint32_t i) {
    const WallContact& w = walls[i];
    return std::tuple(ids[w.sphere], w.normal.x, w.normal.y, w.normal.z, w.gap);
  };
  const auto before = [&](std::uint32_t x, std::uint32_t y) { return key(x) < key(y); };
  if (!std::is_sorted(wall_order_.begin(), wall_order_.end(), before))
    std::sort(wall_order_.begin(), wall_order_.end(), before);
  const auto first = static_cast<std::uint32_t>(ids.size());
  ImpulseCacheReader cached_impulses(*this);
  for (const std::uint32_t i : wall_order_) {
    const WallContact& w = walls[i];
    const CachedImpulse* last = cached_impulses.of_wall(ids[w.sphere], w.normal);
    add_row({first + i, w.sphere}, {w.normal, w.gap, w.restitution, w.friction}, last, options);
  }
}

void ContactSolver::set_cached_impulses(std::span<const CachedImpulse> cached_impulses) {
  cached_.assign(cached_impulses.begin(), cached_impulses.end());
  cached_pairs_ =
      static_cast<std::size_t>(std::count_if(cached_impulses.begin(), cached_impulses.end(),
                                             [](const CachedImpulse& k) { return k.b != CachedImpulse::wall; }));
}

// Displacements follow from the velocities. Separate impulses, which are not kept, take out a share of each
// penetration.
void ContactSolver::position_correction(const SolverSpheres& spheres, const SolverOptions& options) {
  pushed_ = bodies_;
  packets_.position_correction(pushed_, options.position_iterations);
  for (std::size_t i = 0; i < spheres.ids.size(); ++i) spheres.displacements[i] = pushed_[i].velocity * options.dt;
}

// A contact that rebounds needs no impulse in the next step.
void ContactSolver::keep(std::span<const std::uint64_t> ids) {
  cached_.clear();
  cached_pairs_ = loaded_pairs_ = loaded_walls_ = 0;
  for (std::size_t i = 0; i < ends_.size(); ++i) {
    const double normal_impulse = packets_.normal_impulse(i);
    if (!(normal_impulse > 0.0)) continue;
    const bool pair = i < pair_rows_;
    ++(pair ? loaded_pairs_ : loaded_walls_);
    if (packets_.rebounds(i)) continue;
    const std::uint64_t b = ids[ends_[i].b];
    cached_.push_back({pair ? ids[ends_[i].a] : b, pair ? b : CachedImpulse::wall, terms_[i].normal, normal_impulse,
                       packets_.tangent_impulse(i)});
    if (pair) ++cached_pairs_;
  }
}

void ContactSolver::solve(std::span<const PairContact> pairs, std::span<const WallContact> walls,
                          const SolverSpheres& spheres, const SolverOptions& options) {
  check_solver(options);
  check_contacts(pairs, walls, spheres);
  make_bodies(walls, spheres);
  ends_.clear();
  terms_.clear();
  list_pairs(pairs, spheres.ids, options);
  list_walls(walls, spheres.ids, options);
  packets_.assign(ends_, terms_, bodies_);
  packets_.start(bodies_);
  packets_.solve(bodies_, options.iterations);
  position_correction(spheres, options);
  if (packets_.rebound()) packets_.solve(bodies_, options.rebound_iterations);
  for (std::size_t i = 0; i < spheres.ids.size(); ++i) spheres.velocities[i] = bodies_[i].velocity;
  keep(spheres.ids);
}

}  // namespace dartcast
