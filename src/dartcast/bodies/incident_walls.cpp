#include "dartcast/bodies/incident_walls.hpp"

namespace dartcast {

namespace {

// A projection points into a wall by rounding alone where it does by less than this share of what was projected: the
// walls it was projected on are met up to some ten roundings of 2^-53 (normals are of length 1 up to four of them, and
// creases are made orthogonal twice).
constexpr double rounding_share = 0x1p-46;

bool points_into_none(const Vec3& v, std::span<const WallHit> walls, double most) {
  return std::all_of(walls.begin(), walls.end(), [&](const WallHit& w) { return dot(v, w.normal) >= -most; });
}

Vec3 into_plane(const Vec3& v, const Vec3& n) { return v - n * dot(v, n); }

// The unit vector of the plane of both normals that is perpendicular to the first; zero where they are the same.
Vec3 beside(const Vec3& first, const Vec3& second) {
  const Vec3 raw = into_plane(second, first);
  const double length = norm(raw);
  if (length == 0.0) return {};
  const Vec3 again = into_plane(raw * (1.0 / length), first);
  const double left = norm(again);
  return left > 0.0 ? again * (1.0 / left) : Vec3{};
}

// One wall alone holds v back, where the others let it.
bool hold_by_one(const Vec3& v, std::span<const WallHit> walls, double most, HeldBack& held) {
  const auto try_wall = [&](const WallHit& wall, double into) {
    held.velocity = v + wall.normal * into;
    held.wall[0] = &wall;
    held.impulse[0] = into;
    held.count = 1;
    return points_into_none(held.velocity, walls, most);
  };
  const auto worst = std::min_element(walls.begin(), walls.end(), [&](const WallHit& a, const WallHit& b) {
    return dot(v, a.normal) < dot(v, b.normal);
  });
  if (try_wall(*worst, -dot(v, worst->normal))) return true;
  return std::any_of(walls.begin(), walls.end(), [&](const WallHit& wall) {
    const double into = -dot(v, wall.normal);
    return into > 0.0 && &wall != &*worst && try_wall(wall, into);
  });
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
  return norm(reached - held.velocity) <= rounding_share * sum;
}

// Along the crease of two that push it there, where the others let it.
bool hold_by_two(const Vec3& v, std::span<const WallHit> walls, double most, HeldBack& held) {
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const Vec3& n = walls[i].normal;
    const Vec3 plane = into_plane(v, n);
    for (std::size_t j = i + 1; j < walls.size(); ++j) {
      const Vec3 m = beside(n, walls[j].normal);
      const double sine = dot(m, walls[j].normal);
      if (!(sine > 0.0)) continue;
      const double second = -dot(plane, m) / sine;
      const double first = -dot(v, n) - second * dot(n, walls[j].normal);
      held = {into_plane(plane, m), {&walls[i], &walls[j]}, {first, second}, 2};
      if (points_into_none(held.velocity, walls, most) && leads_there(v, held)) return true;
    }
  }
  return false;
}

// Three walls take all of v. Where rounding finds none that do, it ends without.
void hold_by_three(const Vec3& v, std::span<const WallHit> walls, HeldBack& held) {
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

HeldBack held_back(const Vec3& v, std::span<const WallHit> walls) {
  HeldBack held;
  if (points_into_none(v, walls, 0.0)) {
    held.velocity = v;
    return held;
  }
  const double most = rounding_share * norm(v);
  if (hold_by_one(v, walls, most, held) || hold_by_two(v, walls, most, held)) return held;
  hold_by_three(v, walls, held);
  return held;
}

}  // namespace dartcast
