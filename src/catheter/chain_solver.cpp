// One implicit step of a chain of points: springs, friction and walls in one banded system.
#include "catheter/chain_solver.hpp"

#include <algorithm>
#include <cmath>

#include "base/vec3_parts.hpp"
#include "catheter/transport.hpp"

namespace dartcast {

namespace {

// Lengths and walls are so many times as stiff as all else at a point. Their remaining errors are then a thousandth
// of those that bending alone would cause. The system is well conditioned for any bending up to 10^8.
double hardness(const ChainWeights& weights) { return 1e3 * (1.0 + 16.0 * weights.bending); }

// Shares of the spacing. Below the first share friction grows with the motion, so that a point at rest has a
// direction of friction. A gap below the second share is rounding, and does not make a wall press.
constexpr double creep = 1e-3;
constexpr double gap_share = 1e-9;

constexpr int max_solves = 4;

double component(const Vec3& v, std::size_t i) { return i == 0 ? v.x : i == 1 ? v.y : v.z; }

// The number of points that a wall acts on.
std::size_t points_of(const ChainWall& wall) { return wall.weight > 0.0 ? 2 : 1; }

}  // namespace

// Adds to the 3 x 3 block of points i and j <= i.
void ChainSolver::add_block(std::size_t i, std::size_t j, const std::array<Vec3, 3>& rows) {
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t row = 3 * i + a;
    for (std::size_t b = 0; b < (i == j ? a + 1 : 3); ++b)
      matrix_[row][3 * j + b + band - 1 - row] += component(rows[a], b);
  }
}

void ChainSolver::add_right(std::size_t i, const Vec3& force) {
  right_[3 * i] += force.x;
  right_[3 * i + 1] += force.y;
  right_[3 * i + 2] += force.z;
}

// A spring between the displacements u of some neighbouring points: stiffness / 2 |sum factor u + offset|^2, along
// `direction` alone unless that is 0.
void ChainSolver::add_spring(std::size_t first, std::span<const double> factors, std::size_t free, double stiffness,
                             const Vec3& offset, const Vec3& direction) {
  const bool line = direction != Vec3{};
  const auto row = [&](double c, std::size_t a) {
    const Vec3 unit = {a == 0 ? c : 0.0, a == 1 ? c : 0.0, a == 2 ? c : 0.0};
    return line ? direction * (c * component(direction, a)) : unit;
  };
  for (std::size_t k = 0; k < factors.size() && first + k < free; ++k) {
    add_right(first + k, offset * (-stiffness * factors[k]));
    for (std::size_t l = 0; l <= k; ++l) {
      const double c = stiffness * factors[k] * factors[l];
      add_block(first + k, first + l, {row(c, 0), row(c, 1), row(c, 2)});
    }
  }
}

void ChainSolver::add_springs(const Chain& chain, const ChainWeights& weights) {
  static constexpr std::array<double, 3> second_difference = {1.0, -2.0, 1.0};
  static constexpr std::array<double, 2> difference = {1.0, -1.0};
  static constexpr std::array<double, 1> one = {1.0};
  const std::span<const Vec3> x = chain.points;
  for (std::size_t i = 0; i < chain.free; ++i) {
    add_spring(i, one, chain.free, 1.0, x[i] - chain.wanted[i], {});
    const Vec3 bend = (x[i] - x[i + 1]) - (x[i + 1] - x[i + 2]) - chain.bends[i + 1];
    add_spring(i, second_difference, chain.free, weights.bending, bend, {});
    const Vec3 along = unit_or(x[i] - x[i + 1], {});
    const double longer = norm(x[i] - x[i + 1]) - weights.spacing;
    if (along != Vec3{}) add_spring(i, difference, chain.free, hardness(weights), along * longer, along);
  }
}

void ChainSolver::add_friction(const ChainWall& wall, const Chain& chain, const ChainWeights& weights) {
  const Vec3 slip = across_normal(place_on(wall, chain.points) - place_on(wall, chain.start), wall.normal);
  // Limited to hardness, so that the system stays well conditioned.
  const double w =
      std::min(weights.friction * wall.pressure / std::max(norm(slip), creep * weights.spacing), hardness(weights));
  if (w == 0.0) return;
  const Vec3& n = wall.normal;
  const std::array<double, 2> factors = {1.0 - wall.weight, wall.weight};
  for (std::size_t k = 0; k < points_of(wall) && wall.index + k < chain.free; ++k) {
    add_right(wall.index + k, slip * (-w * factors[k]));
    for (std::size_t l = 0; l <= k; ++l) {
      const double c = w * factors[k] * factors[l];
      add_block(wall.index + k, wall.index + l,
                {across_normal({c, 0.0, 0.0}, n), across_normal({0.0, c, 0.0}, n), across_normal({0.0, 0.0, c}, n)});
    }
  }
}

// Keeps the place on the chain in the wall's plane.
void ChainSolver::add_wall(const ChainWall& wall, const Chain& chain, const ChainWeights& weights) {
  const std::array<double, 2> factors = {1.0 - wall.weight, wall.weight};
  const double gap = dot(wall.normal, place_on(wall, chain.points) - wall.point);
  add_spring(wall.index, std::span(factors).first(points_of(wall)), chain.free, hardness(weights), wall.normal * gap,
             wall.normal);
}

// Cholesky's factors in place, then the solution in right_. Entries to the left of the first column are 0 in the
// matrix.
void ChainSolver::factor_and_solve() {
  constexpr std::size_t last = band - 1;  // the diagonal's place in a row
  const std::size_t n = right_.size();
  for (std::size_t r = 0; r < n; ++r) {
    std::array<double, band>& row = matrix_[r];
    for (std::size_t d = std::min(r, last); d > 0; --d) {  // the entry d to the left of the diagonal
      const std::array<double, band>& other = matrix_[r - d];
      double sum = row[last - d];
      for (std::size_t k = 0; k < last - d; ++k) sum -= row[k] * other[k + d];
      row[last - d] = sum * other[last];
    }
    double rest = row[last];
    double y = right_[r];
    for (std::size_t d = std::min(r, last); d > 0; --d) {
      rest -= row[last - d] * row[last - d];
      y -= row[last - d] * right_[r - d];
    }
    row[last] = 1.0 / std::sqrt(rest);  // the diagonal is kept inverted
    right_[r] = y * row[last];
  }
  for (std::size_t r = n; r-- > 0;) {
    const std::array<double, band>& row = matrix_[r];
    right_[r] *= row[last];
    for (std::size_t d = std::min(r, last); d > 0; --d) right_[r - d] -= row[last - d] * right_[r];
  }
}

Vec3 ChainSolver::displacement(std::size_t i) const { return {right_[3 * i], right_[3 * i + 1], right_[3 * i + 2]}; }

// The displacement of the place that a wall is for. Points from `free` on do not move.
Vec3 ChainSolver::displacement_at(const ChainWall& wall, std::size_t free) const {
  const Vec3 first = displacement(wall.index);
  if (wall.weight == 0.0) return first;
  const Vec3 next = wall.index + 1 < free ? displacement(wall.index + 1) : Vec3{};
  return first * (1.0 - wall.weight) + next * wall.weight;
}

// Adds walls that points would pass to those that press, and removes walls that would pull points back. Returns
// whether any changed.
bool ChainSolver::change_walls(const Chain& chain, const ChainWeights& weights, std::span<ChainWall> walls) {
  bool changed = false;
  for (std::size_t k = 0; k < walls.size(); ++k) {
    ChainWall& wall = walls[k];
    const double gap = dot(wall.normal, place_on(wall, chain.points) + displacement_at(wall, chain.free) - wall.point);
    const bool press = pressing_[k] != 0 ? gap < 0.0 : gap < -gap_share * weights.spacing;
    changed = changed || press != (pressing_[k] != 0);
    pressing_[k] = press ? 1 : 0;
    wall.pressure = press ? -gap * hardness(weights) : 0.0;
  }
  return changed;
}

void ChainSolver::solve(const Chain& chain, const ChainWeights& weights, std::span<ChainWall> walls) {
  if (chain.free == 0) return;
  matrix_.assign(3 * chain.free, {});
  right_.assign(3 * chain.free, 0.0);
  add_springs(chain, weights);
  pressing_.clear();
  for (const ChainWall& wall : walls) {
    pressing_.push_back(wall.pressure > 0.0 ? 1 : 0);
    add_friction(wall, chain, weights);
  }
  springs_ = matrix_;
  springs_right_ = right_;
  for (int i = 0; i < max_solves; ++i) {
    if (i > 0) {
      matrix_ = springs_;
      right_ = springs_right_;
    }
    for (std::size_t k = 0; k < walls.size(); ++k) {
      if (pressing_[k] != 0) add_wall(walls[k], chain, weights);
    }
    factor_and_solve();
    if (!change_walls(chain, weights, walls)) break;
  }
  double farthest = 0.0;
  for (std::size_t i = 0; i < chain.free; ++i) farthest = std::max(farthest, norm(displacement(i)));
  const double share = farthest > weights.reach ? weights.reach / farthest : 1.0;
  for (std::size_t i = 0; i < chain.free; ++i) chain.points[i] += displacement(i) * share;
}

}  // namespace dartcast
