// Responses at walls of a surface: reflection and sliding.
#include <cmath>

#include "dartcast/surface.hpp"

namespace dartcast {

namespace {

// Whether v points off the wall, or along it: its angle to the normal is at most that of the wall's sides.
bool points_off(const SurfaceContact& c, const Vec3& v) {
  return dot(v, c.normal) >= norm(v) * dot(c.sides[0], c.normal);
}

}  // namespace

Vec3 reflected(const SurfaceContact& contact, const Vec3& v, double restitution) {
  const double into = -dot(v, contact.normal);
  return into > 0.0 ? v + contact.normal * ((1.0 + restitution) * into) : v;
}

Vec3 slid(const SurfaceContact& contact, const Vec3& v) {
  const double into = -dot(v, contact.normal);
  const bool reentrant = contact.kind == Kind::vertex && dot(contact.sides[0], contact.normal) < 0.0;
  if (reentrant) return into > 0.0 ? v + contact.normal * into : v;
  if (points_off(contact, v)) return v;
  const double right = dot(v, contact.sides[0]);
  const double left = dot(v, contact.sides[1]);
  if (right <= 0.0 && left <= 0.0) return {};
  return right > left ? contact.sides[0] * right : contact.sides[1] * left;
}

}  // namespace dartcast
