// Sequential impulses for spheres: rows from contacts, cached impulses, sweeps, rebounds.
#include "dynamics/contact_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "base/vec3_parts.hpp"
#include "dartcast/error.hpp"

namespace dartcast {

namespace {

// Normals of one wall in two steps: closer than some 25 degrees.
constexpr double same_normal = 0.9;

constexpr std::size_t row_grain = 1024;  // contacts, or spheres

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
      spheres.displacements.size() != count || (spheres.region_count > 1 && spheres.regions.size() != count))
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

}  // namespace

std::array<Vec3, 2> rebound_alone(const Vec3& normal, double bound, const Vec3& impulse, detail::ContactBody& a,
                                  detail::ContactBody& b, const SolverOptions& options) {
  const Vec3 a_before = a.velocity + impulse * a.inverse_mass;
  const Vec3 b_before = b.velocity - impulse * b.inverse_mass;
  const double before = dot(b_before - a_before, normal);
  const double time = before < bound ? bound / before : 1.0;
  detail::ContactBody* const mover = b.inverse_mass > 0.0 ? &b : &a;
  if (!(a.inverse_mass > 0.0 && b.inverse_mass > 0.0)) {
    const Vec3 away = mover == &b ? normal : -normal;
    const double after = dot(b.velocity - a.velocity, normal);
    const double lead = (time - 0.5) * options.dt * dot(options.acceleration, away);
    const double square = after * after + lead * lead + 2.0 * lead * before;
    mover->velocity += away * ((square > 0.0 ? std::max(0.0, std::sqrt(square) - lead) : 0.0) - after);
  }
  return {(a_before * time + a.velocity * (1.0 - time)) * options.dt,
          (b_before * time + b.velocity * (1.0 - time)) * options.dt};
}

// Spheres, then the walls of contacts.
void ContactSolver::make_bodies(std::span<const WallContact> walls, const SolverSpheres& spheres, Threads threads) {
  const std::size_t count = spheres.ids.size();
  bodies_.resize(count + walls.size());
  parallel_for(count, row_grain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) bodies_[i] = {spheres.velocities[i], spheres.inverse_masses[i]};
  });
  for (std::size_t i = 0; i < walls.size(); ++i) bodies_[count + i] = {walls[i].wall_velocity, 0.0};
}

// Reads the impulses of the last step along with rows, which have the same order.
class ContactSolver::ImpulseCacheReader {
 public:
  explicit ImpulseCacheReader(const ContactSolver& solver)
      : pairs_(std::span(solver.cached_).first(solver.cached_pairs_)),
        walls_(std::span(solver.cached_).subspan(solver.cached_pairs_)) {}

  // To be called before the first of the pairs, or walls, from these ids on.
  void skip_to_pair(std::uint64_t a, std::uint64_t b) {
    const auto before = [](const CachedImpulse& k, const std::pair<std::uint64_t, std::uint64_t>& key) {
      return std::pair(k.a, k.b) < key;
    };
    const auto found = std::lower_bound(pairs_.begin(), pairs_.end(), std::pair(a, b), before);
    pairs_ = pairs_.subspan(static_cast<std::size_t>(found - pairs_.begin()));
  }
  void skip_to_wall(std::uint64_t sphere) {
    const auto before = [](const CachedImpulse& k, std::uint64_t id) { return k.a < id; };
    const auto found = std::lower_bound(walls_.begin(), walls_.end(), sphere, before);
    walls_ = walls_.subspan(static_cast<std::size_t>(found - walls_.begin()));
  }

  const CachedImpulse* of_pair(std::uint64_t a, std::uint64_t b) {
    const std::pair key(a, b);
    while (!pairs_.empty() && std::pair(pairs_.front().a, pairs_.front().b) < key) pairs_ = pairs_.subspan(1);
    const bool found = !pairs_.empty() && std::pair(pairs_.front().a, pairs_.front().b) == key;
    return found ? &pairs_.front() : nullptr;
  }

  // The sphere's wall with the nearest normal.
  const CachedImpulse* of_wall(std::uint64_t sphere, const Vec3& normal) {
    while (!walls_.empty() && walls_.front().a < sphere) walls_ = walls_.subspan(1);
    const CachedImpulse* best = nullptr;
    double limit = same_normal;
    for (std::size_t k = 0; k < walls_.size() && walls_[k].a == sphere; ++k) {
      const double alike = dot(walls_[k].normal, normal);
      if (alike <= limit) continue;
      limit = alike;
      best = &walls_[k];
    }
    return best;
  }

 private:
  std::span<const CachedImpulse> pairs_;
  std::span<const CachedImpulse> walls_;
};

void ContactSolver::set_row(std::size_t row, detail::ContactEnds ends, const Surface& surface,
                            const CachedImpulse* cached_impulses, const SolverOptions& options) {
  const detail::ContactBody& a = bodies_[ends.a];
  const detail::ContactBody& b = bodies_[ends.b];
  ends.loaded = cached_impulses != nullptr;
  ends_[row] = ends;
  detail::ContactTerms terms;
  terms.normal = surface.normal;
  terms.mass = 1.0 / (a.inverse_mass + b.inverse_mass);
  terms.friction = surface.friction;
  terms.bound = surface.gap > 0.0 ? -surface.gap / options.dt : 0.0;
  terms.position_bound = surface.gap > 0.0 ? terms.bound : -options.position_correction * surface.gap / options.dt;
  const double nearing = -dot(b.velocity - a.velocity, surface.normal);
  if (nearing > options.resting_speed) terms.rebound = surface.restitution * nearing;
  if (cached_impulses != nullptr) {
    terms.normal_impulse = cached_impulses->normal_impulse;
    terms.tangent_impulse = across_normal(cached_impulses->tangent_impulse, surface.normal);
  }
  terms_[row] = terms;
}

// Leaves out pairs of spheres that nothing can push.
void ContactSolver::order_pairs(std::span<const PairContact> pairs, const SolverSpheres& spheres) {
  pair_order_.clear();
  bool sorted = true;
  for (std::uint32_t i = 0; i < pairs.size(); ++i) {
    const PairContact& p = pairs[i];
    if (!(spheres.inverse_masses[p.a] + spheres.inverse_masses[p.b] > 0.0)) continue;
    const auto [low, high] = std::minmax(spheres.ids[p.a], spheres.ids[p.b]);
    const PairKey key = {low, high, i};
    sorted = sorted && (pair_order_.empty() || pair_order_.back() < key);
    pair_order_.push_back(key);
  }
  if (!sorted) std::sort(pair_order_.begin(), pair_order_.end());
}

// Sorts the walls of a sphere by their normals, so that the order of the search does not matter.
void ContactSolver::order_walls(std::span<const WallContact> walls, const SolverSpheres& spheres) {
  wall_order_.clear();
  for (std::uint32_t i = 0; i < walls.size(); ++i) {
    if (spheres.inverse_masses[walls[i].sphere] > 0.0) wall_order_.push_back(i);
  }
  const auto key = [&](std::uint32_t i) {
    const WallContact& w = walls[i];
    return std::tuple(spheres.ids[w.sphere], w.normal.x, w.normal.y, w.normal.z, w.gap);
  };
  const auto before = [&](std::uint32_t x, std::uint32_t y) { return key(x) < key(y); };
  if (!std::is_sorted(wall_order_.begin(), wall_order_.end(), before))
    std::sort(wall_order_.begin(), wall_order_.end(), before);
}

void ContactSolver::list_pairs(std::span<const PairContact> pairs, std::span<const std::uint64_t> ids,
                               const SolverOptions& options, Threads threads) {
  parallel_for(pair_order_.size(), row_grain, threads, [&](std::size_t begin, std::size_t end) {
    ImpulseCacheReader cached_impulses(*this);
    cached_impulses.skip_to_pair(pair_order_[begin].low, pair_order_[begin].high);
    for (std::size_t row = begin; row < end; ++row) {
      const PairKey& key = pair_order_[row];
      const PairContact& p = pairs[key.pair];
      const bool swapped = ids[p.a] != key.low;
      const detail::ContactEnds ends = {swapped ? p.b : p.a, swapped ? p.a : p.b};
      const Vec3 normal = swapped ? -p.normal : p.normal;
      set_row(row, ends, {normal, p.gap, options.restitution, options.friction},
              cached_impulses.of_pair(key.low, key.high), options);
    }
  });
}

void ContactSolver::list_walls(std::span<const WallContact> walls, std::span<const std::uint64_t> ids,
                               const SolverOptions& options, Threads threads) {
  const auto first = static_cast<std::uint32_t>(ids.size());
  parallel_for(wall_order_.size(), row_grain, threads, [&](std::size_t begin, std::size_t end) {
    ImpulseCacheReader cached_impulses(*this);
    cached_impulses.skip_to_wall(ids[walls[wall_order_[begin]].sphere]);
    for (std::size_t k = begin; k < end; ++k) {
      const WallContact& w = walls[wall_order_[k]];
      const CachedImpulse* last = cached_impulses.of_wall(ids[w.sphere], w.normal);
      set_row(pair_rows_ + k, {first + wall_order_[k], w.sphere}, {w.normal, w.gap, w.restitution, w.friction}, last,
              options);
    }
  });
}

// Contacts of a fixed sphere need not wait for each other if each has a fixed body of its own.
void ContactSolver::give_bodies_to_fixed_spheres(std::size_t spheres) {
  for (std::size_t row = 0; row < pair_rows_; ++row) {
    for (std::uint32_t* end : {&ends_[row].a, &ends_[row].b}) {
      const detail::ContactBody body = bodies_[*end];
      if (body.inverse_mass > 0.0 || *end >= spheres) continue;
      *end = static_cast<std::uint32_t>(bodies_.size());
      bodies_.push_back(body);
    }
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
void ContactSolver::position_correction(const SolverSpheres& spheres, const SolverOptions& options, Threads threads) {
  pushed_ = bodies_;
  packets_.position_correction(pushed_, options.position_iterations, threads);
  parallel_for(spheres.ids.size(), row_grain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) spheres.displacements[i] = pushed_[i].velocity * options.dt;
  });
}

// Lone contacts rebound at their time, but if spheres overlap.
void ContactSolver::rebound(const SolverSpheres& spheres, const SolverOptions& options, Threads threads) {
  if (!packets_.rebound()) return;
  packets_.solve(bodies_, rebound_iterations, threads);
  rows_of_.assign(bodies_.size(), 0);
  for (const detail::ContactEnds& c : ends_) {
    for (const std::uint32_t end : {c.a, c.b}) rows_of_[end] = rows_of_[end] == 0 ? 1 : 2;
  }
  for (std::size_t row = 0; row < ends_.size(); ++row) {
    const auto [a, b, loaded] = ends_[row];
    const detail::ContactTerms& terms = terms_[row];
    if (rows_of_[a] != 1 || rows_of_[b] != 1 || !packets_.rebounds(row) || terms.position_bound > 0.0) continue;
    const Vec3 impulse = terms.normal * packets_.normal_impulse(row) + packets_.tangent_impulse(row);
    const auto ways = rebound_alone(terms.normal, terms.bound, impulse, bodies_[a], bodies_[b], options);
    if (bodies_[a].inverse_mass > 0.0) spheres.displacements[a] = ways[0];
    if (bodies_[b].inverse_mass > 0.0) spheres.displacements[b] = ways[1];
  }
}

// A contact that rebounds needs no impulse in the next step.
bool ContactSolver::is_kept(std::size_t row) const {
  return packets_.normal_impulse(row) > 0.0 && !packets_.rebounds(row);
}

// First each chunk counts what it keeps, so that it knows where to write that.
void ContactSolver::keep(std::span<const std::uint64_t> ids, std::span<const WallContact> walls, Threads threads) {
  kept_.assign(chunk_count(ends_.size(), row_grain), {});
  parallel_for(ends_.size(), row_grain, threads, [&](std::size_t begin, std::size_t end) {
    KeptCounts& counts = kept_[begin / row_grain];
    for (std::size_t row = begin; row < end; ++row) {
      const bool pair = row < pair_rows_;
      if (packets_.normal_impulse(row) > 0.0) ++(pair ? counts.loaded_pairs : counts.loaded_walls);
      if (is_kept(row)) ++(pair ? counts.pairs : counts.walls);
    }
  });
  KeptCounts all;
  for (KeptCounts& c : kept_) {
    c.begin = all.pairs + all.walls;
    all.loaded_pairs += c.loaded_pairs;
    all.loaded_walls += c.loaded_walls;
    all.pairs += c.pairs;
    all.walls += c.walls;
  }
  loaded_pairs_ = all.loaded_pairs;
  loaded_walls_ = all.loaded_walls;
  cached_pairs_ = all.pairs;
  cached_.resize(all.pairs + all.walls);
  parallel_for(ends_.size(), row_grain, threads, [&](std::size_t begin, std::size_t end) {
    std::size_t next = kept_[begin / row_grain].begin;
    for (std::size_t row = begin; row < end; ++row) {
      if (!is_kept(row)) continue;
      std::uint64_t a = 0;
      std::uint64_t b = CachedImpulse::wall;
      if (row < pair_rows_) {
        a = pair_order_[row].low;
        b = pair_order_[row].high;
      } else {
        a = ids[walls[wall_order_[row - pair_rows_]].sphere];
      }
      cached_[next++] = {a, b, terms_[row].normal, packets_.normal_impulse(row), packets_.tangent_impulse(row)};
    }
  });
  new_walls_.clear();
  for (std::size_t row = pair_rows_; row < ends_.size(); ++row) {
    if (!ends_[row].loaded && packets_.normal_impulse(row) > 0.0) new_walls_.push_back(wall_order_[row - pair_rows_]);
  }
}

void ContactSolver::solve(std::span<const PairContact> pairs, std::span<const WallContact> walls,
                          const SolverSpheres& spheres, const SolverOptions& options, Threads threads) {
  check_solver(options);
  check_contacts(pairs, walls, spheres);
  make_bodies(walls, spheres, threads);
  order_pairs(pairs, spheres);
  order_walls(walls, spheres);
  pair_rows_ = pair_order_.size();
  ends_.resize(pair_rows_ + wall_order_.size());
  terms_.resize(ends_.size());
  list_pairs(pairs, spheres.ids, options, threads);
  list_walls(walls, spheres.ids, options, threads);
  give_bodies_to_fixed_spheres(spheres.ids.size());
  bodies_.insert(bodies_.end(), spheres.region_count + 1, {});
  packets_.assign(ends_, terms_, bodies_, spheres.regions, spheres.region_count, threads);
  packets_.start(bodies_, threads);
  packets_.solve(bodies_, options.iterations, threads);
  position_correction(spheres, options, threads);
  rebound(spheres, options, threads);
  parallel_for(spheres.ids.size(), row_grain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) spheres.velocities[i] = bodies_[i].velocity;
  });
  keep(spheres.ids, walls, threads);
}

}  // namespace dartcast
