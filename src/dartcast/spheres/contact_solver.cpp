#include "dartcast/spheres/contact_solver.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "dartcast/base/error.hpp"

namespace dartcast {

namespace {

constexpr std::uint32_t wall_itself = 0xffffffffU;

// Normals of one wall in two steps: closer than some 25 degrees.
constexpr double same_normal = 0.9;

bool is_share(double x) { return x >= 0.0 && x <= 1.0; }
bool is_amount(double x) { return x >= 0.0 && std::isfinite(x); }

void check_solver(const SolverOptions& o) {
  if (!(o.dt > 0.0) || !std::isfinite(o.dt)) throw InvalidArgument("contacts: dt must be positive and finite");
  if (!is_share(o.restitution) || !is_share(o.push))
    throw InvalidArgument("contacts: restitution and push must be between 0 and 1");
  if (!is_amount(o.friction) || !is_amount(o.resting_speed))
    throw InvalidArgument("contacts: friction and resting speed must be finite and not negative");
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

void ContactSolver::sort_pairs(std::span<const PairContact> pairs, std::span<const std::uint64_t> ids) {
  order_.resize(pairs.size());
  std::iota(order_.begin(), order_.end(), 0U);
  const auto key = [&](std::uint32_t i) {
    const auto [low, high] = std::minmax(ids[pairs[i].a], ids[pairs[i].b]);
    return std::pair(low, high);
  };
  const auto before = [&](std::uint32_t x, std::uint32_t y) { return key(x) < key(y); };
  if (!std::is_sorted(order_.begin(), order_.end(), before)) std::sort(order_.begin(), order_.end(), before);
}

// Walls of a sphere in the order of their normals, which the order they were found in does not change.
void ContactSolver::sort_walls(std::span<const WallContact> walls, std::span<const std::uint64_t> ids) {
  order_.resize(walls.size());
  std::iota(order_.begin(), order_.end(), 0U);
  const auto key = [&](std::uint32_t i) {
    const WallContact& w = walls[i];
    return std::tuple(ids[w.sphere], w.normal.x, w.normal.y, w.normal.z, w.gap);
  };
  const auto before = [&](std::uint32_t x, std::uint32_t y) { return key(x) < key(y); };
  if (!std::is_sorted(order_.begin(), order_.end(), before)) std::sort(order_.begin(), order_.end(), before);
}

void ContactSolver::add_row(Row row, double gap, double restitution, const Vec3& wall_velocity,
                            const SolverSpheres& spheres, const SolverOptions& options) {
  const bool wall = row.a == wall_itself;
  const double inverse = (wall ? 0.0 : spheres.inverse_masses[row.a]) + spheres.inverse_masses[row.b];
  if (!(inverse > 0.0)) return;
  row.mass = 1.0 / inverse;
  row.bound = gap > 0.0 ? -gap / options.dt : 0.0;
  Rest rest;
  rest.wall_velocity = wall_velocity;
  rest.push_bound = gap > 0.0 ? row.bound : -options.push * gap / options.dt;
  const Vec3 other = wall ? wall_velocity : spheres.velocities[row.a];
  const double nearing = -dot(spheres.velocities[row.b] - other, row.normal);
  if (nearing > options.resting_speed) rest.rebound = restitution * nearing;
  rows_.push_back(row);
  rest_.push_back(rest);
}

void ContactSolver::make_rows(std::span<const PairContact> pairs, std::span<const WallContact> walls,
                              const SolverSpheres& spheres, const SolverOptions& options) {
  rows_.clear();
  rest_.clear();
  sort_pairs(pairs, spheres.ids);
  for (const std::uint32_t i : order_) {
    const PairContact& p = pairs[i];
    const bool swapped = spheres.ids[p.a] > spheres.ids[p.b];
    Row row;
    row.a = swapped ? p.b : p.a;
    row.b = swapped ? p.a : p.b;
    row.normal = swapped ? -p.normal : p.normal;
    row.friction = options.friction;
    add_row(row, p.gap, options.restitution, {}, spheres, options);
  }
  pair_rows_ = rows_.size();
  sort_walls(walls, spheres.ids);
  for (const std::uint32_t i : order_) {
    const WallContact& w = walls[i];
    Row row;
    row.a = wall_itself;
    row.b = w.sphere;
    row.normal = w.normal;
    row.friction = w.friction;
    add_row(row, w.gap, w.restitution, w.wall_velocity, spheres, options);
  }
}

void ContactSolver::set_kept(std::span<const KeptImpulse> kept) {
  kept_.assign(kept.begin(), kept.end());
  kept_pairs_ = static_cast<std::size_t>(
      std::count_if(kept.begin(), kept.end(), [](const KeptImpulse& k) { return k.b != KeptImpulse::wall; }));
}

// Both are sorted alike: one pass. Of a sphere's walls the one with the nearest normal is taken.
void ContactSolver::take_kept(const SolverSpheres& spheres) {
  const auto start = [](Row& row, const KeptImpulse& kept) {
    row.along = kept.along;
    row.across = on_tangent(kept.across, row.normal);
  };
  std::size_t k = 0;
  for (std::size_t i = 0; i < pair_rows_; ++i) {
    const std::pair key(spheres.ids[rows_[i].a], spheres.ids[rows_[i].b]);
    while (k < kept_pairs_ && std::pair(kept_[k].a, kept_[k].b) < key) ++k;
    if (k < kept_pairs_ && std::pair(kept_[k].a, kept_[k].b) == key) start(rows_[i], kept_[k]);
  }
  k = kept_pairs_;
  for (std::size_t i = pair_rows_; i < rows_.size(); ++i) {
    const std::uint64_t id = spheres.ids[rows_[i].b];
    while (k < kept_.size() && kept_[k].a < id) ++k;
    const KeptImpulse* best = nullptr;
    double most = same_normal;
    for (std::size_t m = k; m < kept_.size() && kept_[m].a == id; ++m) {
      const double alike = dot(kept_[m].normal, rows_[i].normal);
      if (alike <= most) continue;
      most = alike;
      best = &kept_[m];
    }
    if (best != nullptr) start(rows_[i], *best);
  }
}

// Velocities of the two sides of a contact, and impulses on them.
class ContactSolver::Sides {
 public:
  Sides(const Row& row, const Vec3& wall_velocity, std::span<const double> inverse_masses, std::span<Vec3> velocities)
      : a_(row.a == wall_itself ? nullptr : &velocities[row.a]),
        b_(&velocities[row.b]),
        other_(a_ == nullptr ? wall_velocity : *a_),
        self_(*b_),
        a_inverse_(a_ == nullptr ? 0.0 : inverse_masses[row.a]),
        b_inverse_(inverse_masses[row.b]) {}

  [[nodiscard]] Vec3 relative() const { return self_ - other_; }
  void apply(const Vec3& impulse) {
    other_ -= impulse * a_inverse_;
    self_ += impulse * b_inverse_;
  }
  void finish() const {
    if (a_ != nullptr) *a_ = other_;
    *b_ = self_;
  }

  // Friction first: what keeps spheres apart has the last word.
  void solve(Row& row, double bound) {
    if (row.friction > 0.0) {
      Vec3 across = row.across - on_tangent(relative(), row.normal) * row.mass;
      const double most = row.friction * row.along;
      const double square = dot(across, across);
      if (square > most * most) across *= most / std::sqrt(square);
      apply(across - row.across);
      row.across = across;
    }
    const double along = std::max(0.0, row.along - row.mass * (dot(relative(), row.normal) - bound));
    apply(row.normal * (along - row.along));
    row.along = along;
    finish();
  }

 private:
  Vec3* a_;
  Vec3* b_;
  Vec3 other_;
  Vec3 self_;
  double a_inverse_;
  double b_inverse_;
};

namespace {

// Calls each(i) for all rows, forwards and backwards in turn, so that an impulse passes through a chain either way. The
// last time is forwards, so that walls, which are last, have the last word: no sphere goes on into one.
template <class Each>
void sweep(std::size_t rows, unsigned iterations, Each&& each) {
  for (unsigned k = 0; k < iterations; ++k) {
    for (std::size_t i = 0; i < rows; ++i) each((iterations - k) % 2 == 1 ? i : rows - 1 - i);
  }
}

}  // namespace

void ContactSolver::solve_velocities(const SolverSpheres& spheres, unsigned iterations) {
  sweep(rows_.size(), iterations, [&](std::size_t i) {
    Sides(rows_[i], rest_[i].wall_velocity, spheres.inverse_masses, spheres.velocities).solve(rows_[i], rows_[i].bound);
  });
}

// Displacements are those of the velocities, and what penetrates is pushed apart by some of its depth, with impulses
// of their own that are forgotten afterwards.
void ContactSolver::solve_pushes(const SolverSpheres& spheres, const SolverOptions& options) {
  std::copy(spheres.velocities.begin(), spheres.velocities.end(), spheres.displacements.begin());
  sweep(rows_.size(), options.push_iterations, [&](std::size_t i) {
    const Row& row = rows_[i];
    Rest& rest = rest_[i];
    Sides sides(row, rest.wall_velocity, spheres.inverse_masses, spheres.displacements);
    const double push = std::max(0.0, rest.push - row.mass * (dot(sides.relative(), row.normal) - rest.push_bound));
    if (push == rest.push) return;
    sides.apply(row.normal * (push - rest.push));
    sides.finish();
    rest.push = push;
  });
  for (Vec3& d : spheres.displacements) d *= options.dt;
}

void ContactSolver::rebound(const SolverSpheres& spheres, unsigned iterations) {
  bool any = false;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (!(rows_[i].along > 0.0)) rest_[i].rebound = 0.0;
    any = any || rest_[i].rebound > 0.0;
  }
  if (!any) return;
  sweep(rows_.size(), iterations, [&](std::size_t i) {
    const double bound = rest_[i].rebound > 0.0 ? rest_[i].rebound : rows_[i].bound;
    Sides(rows_[i], rest_[i].wall_velocity, spheres.inverse_masses, spheres.velocities).solve(rows_[i], bound);
  });
}

// What rebounds needs no impulse in the next step.
void ContactSolver::keep(const SolverSpheres& spheres) {
  kept_.clear();
  kept_pairs_ = loaded_pairs_ = loaded_walls_ = 0;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Row& row = rows_[i];
    if (!(row.along > 0.0)) continue;
    const bool pair = i < pair_rows_;
    ++(pair ? loaded_pairs_ : loaded_walls_);
    if (rest_[i].rebound > 0.0) continue;
    if (pair)
      kept_.push_back({spheres.ids[row.a], spheres.ids[row.b], row.normal, row.along, row.across});
    else
      kept_.push_back({spheres.ids[row.b], KeptImpulse::wall, row.normal, row.along, row.across});
    if (pair) ++kept_pairs_;
  }
}

void ContactSolver::solve(std::span<const PairContact> pairs, std::span<const WallContact> walls,
                          const SolverSpheres& spheres, const SolverOptions& options) {
  check_solver(options);
  check_contacts(pairs, walls, spheres);
  make_rows(pairs, walls, spheres, options);
  take_kept(spheres);
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Row& row = rows_[i];
    Sides sides(row, rest_[i].wall_velocity, spheres.inverse_masses, spheres.velocities);
    sides.apply(row.normal * row.along + row.across);
    sides.finish();
  }
  solve_velocities(spheres, options.iterations);
  solve_pushes(spheres, options);
  rebound(spheres, options.rebound_iterations);
  keep(spheres);
}

}  // namespace dartcast
