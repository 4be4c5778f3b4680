// The place of a surface that is nearest to a point.
#pragma once

#include <vector>

#include "dartcast/surface.hpp"
#include "mesh/box_tree.hpp"

namespace dartcast {

struct SurfaceLocation {
  SurfacePlace place;
  double distance = 0.0;
};

/// A tree over the triangles of a surface at one instant: make it again after a move. Cost to make: n log n.
class SurfaceLocator {
 public:
  explicit SurfaceLocator(const Surface& surface);

  /// The nearest place, rounded; of places at equal distances, as doubles, that in the lowest-numbered face of the mesh
  /// and its first triangle. In free faces and blocked ones alike. Throws InvalidArgument where x is not finite or out
  /// of the exact range. Precondition: the surface that it was made for, unmoved. Cost: the triangles whose boxes come
  /// nearer than about twice the distance, times a logarithm.
  [[nodiscard]] SurfaceLocation nearest(const Surface& surface, const Vec3& x) const;

 private:
  std::vector<SimplexId> triangles_;  // by face of the mesh
  BoxTree tree_;
  Box bounds_;
  double start_ = 0.0;  // a first guess at a distance: half the mean size of the triangles
};

/// The place of a triangle that is nearest to x, by the regions of its corners, edges and inside. This work is based on
/// C. Ericson, "Real-time collision detection", 2005, section 5.1.5.
SurfaceLocation nearest_in_triangle(const Surface& surface, SimplexId triangle, const Vec3& x);

}  // namespace dartcast
