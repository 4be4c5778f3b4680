// Exact tests whether a point is inside a closed surface.
#pragma once

#include <cstdint>
#include <vector>

#include "dartcast/vec3.hpp"
#include "surface/triangles.hpp"

namespace dartcast {

enum class PointSide : std::uint8_t { inside, outside, on };

/// The test for one closed surface, by the parity of the triangles above the point. A point that an odd number of
/// layers encloses is inside. So a shell within another is a cavity, for any orientation.
///
/// Every answer comes from exact signs. The upward ray starts at x + (e, e^2, 0) with e infinitesimal: it meets no
/// edge and no corner. If it starts on a triangle, x is on that triangle. (H. Edelsbrunner, E. P. Muecke,
/// "Simulation of simplicity", 1990.)
class InsideTest {
 public:
  /// Throws InvalidMesh as surface_triangles() and check_closed(). Cost: n log n.
  explicit InsideTest(const MeshData& surface);
  /// Preconditions: each edge has an even number of triangles; there are triangles.
  InsideTest(std::vector<Vec3> points, std::vector<SurfaceTriangle> triangles);

  /// Throws InvalidArgument if the point is not finite or outside the exact range. Cost: the triangles whose boxes
  /// the ray meets, times a logarithm.
  [[nodiscard]] PointSide side(const Vec3& point) const;

  [[nodiscard]] const std::vector<SurfaceTriangle>& triangles() const { return triangles_; }

 private:
  std::vector<Vec3> points_;
  std::vector<SurfaceTriangle> triangles_;
  BoxTree tree_;
  double top_ = 0.0;  // the largest z of a point
};

}  // namespace dartcast
