// A segment and all wall triangles: exact heights of its ends, exact signs of where it passes.
#include "soak/truth.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "dartcast/cell_complex.hpp"
#include "support/dyadic.hpp"
#include "support/moving_simplex.hpp"

namespace dartcast::soak {

using test::determinant;
using test::Dyadic;
using test::exact_sign;

namespace {

Vec3 least(const Vec3& a, const Vec3& b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
Vec3 most(const Vec3& a, const Vec3& b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }
bool meet(const Vec3& low, const Vec3& high, const Vec3& other_low, const Vec3& other_high) {
  return low.x <= other_high.x && low.y <= other_high.y && low.z <= other_high.z && other_low.x <= high.x &&
         other_low.y <= high.y && other_low.z <= high.z;
}

// The line from p to q beside the sides of a triangle: all signs equal and not 0, or none against the others.
struct Passage {
  bool inside = false, touching = false;
};
Passage passage(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& v, bool plane) {
  int low = 1;
  int high = -1;
  for (unsigned i = 0; i < 3; ++i) {
    if (plane && i > 0) break;
    // In the plane the wall is the segment from v[0] to v[1]: its ends lie on either side of the line.
    const std::array<int, 2> signs =
        plane ? std::array{exact_sign(p, q, p + Vec3{0, 0, 1}, v[0]), -exact_sign(p, q, p + Vec3{0, 0, 1}, v[1])}
              : std::array{exact_sign(p, q, v[i], v[(i + 1) % 3]), exact_sign(p, q, v[i], v[(i + 1) % 3])};
    for (const int s : signs) {
      low = std::min(low, s);
      high = std::max(high, s);
    }
  }
  return {low == high && low != 0, low >= 0 || high <= 0};
}

// The volume of a moving simplex is a cubic in time. Whether its Bernstein coefficients in doubles are above all rounding:
// then it has no root.
bool stays_positive(const std::array<Vec3, 4>& from, const std::array<Vec3, 4>& to) {
  double size = 0.0;
  std::array<double, 4> f{};
  for (unsigned k = 0; k < 4; ++k) {
    std::array<Vec3, 4> v;
    for (unsigned i = 0; i < 4; ++i) v[i] = from[i] + (to[i] - from[i]) * (k / 3.0);
    const Vec3 a = v[1] - v[0], b = v[2] - v[0], c = v[3] - v[0];
    f[k] = dot(a, cross(b, c));
    size = std::max(size, norm(a) * norm(b) * norm(c));
  }
  const double b1 = (-5.0 * f[0] + 18.0 * f[1] - 9.0 * f[2] + 2.0 * f[3]) / 6.0;
  const double b2 = (2.0 * f[0] - 9.0 * f[1] + 18.0 * f[2] - 5.0 * f[3]) / 6.0;
  return std::min(std::min(f[0], f[3]), std::min(b1, b2)) > 1e-12 * size;
}

// Whether the point is inside the triangle at the first root of the volume: on both sides of it, as near as 2^-bits.
bool is_inside(const test::MovingSimplex& simplex, int bits) {
  const Dyadic before = simplex.last_before_root(bits);
  for (const Dyadic& time : {before, before + Dyadic::power_of_two(-bits)}) {
    const auto signs = simplex.facet_signs(time);
    if (signs[0] == 0 || signs[0] != signs[1] || signs[1] != signs[2]) return false;
  }
  return true;
}

// When the segment is in the wall's plane: n / d, d > 0.
struct When {
  Dyadic n, d;
  friend bool operator<(const When& a, const When& b) { return a.n * b.d < b.n * a.d; }
};

}  // namespace

Walls::Walls(const Environment& environment, bool moved) : plane_(environment.map().dimension() == 2) {
  const CellComplex& complex = environment.complex();
  const auto after = complex.positions();
  const auto before = moved ? complex.previous_positions() : after;
  for (const Cell c : environment.map().cells()) {
    const CellView cell = environment.map().view(c);
    if (!cell.is_free()) continue;
    for (std::uint16_t f = 0; f < cell.shape().face_count(); ++f) {
      if (!cell.is_wall(f)) continue;
      for (std::uint16_t t = 0; t < cell.shape().triangle_count(f); ++t) {
        const auto local = cell.shape().triangle(f, t);
        Wall wall;
        for (unsigned i = 0; i < 3; ++i) {
          const std::uint32_t v = cell.vertex(local[plane_ ? i : 2 - i]).value;
          wall.from[i] = before[v];
          wall.to[i] = after[v];
        }
        wall.low = least(least(least(wall.from[0], wall.from[1]), wall.from[2]),
                         least(least(wall.to[0], wall.to[1]), wall.to[2]));
        wall.high =
            most(most(most(wall.from[0], wall.from[1]), wall.from[2]), most(most(wall.to[0], wall.to[1]), wall.to[2]));
        if (plane_) {
          wall.from[2] = wall.from[0] + Vec3{0, 0, 1};
          wall.to[2] = wall.to[0] + Vec3{0, 0, 1};
          // Counterclockwise from the free side: that is on the left of the edge.
          std::swap(wall.from[1], wall.from[2]);
          std::swap(wall.to[1], wall.to[2]);
        }
        number_[{c.value, f, t}] = walls_.size();
        walls_.push_back(wall);
      }
    }
  }
}

std::string Walls::check_first(const ParticleState& before, const Vec3& target, const Contact* first,
                               std::span<const WallHit> hits) const {
  const Vec3& p = before.position;
  const Vec3& q = target;
  const auto height = [](const Wall& w, const Vec3& x) { return determinant(w.to[0], w.to[1], w.to[2], x); };
  const auto when = [&](const Wall& w) {
    const Dyadic from = height(w, p);
    return When{from, from - height(w, q)};
  };
  const auto side = [](const Wall& w, const Vec3& x) { return exact_sign(w.to[0], w.to[1], w.to[2], x); };
  const auto segment = [&](const Wall& w) { return plane_ ? std::array{w.to[0], w.to[2], w.to[2]} : w.to; };
  const Vec3 low = least(p, q);
  const Vec3 high = most(p, q);
  When least_time{1, 1};
  if (first != nullptr) {
    const auto touched = std::span(before.touching.data(), before.touching_count);
    if (std::find(touched.begin(), touched.end(), hits[0].face) != touched.end() && first->time_of_impact == 0.0)
      return "";
    bool along = false, in_time = false, late = false;
    const auto look_at = [&](const Wall& w) {
      const int from = side(w, p);
      const int to = side(w, q);
      if (from < 0 || to > 0 || !passage(p, q, segment(w), plane_).touching) return;
      if (from == to) {
        along = true;
        return;
      }
      const When time = when(w);
      const bool is_then = (Dyadic(first->time_of_impact) * time.d - time.n).abs() <= Dyadic(1e-9) * time.d;
      if (is_then && !in_time) least_time = time;
      (is_then ? in_time : late) = true;
    };
    // At an edge or a vertex the way may lead out of the front of some walls, or along some. One must be in it, then.
    for (const WallHit& hit : hits) look_at(walls_[number_.at({hit.face.cell.value, hit.face.face, hit.triangle})]);
    if (late && !in_time) return fmt::format("a contact at the wrong time {}", first->time_of_impact);
    // Triangles of a face count as one wall where rounding alone bends it: then any of them may be the one.
    if (!in_time && !along) {
      for (const WallHit& hit : hits) {
        const auto end = number_.upper_bound({hit.face.cell.value, hit.face.face, UINT16_MAX});
        for (auto i = number_.lower_bound({hit.face.cell.value, hit.face.face, 0}); i != end; ++i)
          look_at(walls_[i->second]);
      }
    }
    if (!in_time && !along)
      return fmt::format("a contact at {} with walls that are not on the way", first->time_of_impact);
  }
  for (const Wall& w : walls_) {
    if (!meet(low, high, w.low, w.high)) continue;
    if (side(w, p) <= 0 || side(w, q) >= 0 || !passage(p, q, segment(w), plane_).inside) continue;
    if (first == nullptr) return "a wall is passed without a contact";
    if (when(w) < least_time) return "an earlier wall is passed";
  }
  return "";
}

std::string Walls::check_first_simultaneous(const ParticleState& before, const Vec3& target, const Contact* first,
                                            std::span<const WallHit> hits) const {
  if (plane_) return "";
  const Vec3& p = before.position;
  const Vec3 low = least(p, target);
  const Vec3 high = most(p, target);
  // A wall that is met exactly then is the contact's own.
  const Dyadic limit = Dyadic(first != nullptr ? first->time_of_impact : 1.0) * Dyadic(1.0 - 0x1p-50);
  // From a wall a particle is carried, as Environment::advance() does.
  for (const Wall& w : walls_)
    if (meet(p, p, least(least(w.from[0], w.from[1]), w.from[2]), most(most(w.from[0], w.from[1]), w.from[2])) &&
        exact_sign(w.from[0], w.from[1], w.from[2], p) == 0)
      return "";
  const auto simplex_of = [&](const Wall& w) {
    return test::MovingSimplex({w.from[0], w.from[1], w.from[2], p}, {w.to[0], w.to[1], w.to[2], target});
  };
  for (const Wall& w : walls_) {
    if (!meet(low, high, w.low, w.high) || exact_sign(w.from[0], w.from[1], w.from[2], p) <= 0) continue;
    if (stays_positive({w.from[0], w.from[1], w.from[2], p}, {w.to[0], w.to[1], w.to[2], target})) continue;
    const test::MovingSimplex simplex = simplex_of(w);
    if (simplex.has_root_by(Dyadic(0x1p-40))) return "";  // it is as near as rounding, and is carried
    if (limit.sign() == 0 || !simplex.has_root_by(limit)) continue;
    if (!is_inside(simplex, 40) || !is_inside(simplex, 100)) continue;
    if (first == nullptr) return "a moving wall is passed without a contact";
    return fmt::format("a moving wall is met before the contact at {}", first->time_of_impact);
  }
  if (first == nullptr || limit.sign() == 0) return "";
  const Wall& w = walls_[number_.at({hits[0].face.cell.value, hits[0].face.face, hits[0].triangle})];
  if (exact_sign(w.from[0], w.from[1], w.from[2], p) <= 0) return "";
  const Dyadic window = std::min(Dyadic(1.0), limit + Dyadic(0x1p-19));
  if (!simplex_of(w).has_root_by(window)) return fmt::format("no wall is there at {}", first->time_of_impact);
  return "";
}

}  // namespace dartcast::soak
