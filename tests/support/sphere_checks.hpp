// Scenes with spheres, and the truth about them from all walls of the scene, without a search.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/random.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/response.hpp"
#include "dartcast/spheres.hpp"
#include "dynamics/near_walls.hpp"
#include "support/meshes.hpp"
#include "support/random_vectors.hpp"
#include "support/tier.hpp"

namespace dartcast::test {

/// Walls that reflect with little loss, and walls that let slide.
inline const WallResponses& bouncing() {
  static const WallResponses responses(WallResponse{WallResponseKind::reflect, 0.9, 0.1});
  return responses;
}
inline const WallResponses& sliding() {
  static const WallResponses responses(WallResponse{WallResponseKind::slide, 0.0, 0.0});
  return responses;
}

/// All fan triangles of wall faces, seen from free cells.
inline std::vector<MovingTriangle> all_walls(const CellComplex& complex, bool moving) {
  std::vector<MovingTriangle> walls;
  const auto after = complex.positions();
  const auto before = moving ? complex.previous_positions() : after;
  for (const Cell c : complex.map().cells()) {
    const CellView cell = complex.map().view(c);
    if (!cell.is_free()) continue;
    for (std::uint16_t f = 0; f < cell.shape().face_count(); ++f) {
      if (!cell.is_wall(f)) continue;
      for (std::uint16_t t = 0; t < cell.shape().triangle_count(f); ++t) {
        const auto local = cell.shape().triangle(f, t);
        MovingTriangle& wall = walls.emplace_back();
        for (unsigned i = 0; i < 3; ++i) {
          wall.from[i] = before[cell.vertex(local[i]).value];
          wall.to[i] = after[cell.vertex(local[i]).value];
        }
      }
    }
  }
  return walls;
}

/// From x to the nearest wall.
inline double clearance(std::span<const MovingTriangle> walls, const Vec3& x) {
  double least = std::numeric_limits<double>::infinity();
  for (const MovingTriangle& w : walls) least = std::min(least, nearest_on_triangle(w.to, x).distance);
  return least;
}

inline double slack_of(const Vec3& x, double radius) {
  return touching_bound * (radius + std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)}));
}

/// The first touch of any wall.
inline std::optional<double> first_of_all(std::span<const MovingTriangle> walls, const MovingSphere& sphere) {
  std::optional<double> first;
  for (const MovingTriangle& w : walls) {
    const auto touch = first_touch(sphere, w, slack_of(sphere.from, sphere.radius));
    if (touch && (!first || touch->time < *first)) first = touch->time;
  }
  return first;
}

/// An environment with spheres in it.
struct Swarm {
  explicit Swarm(MeshData mesh, std::uint64_t seed = 1, Threads threads = {1})
      : environment(std::move(mesh), threads), random(seed) {}

  bool add(const Vec3& x, double radius, const Vec3& velocity = {}) {
    const auto added = environment.add(particles, std::vector<Vec3>{x});
    if (added[0].location.place != Place::free) return false;
    radii.push_back(radius);
    velocities.push_back(velocity);
    statuses.push_back(ParticleStatus::alive);
    return true;
  }
  /// At random places where there is room; fewer where none is found.
  void fill(std::size_t count, double radius, const Vec3& low, const Vec3& high, double speed) {
    const auto walls = all_walls(environment.complex(), false);
    const std::size_t end = radii.size() + count;
    for (std::size_t k = 0; k < 50 * count && radii.size() < end; ++k) {
      const Vec3 x = {random.uniform(low.x, high.x), random.uniform(low.y, high.y), random.uniform(low.z, high.z)};
      if (clearance(walls, x) <= radius) continue;
      add(x, radius, vector(speed));
    }
  }
  Vec3 vector(double size) { return random_vector(random, size); }
  /// By the velocities, and the wall's response to them.
  SphereReport step(const WallResponses& responses, double dt = 1.0) {
    targets.clear();
    for (std::size_t i = 0; i < radii.size(); ++i) targets.push_back(particles[i].position + velocities[i] * dt);
    return stepper.advance(environment, particles, radii, targets, respond_with(responses, velocities, statuses, dt));
  }
  /// Every centre is where its state says.
  void expect_valid() const {
    const Audit audit = dartcast::audit(environment.complex(), particles, Threads{1});
    EXPECT_EQ(audit.failed, 0U) << audit.first;
  }

  Environment environment;
  Random random;
  Particles particles;
  std::vector<double> radii;
  std::vector<Vec3> velocities;
  std::vector<ParticleStatus> statuses;
  std::vector<Vec3> targets;
  SphereStepper stepper;
};

}  // namespace dartcast::test
