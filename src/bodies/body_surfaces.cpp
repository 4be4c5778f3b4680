// Contacts of surfaces, answered by the particles that carry them. One row after the other, in sweeps (Gauss-Seidel).
#include "bodies/body_surfaces.hpp"

#include <algorithm>

#include "solids/joint_move.hpp"

namespace dartcast {

namespace {

constexpr int sweeps = 10;

Vec3 place_of(const SurfaceRow& row, std::span<const Vec3> values) {
  Vec3 sum;
  for (const auto& [p, weight] : row.weights) sum += values[p] * weight;
  return sum;
}

// Changes the values so that the value at the row's place changes by `change`, if any particle can move.
void change_place(const SurfaceRow& row, std::span<const double> masses, const Vec3& change, std::span<Vec3> values) {
  if (!(row.mobility > 0.0)) return;
  for (const auto& [p, weight] : row.weights) values[p] += change * (weight / (masses[p] * row.mobility));
}

}  // namespace

BodySurfaces::BodySurfaces(const BodySurfaces& other) : set(other.set ? JointMoves::copy(*other.set) : nullptr) {}

void correct_positions(std::span<const SurfaceRow> rows, std::span<const double> masses, std::span<Vec3> positions) {
  for (int i = 0; i < sweeps; ++i) {
    for (const SurfaceRow& row : rows) {
      const double lack = dot(row.normal, row.least - place_of(row, positions));
      if (lack > 0.0) change_place(row, masses, row.normal * lack, positions);
    }
  }
}

void stop_approach(std::span<const SurfaceRow> rows, std::span<const double> masses, std::span<Vec3> velocities) {
  for (int i = 0; i < sweeps; ++i) {
    for (const SurfaceRow& row : rows) {
      const Vec3 velocity = place_of(row, velocities);
      const double approach = -dot(row.normal, velocity);
      if (!(approach > 0.0)) continue;
      const Vec3 along = velocity + row.normal * approach;
      const double speed = norm(along);
      const double braked = speed > 0.0 ? std::min(1.0, row.friction * approach / speed) : 0.0;
      change_place(row, masses, row.normal * approach - along * braked, velocities);
    }
  }
}

}  // namespace dartcast
