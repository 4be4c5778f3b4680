// Through a face of a periodic pair to its partner.
//
// The walk decides on the side that it leaves whether it passes, exactly. The partner gets the face, and
// the place in it by the weights of its corners. So the partner's corners may be rounded, and no particle is lost.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "complex/periodic_faces.hpp"
#include "tracking/contact_geometry.hpp"

namespace dartcast::detail {

/// Where a particle enters: a triangle of the partner, the simplex behind it, and images of the place and the target.
template <std::size_t N>
struct PeriodicEntry {
  SimplexId simplex;
  std::uint16_t facet = 0;  ///< of the simplex: the triangle
  std::array<Vec3, N> corners;
  WallPlane plane;
  double fraction;  ///< of the segment, where it passes the face
  Vec3 point;       ///< rounded: it may be off the triangle
  Vec3 target;

  /// The point of the triangle next to `point`, rounded.
  [[nodiscard]] Vec3 on_plane() const {
    const std::array<double, N - 1> weight = weights_in(corners, plane, point);
    double sum = 0.0;
    Vec3 x;
    for (unsigned i = 0; i < N - 1; ++i) {
      sum += weight[i];
      x += corners[facet_corner<N>(facet, i)] * weight[i];
    }
    return sum > 0.0 ? x * (1.0 / sum) : plane.a;
  }
  /// Whether the point is strictly inside the triangle, as seen along the triangle's normal.
  [[nodiscard]] bool is_over() const {
    const std::array<double, N - 1> weight = weights_in(corners, plane, point);
    return std::all_of(weight.begin(), weight.end(), [](double w) { return w > 0.0; });
  }
};

/// `impact`: if a batch has computed it. `w`, from p to q, passes the face that leads to the partner.
template <class Positions, std::size_t N>
PeriodicEntry<N> periodic_entry(const Space<Positions, N>& space, const PeriodicFaces& pairs, const PeriodicPartner& to,
                                const Walk& w, const Vec3& p, const Vec3& q, const WallImpact* impact = nullptr);

/// Decides what a walk that has ended at a wall meets, and changes its end to that:
///  - If it ends on a periodic face, it has arrived, unless q lies on a wall, too.
///  - If it starts on a wall that it meets, it passes a periodic face that holds p, if it can start there (way_round()).
/// Returns the partner of the face that it passes; null if it meets a wall, or has arrived.
template <class Positions, std::size_t N>
const PeriodicPartner* periodic_end(const Space<Positions, N>& space, const PeriodicFaces& pairs, Walk& w,
                                    const Vec3& p, const Vec3& q);

}  // namespace dartcast::detail
