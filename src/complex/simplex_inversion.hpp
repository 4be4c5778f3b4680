// When a simplex whose corners move on straight lines first ceases to be positive, and what meets what there.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "complex/simplex.hpp"

namespace dartcast {

/// Times of flattening are multiples of this. Steps of time that are much finer would be lost when positions are
/// rounded.
inline constexpr double inversion_resolution = 0x1p-40;

/// What meets when a simplex becomes flat: the parts of its corners whose convex hulls then have a point in common.
enum class InversionKind : std::uint8_t {
  vertex_face,     ///< a corner and the inside of the opposite facet
  edge_edge,       ///< the insides of two opposite edges
  vertex_edge,     ///< a corner and the inside of an edge
  vertex_vertex,   ///< two corners
  line,            ///< all corners lie on a line, or at one point
  from_the_start,  ///< the simplex is flat or inverted at the time 0
  undecidable      ///< a coordinate is not finite or outside the exact range
};

/// A simplex's first flattening in a step.
struct SimplexInversion {
  /// The volume is positive in [0, safe_time], and first zero in (safe_time, safe_time + inversion_resolution]. It is
  /// 0, and not safe, for the kinds from_the_start and undecidable.
  double safe_time = 0.0;
  InversionKind kind = InversionKind::line;
  std::uint8_t one = 0;    ///< corners that meet the others, bit i for corner i; 0 where all lie on a line
  std::uint8_t other = 0;  ///< not fewer than in `one`

  bool operator==(const SimplexInversion&) const = default;
};

/// The first time in [0, until] at which the volume of the simplex is not positive, its corners going from `before` to
/// `after` on straight lines, a + t (b - a) without rounding; nothing where it stays positive. A volume that touches
/// zero and is positive again counts. Exact: no flattening is missed, none is invented. Precondition: `until` is in
/// [0, 1]; it is rounded down to a multiple of inversion_resolution.
///
/// The kind: a corner is counted to one of the parts where its facet's area, projected along an axis, is proved to keep
/// its sign until the root, that is where it is above 2^-35 of the simplex's extents before and after; else to none. So
/// the kinds from vertex_edge to line mean: this, or too near to it to tell. Coordinates outside the exact range may be
/// found undecidable even where the volume stays positive.
///
/// Cost: about 20 ns where the filter proves the volume positive, some 0.1 us where it must halve the step, 2 to 5 us
/// where exact signs are needed, 20 us where the simplex is flattened.
///
/// The cubic is that of X. Provot, "Collision and self-collision handling in cloth model dedicated to design garments",
/// 1997; its first root is enclosed by exact signs, of its values, its discriminant and Bernstein's coefficients.
std::optional<SimplexInversion> find_inversion(const Corners& before, const Corners& after, double until = 1.0);

}  // namespace dartcast
