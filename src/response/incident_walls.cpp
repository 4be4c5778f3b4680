// Projection onto the cone of the velocities that walls permit, and shortening a velocity to an energy.
#include "response/incident_walls.hpp"

#include <tuple>

#include "base/vec3_parts.hpp"

namespace dartcast {

namespace {

// An order of walls by their values, not by their places in the list.
bool comes_before(const WallHit& a, const WallHit& b) {
  const auto key = [](const WallHit& w) {
    return std::tuple(w.normal.x, w.normal.y, w.normal.z, w.patch.value, w.face.cell.value, w.face.face, w.triangle);
  };
  return key(a) < key(b);
}

// The wall that v points into most, and by more than `limit`.
const WallHit* max_opposed(const Vec3& v, const JointWalls& walls, double limit) {
  const WallHit* worst = nullptr;
  double lowest = -limit;
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const WallHit& wall = walls[i];
    const double along = dot(v, wall.normal);
    if (!(along <= lowest)) continue;
    if (along < lowest || (worst != nullptr && comes_before(wall, *worst))) {
      lowest = along;
      worst = &wall;
    }
  }
  return worst;
}

// Walls that may hold v back: at most four, in their order.
class WallSubset {
 public:
  void add(const WallHit* wall) {
    std::size_t at = count_++;
    for (; at > 0 && comes_before(*wall, *wall_[at - 1]); --at) wall_[at] = wall_[at - 1];
    wall_[at] = wall;
  }
  [[nodiscard]] std::size_t size() const { return count_; }
  const WallHit& operator[](std::size_t i) const { return *wall_[i]; }
  [[nodiscard]] bool permit(const Vec3& v, double limit) const {
    return std::all_of(wall_.begin(), wall_.begin() + static_cast<std::ptrdiff_t>(count_),
                       [&](const WallHit* w) { return dot(v, w->normal) >= -limit; });
  }

 private:
  std::array<const WallHit*, 4> wall_{};
  std::size_t count_ = 0;
};

// The unit vector of the plane of both normals that is perpendicular to the first; zero if they are the same.
Vec3 beside(const Vec3& first, const Vec3& second) {
  const Vec3 raw = across_normal(second, first);
  const double length = norm(raw);
  if (length == 0.0) return {};
  const Vec3 again = across_normal(raw * (1.0 / length), first);
  const double left = norm(again);
  return left > 0.0 ? again * (1.0 / left) : Vec3{};
}

HeldBack held_by(const Vec3& v, const WallHit& wall, double into) {
  HeldBack held;
  held.velocity = v + wall.normal * into;
  held.wall[0] = &wall;
  held.impulse[0] = into;
  held.count = 1;
  return held;
}

// One wall alone holds v back, if the others let it.
bool hold_by_one(const Vec3& v, const WallSubset& walls, double limit, HeldBack& held) {
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const double into = -dot(v, walls[i].normal);
    if (!(into > 0.0)) continue;
    held = held_by(v, walls[i], into);
    if (walls.permit(held.velocity, limit)) return true;
  }
  return false;
}

// Whether these impulses, none below 0, lead from v to where it is held, up to rounding.
bool leads_there(const Vec3& v, HeldBack& held) {
  Vec3 reached = v;
  double sum = norm(v);
  for (unsigned i = 0; i < held.count; ++i) {
    held.impulse[i] = std::max(0.0, held.impulse[i]);
    reached += held.wall[i]->normal * held.impulse[i];
    sum += held.impulse[i];
  }
  return std::isfinite(sum) && norm(reached - held.velocity) <= rounding_share * sum;
}

// Along the crease of two that push it there, if the others let it.
bool hold_by_two(const Vec3& v, const WallSubset& walls, double limit, HeldBack& held) {
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const Vec3& n = walls[i].normal;
    const Vec3 plane = across_normal(v, n);
    for (std::size_t j = i + 1; j < walls.size(); ++j) {
      const Vec3 m = beside(n, walls[j].normal);
      const double sine = dot(m, walls[j].normal);
      if (!(sine > 0.0)) continue;
      const double second = -dot(plane, m) / sine;
      const double first = -dot(v, n) - second * dot(n, walls[j].normal);
      held = {across_normal(plane, m), {&walls[i], &walls[j]}, {first, second}, 2};
      if (walls.permit(held.velocity, limit) && leads_there(v, held)) return true;
    }
  }
  return false;
}

// Three walls take all of v. If rounding finds none that do, it ends without.
void hold_by_three(const Vec3& v, const WallSubset& walls, HeldBack& held) {
  for (std::size_t i = 0; i < walls.size(); ++i) {
    for (std::size_t j = i + 1; j < walls.size(); ++j) {
      const Vec3 crease = cross(walls[i].normal, walls[j].normal);
      for (std::size_t k = j + 1; k < walls.size(); ++k) {
        const double volume = dot(crease, walls[k].normal);
        if (volume == 0.0) continue;
        const Vec3 back = v * (-1.0 / volume);
        held = {{},
                {&walls[i], &walls[j], &walls[k]},
                {dot(back, cross(walls[j].normal, walls[k].normal)), dot(back, cross(walls[k].normal, walls[i].normal)),
                 dot(back, crease)},
                3};
        if (leads_there(v, held)) return;
      }
    }
  }
  held = {};
}

}  // namespace

bool points_into(const Vec3& v, const JointWalls& walls, double limit) {
  for (std::size_t i = 0; i < walls.size(); ++i) {
    if (dot(v, walls[i].normal) < -limit) return true;
  }
  return false;
}

// The projection onto all walls is that onto three of them at most. They are found as a linear programme's basis is.
// Those that hold the last result back, and the wall that it points into most, hold it back anew. Each time it is
// farther from v, so that no set of walls comes twice. Rounding may end that, and then all of v is given up.
HeldBack held_back(const Vec3& v, const JointWalls& walls) {
  constexpr unsigned max_rounds = 32;
  HeldBack held;
  held.velocity = v;
  const WallHit* next = max_opposed(v, walls, 0.0);
  if (next == nullptr) return held;
  const double limit = rounding_share * norm(v);
  held = held_by(v, *next, -dot(v, next->normal));
  for (unsigned round = 0; round < max_rounds; ++round) {
    next = max_opposed(held.velocity, walls, limit);
    if (next == nullptr) return held;
    WallSubset subset;
    subset.add(next);
    for (unsigned i = 0; i < held.count; ++i) subset.add(held.wall[i]);
    if (!hold_by_one(v, subset, limit, held) && !hold_by_two(v, subset, limit, held)) hold_by_three(v, subset, held);
    if (held.count == 0) break;
  }
  return {};
}

Vec3 shortened(const Vec3& velocity, double limit, const Vec3& lead) {
  const double square = dot(velocity, velocity);
  const double along = dot(lead, velocity);
  if (!(square + 2.0 * along > limit) || square == 0.0) return velocity;
  if (lead != Vec3{}) {
    // The larger root s of s^2 square + 2 s along = most.
    const double root = along * along + square * limit;
    const double share = ((root > 0.0 ? std::sqrt(root) : 0.0) - along) / square;
    return velocity * std::clamp(share, 0.0, 1.0);
  }
  // By the quotient, and a few units in the last place more. Each makes components smaller that are not subnormal, and
  // others do not count in the square.
  Vec3 result = velocity * std::sqrt(limit / square);
  while (dot(result, result) > limit) result *= 1.0 - 0x1p-52;
  return result;
}

}  // namespace dartcast
