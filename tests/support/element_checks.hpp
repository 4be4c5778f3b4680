// Edges and triangles among walls, and the truth about them from all walls of the scene, without a search.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "dynamics/near_walls.hpp"
#include "support/random_vectors.hpp"
#include "support/sphere_checks.hpp"

namespace dartcast::test {

/// The sides of an element, by its corners.
std::vector<std::array<unsigned, 2>> sides_of(unsigned corners);

/// The first touch of an element and one wall: of every corner, side and face of the one with those of the other.
std::optional<double> first_touch_of(const MovingElement& e, const MovingTriangle& w);

/// Whether the boxes of an element and a wall over the whole step meet.
bool boxes_meet(const MovingElement& e, const MovingTriangle& w);

/// The first touch of any of these walls.
std::optional<double> first_touch_of(const MovingElement& e, std::span<const MovingTriangle> walls);

/// Whether the segment from a to b passes through the inside of a triangle.
bool passes(const Vec3& a, const Vec3& b, const std::array<Vec3, 3>& v);

/// Whether the element meets a wall at the time 0. Two that pass through each other need not touch with a corner or a
/// side.
bool meets_at_start(MovingElement e, std::span<const MovingTriangle> walls);

/// A point, an edge or a triangle at rest around `at`, some `size` long.
MovingElement element_at(Random& random, const Vec3& at, unsigned count, double size);

/// Positions pushed along waves of about eight units.
std::vector<Vec3> waved(std::span<const Vec3> positions, double by, double unit = 1.0);

}  // namespace dartcast::test
