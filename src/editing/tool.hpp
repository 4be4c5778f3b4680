// Bodies to cut with: convex ones, as the planes that bound them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "editing/section.hpp"

namespace dartcast {

/// The points below all of its planes.
struct ConvexTool {
  std::vector<Plane> planes;
  double finest = std::numeric_limits<double>::infinity();  ///< its least width (m): see SectionOptions
};

/// A flat disc, taken as the regular polygon in its circle.
struct Disc {
  Vec3 centre;
  Vec3 normal = {0.0, 0.0, 1.0};  ///< of any length
  double radius = 1.0;            ///< m
  std::uint32_t sides = 24;
};

/// What a straight blade sweeps: its two ends, place after place.
struct BladePath {
  std::vector<std::array<Vec3, 2>> places;
};

// What is at most width / 2 from a surface, up to corners. These throw InvalidArgument where a number is not finite, a
// width or radius is not positive, or as they say.

std::vector<ConvexTool> thicken(const Plane& plane, double width);
/// Throws where there are not 3 to 1000 sides.
std::vector<ConvexTool> thicken(const Disc& disc, double width);
/// One tool for what the blade sweeps between two places, or two where that is not flat, joined along planes that
/// halve the angles between them. Throws where there are not two places, the blade has no length or
/// does not move, or turns back onto itself.
std::vector<ConvexTool> thicken(const BladePath& path, double width);

/// An upright box. Throws InvalidArgument where it is empty or not finite.
ConvexTool box_tool(const Vec3& low, const Vec3& high);
/// The ends of a rod with a round head and foot, or of a ball (where a is b), as 26 planes that touch it: it holds all
/// of the capsule, and reaches at most 1.13 radii from the line between a and b. Throws as above.
ConvexTool capsule_tool(const Vec3& a, const Vec3& b, double radius);

/// The cells of the complex that no plane of a tool has on its outside: all that the tools meet, and perhaps some near
/// their edges. In the order of CombinatorialMap::cells(). Cost: one pass over the scene.
std::vector<Cell> cells_near(const CellComplex& complex, std::span<const ConvexTool> tools);
/// The same, of the cells that are reached from `start` through such cells. Throws InvalidArgument where there is no
/// such cell; empty where it is none of them. Cost: that of the cells returned and their neighbours.
std::vector<Cell> cells_near(const CellComplex& complex, std::span<const ConvexTool> tools, Cell start);

}  // namespace dartcast
