// The first triangles of many steps in the plane, four in a vector, compiled for each instruction set. Not installed.
#pragma once

#include <array>
#include <cstdint>

#include "tracking/batch/batch.hpp"

namespace dartcast::detail {

/// Steps in one call, at most.
inline constexpr std::uint32_t plane_block = 32;

/// A bit for each of so many steps.
constexpr std::uint32_t all_of(std::uint32_t count) {
  return count == plane_block ? ~std::uint32_t{0} : (std::uint32_t{1} << count) - 1;
}

/// The answers of the first triangles of some steps in a row: in each set a bit for each step.
struct PlaneBlock {
  std::uint32_t deferred = 0;  ///< held, or at rest; or, among moving vertices, not proved to need no splitting
  std::uint32_t inside = 0;    ///< of the others, those that touch no wall and whose targets are proved to lie inside
  std::uint32_t decided = 0;   ///< the triangle is proved positive, and the target's side of each facet is proved
  std::array<std::uint8_t, plane_block> behind;  ///< decided: a bit for each facet that the target is behind
  // If vertices move, of steps that are in none of the first two sets:
  std::uint32_t carried_inside =
      0;  ///< the vertices carry the start to a place that is proved inside and is not the target
  std::uint32_t left_behind = 0;                           ///< as Counters::updated_by_deformation means it
  std::array<std::array<double, 2>, plane_block> carried;  ///< that place
};

/// Vertices now and before they moved; in a scene at rest `before` is null.
struct PlaneVertices {
  const Vec3* now;
  const Vec3* before;
};

namespace portable {
PlaneBlock look_at_triangles(const PlaneVertices& vertices, const BatchSteps& steps, std::uint32_t first,
                             std::uint32_t count, double tolerance);
}
namespace avx2 {
PlaneBlock look_at_triangles(const PlaneVertices& vertices, const BatchSteps& steps, std::uint32_t first,
                             std::uint32_t count, double tolerance);
}

}  // namespace dartcast::detail
