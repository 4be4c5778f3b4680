// The surfaces that bodies carry, as solids: their edges and triangles meet walls.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "bodies/carried_surface.hpp"
#include "dartcast/solids.hpp"

namespace dartcast {

/// A set of solids that can be copied. Empty if no body has a surface.
struct BodySurfaces {
  std::unique_ptr<SolidSet> set;

  BodySurfaces() = default;
  BodySurfaces(const BodySurfaces& other);
  BodySurfaces(BodySurfaces&&) = default;
  BodySurfaces& operator=(const BodySurfaces&) = delete;
  BodySurfaces& operator=(BodySurfaces&&) = default;
  ~BodySurfaces() = default;
};

/// A contact of a surface, as a condition on the particles that carry it: normal . sum weight (x - least) >= 0.
struct SurfaceRow {
  Vec3 normal;
  Vec3 least;  ///< where the place on the surface is, at the wall; less the part of particles that cannot move
  double friction = 0.0;                                  ///< Coulomb's coefficient of the wall
  double mobility = 0.0;                                  ///< sum of weight^2 times inverse mass
  std::vector<std::pair<std::uint32_t, double>> weights;  ///< of particles, by number; those that can move
};

/// Displaces the particles of these rows so that they hold, each by its inverse mass. In sweeps: not all may hold.
void correct_positions(std::span<const SurfaceRow> rows, std::span<const double> masses, std::span<Vec3> positions);

/// Takes out the velocities with which the places of these rows approach the walls, and the share of those along them that
/// friction takes. The kinetic energy does not grow: each change is the projection of least energy, or less of it.
void stop_approach(std::span<const SurfaceRow> rows, std::span<const double> masses, std::span<Vec3> velocities);

}  // namespace dartcast
