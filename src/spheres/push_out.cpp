// The shortest displacement that takes a sphere out of the walls, by Hildreth's method.
#include "spheres/push_out.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace dartcast {

namespace {

constexpr int max_turns = 4;
constexpr int sweeps = 64;
constexpr int halvings = 30;
constexpr double enough = 0x1p-50;  // share of the radius: depths below it are rounding

// The shortest x with normal . x >= radius - distance for all walls, nearly: Hildreth's method (C. Hildreth, "A
// quadratic programming procedure", 1957), which corrects one wall after another. Returns nothing where it does not
// converge.
std::optional<Vec3> shortest(std::span<const WallFeature> walls, double radius, std::span<double> pull) {
  std::fill(pull.begin(), pull.end(), 0.0);
  Vec3 x;
  double worst = 0.0;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    worst = 0.0;
    for (std::size_t i = 0; i < walls.size(); ++i) {
      const double short_of = radius - walls[i].distance - dot(walls[i].normal, x);
      worst = std::max(worst, short_of);
      const double change = std::max(short_of, -pull[i]);
      pull[i] += change;
      x += walls[i].normal * change;
    }
    if (worst <= enough * radius) return x;
  }
  if (worst > 0x1p-20 * radius) return {};
  return x;
}

// As shortest(); where there is no room, for the largest radius that fits.
Vec3 widest(std::span<const WallFeature> walls, double radius, std::span<double> pull) {
  if (const auto x = shortest(walls, radius, pull)) return *x;
  double fits = walls.front().distance;  // sorted by distance: x = 0 fits this radius
  double too_large = radius;
  Vec3 best;
  for (int k = 0; k < halvings; ++k) {
    const double middle = 0.5 * (fits + too_large);
    const auto x = shortest(walls, middle, pull);
    if (x) best = *x;
    (x ? fits : too_large) = middle;
  }
  return best;
}

}  // namespace

Vec3 push_out(const CellComplex& complex, Cell cell, const Vec3& centre, double radius, NearWalls& near) {
  std::vector<double> pull;
  Vec3 out;
  double lowest = -1.0;
  Vec3 best;
  for (int turn = 0; turn <= max_turns; ++turn) {
    const auto walls = near.within(complex, cell, centre + out, 2.0 * radius, false);
    if (walls.empty()) return out;
    const double distance = walls.front().distance;
    if (distance > lowest) {
      lowest = distance;
      best = out;
    }
    if (distance >= radius * (1.0 - enough) || turn == max_turns) break;
    pull.resize(walls.size());
    out += widest(walls, radius, pull);
    const double length = norm(out);
    if (length > 2.0 * radius) out = out * (2.0 * radius / length);
  }
  return best;
}

}  // namespace dartcast
