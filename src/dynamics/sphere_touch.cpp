// The approach of two moving spheres: the first root of a quadratic, in doubles.
#include "dynamics/sphere_touch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vec3_parts.hpp"

namespace dartcast {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// The second sphere as seen from the first. It is a point, and meets a ball of the sum of the radii when
// a t^2 + 2 b t + c <= 0. Lengths are scaled by a power of two, so that nothing overflows.
struct Relative {
  Vec3 place;
  Vec3 motion;
  double radius;
  double scale = 1.0;  // times this is the true length
  double distance;
  double a;
  double b;
  double c;

  Relative(const SphereMotion& first, const SphereMotion& second)
      : place(second.centre - first.centre),
        motion(second.displacement - first.displacement),
        radius(first.radius + second.radius) {
    const double size = std::max({largest_component(place), largest_component(motion), radius});
    if (size > 0.0 && !(size > 0x1p-100 && size < 0x1p+100)) {
      scale = std::ldexp(1.0, std::ilogb(size));
      place *= 1.0 / scale;
      motion *= 1.0 / scale;
      radius /= scale;
    }
    distance = norm(place);
    a = dot(motion, motion);
    b = dot(place, motion);
    c = (distance - radius) * (distance + radius);
  }

  [[nodiscard]] Vec3 at(double t) const { return place + motion * t; }

  // From the first centre to the second at time t.
  [[nodiscard]] Vec3 normal(double t) const {
    for (const Vec3& along : {at(t), motion}) {
      const double size = largest_component(along);
      if (!(size > 0.0)) continue;
      const Vec3 v = along * (1.0 / size);  // squares of lengths that are small beside the scale vanish
      return v * (1.0 / norm(v));
    }
    return {1.0, 0.0, 0.0};
  }
};

// The first root of a t^2 + 2 b t + c, if c > 0; infinite if there is none.
double first_root(double a, double b, double c) {
  if (!(b < 0.0)) return infinity;
  const double square = b * b - a * c;
  return square < 0.0 ? infinity : c / (std::sqrt(square) - b);
}

}  // namespace

Approach approach(const SphereMotion& a, const SphereMotion& b) {
  const Relative r(a, b);
  Approach result;
  double time = 0.0;
  if (r.c > 0.0 && r.b < 0.0) {
    time = std::min(1.0, -r.b / r.a);
    result.distance = std::max(0.0, norm(r.at(time)) - r.radius);
    if (result.distance == 0.0) time = std::min(time, first_root(r.a, r.b, r.c));
  } else {
    result.distance = r.distance - r.radius;
  }
  result.normal = r.normal(time);
  result.gap = (r.c > 0.0 ? dot(r.place, result.normal) : r.distance) - r.radius;
  result.gap *= r.scale;
  result.distance *= r.scale;
  return result;
}

}  // namespace dartcast
