// Fits the motion of a periodic pair: a translation if it does, else a rotation about a line with a way along it.
#include "mesh/periodic_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/elementary.hpp"

namespace dartcast {

namespace {

// Files often have six digits, and each rounding of a corner may count twice. It only chooses partners.
constexpr double fit_tolerance = 1e-4;
// Angles are whole multiples of this many degrees, so that a quarter turn is exact. The step is far below the tolerance.
constexpr double angle_step = 0x1p-30;

using Rows = std::array<Vec3, 3>;

Vec3 times(const Rows& rows, const Vec3& v) { return {dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)}; }

double length(const Vec3& v) { return hypotenuse(v.x, v.y, v.z); }

double rounded_degrees(double sine, double cosine) {
  return std::round(polar_angle(sine, cosine) * (180.0 / std::numbers::pi) / angle_step) * angle_step;
}

// About the line through a point, with a way along it.
PeriodicPair rotation(const Vec3& axis, const Vec3& centre, double degrees, const Vec3& along) {
  PeriodicPair pair;
  pair.translate = along;
  pair.axis = axis;
  pair.centre = centre;
  pair.angle = degrees;
  pair.tolerance = fit_tolerance;
  return pair;
}

// The item for which a measure is largest.
template <class Measure>
std::size_t farthest(std::span<const PartnerPlaces> places, Measure&& measure) {
  const auto less = [&](const PartnerPlaces& p, const PartnerPlaces& q) { return measure(p[0]) < measure(q[0]); };
  return static_cast<std::size_t>(std::max_element(places.begin(), places.end(), less) - places.begin());
}

// Three unit vectors at right angles: along p to q, and in the plane of all three.
Rows frame(const Vec3& p, const Vec3& q, const Vec3& r) {
  const Vec3 first = (q - p) * (1.0 / length(q - p));
  const Vec3 third = cross(first, r - p);
  const Vec3 up = third * (1.0 / length(third));
  return {first, cross(up, first), up};
}

// Takes the frame of three places to that of their partners.
Rows turn_of(std::span<const PartnerPlaces> places, const Vec3& origin) {
  const std::size_t i = farthest(places, [&](const Vec3& x) { return length(x - origin); });
  const Vec3 side = places[i][0] - origin;
  const std::size_t j = farthest(places, [&](const Vec3& x) { return length(cross(side, x - origin)); });
  const Rows a = frame(places[0][0], places[i][0], places[j][0]);
  const Rows b = frame(places[0][1], places[i][1], places[j][1]);
  Rows turn{};
  for (unsigned k = 0; k < 3; ++k) {
    turn[0] += a[k] * b[k].x;
    turn[1] += a[k] * b[k].y;
    turn[2] += a[k] * b[k].z;
  }
  return turn;
}

std::optional<PeriodicPair> fitted_rotation(std::span<const PartnerPlaces> places, double tolerance) {
  const auto& [x0, y0] = places[0];
  const Rows turn = turn_of(places, x0);
  for (const auto& [x, y] : places) {
    if (!(length(times(turn, x - x0) + y0 - y) <= tolerance)) return {};
  }
  const Vec3 twice_sine = {turn[2].y - turn[1].z, turn[0].z - turn[2].x, turn[1].x - turn[0].y};
  const double sine = 0.5 * length(twice_sine);
  if (!(sine > 0.0)) return {};  // half a turn: which line it is about is lost in rounding
  const double cosine = 0.5 * (turn[0].x + turn[1].y + turn[2].z - 1.0);
  const Vec3 axis = twice_sine * (0.5 / sine);
  const Vec3 way = y0 - x0;
  const Vec3 along = axis * dot(axis, way);
  const Vec3 across = way - along;
  // The middle between both places, and from there at a right angle to the way.
  const Vec3 middle = (x0 + y0 - along) * 0.5;
  const Vec3 centre = middle + cross(axis, across) * (0.5 * (1.0 + cosine) / sine);
  return rotation(axis, centre, rounded_degrees(sine, cosine), along);
}

}  // namespace

std::optional<PeriodicPair> fitted_pair(std::span<const PartnerPlaces> places) {
  if (places.empty()) return {};
  Vec3 low = places[0][0];
  Vec3 high = low;
  Vec3 way;
  for (const auto& [x, y] : places) {
    low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
    way += y - x;
  }
  PeriodicPair pair;
  pair.translate = way * (1.0 / static_cast<double>(places.size()));
  pair.tolerance = fit_tolerance;
  const double tolerance = fit_tolerance * length(high - low);
  const auto fits = [&](const PartnerPlaces& p) { return length(p[0] + pair.translate - p[1]) <= tolerance; };
  if (std::all_of(places.begin(), places.end(), fits)) return pair;
  return fitted_rotation(places, tolerance);
}

std::optional<PeriodicPair> rotation_between(const Vec3& point_a, const Vec3& normal_a, const Vec3& point_b,
                                             const Vec3& normal_b) {
  const Vec3 line = cross(normal_b, normal_a);  // from normal_a to the other way of normal_b
  const double sine = length(line);
  if (!(sine > fit_tolerance)) return {};
  const Vec3 centre =
      (cross(normal_a, line) * dot(normal_b, point_b) + cross(line, normal_b) * dot(normal_a, point_a)) *
      (1.0 / (sine * sine));
  return rotation(line * (1.0 / sine), centre, rounded_degrees(sine, -dot(normal_a, normal_b)), {});
}

void end_pairs(MeshData& mesh, std::span<const std::string> patches) {
  const auto is_one = [&](const std::string& name) {
    return std::find(patches.begin(), patches.end(), name) != patches.end();
  };
  std::erase_if(mesh.periodic, [&](const PeriodicPair& pair) { return is_one(pair.a) || is_one(pair.b); });
}

}  // namespace dartcast
