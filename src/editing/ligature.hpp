// Tying a vessel.
#pragma once

#include <span>
#include <vector>

#include "editing/section.hpp"

namespace dartcast {

/// Ties a vessel: blocks the free cells of one cross-section, those that the plane crosses and that hang together with
/// `start` by faces within it. Cells that touch the plane from below count as crossed, so that it always seals: no free
/// cell below the plane is a neighbour of one above there. Returns the cells blocked; freeing them unties it.
///
/// Throws InvalidArgument where `start` is not there, is blocked, or is not crossed. Cost: that of the cells blocked
/// and their neighbours.
std::vector<Cell> ligature(ComplexEdit& edit, const Plane& plane, Cell start);
/// The same at the crossed free cell whose corners' mean is nearest to `place`. Throws InvalidArgument where the plane
/// crosses no free cell. Cost: one pass over the scene besides.
std::vector<Cell> ligature(ComplexEdit& edit, const Plane& plane, const Vec3& place);

struct TyingOptions {
  double share = 0.5;  ///< of the way to the middle of the section that its walls go, in [0, 1)
  double reach = 1.0;  ///< m: the motion fades out at this distance from the plane, and from the section's rim
};

/// Where vertices go when a ligature draws the walls of the vessel together: towards the middle of the section in
/// parallel to the plane, those of the section by `share` of the way, others less, fading out smoothly. For
/// Environment::move_until_inverted(). `section`: cells of the complex, such as ligature() returned; `positions`: some
/// or all of the complex's, changed in place. Throws InvalidArgument where a cell is not there, none is named, or an
/// option is out of range. Cost: linear in the positions.
void draw_together(const CellComplex& complex, std::span<const Cell> section, const Plane& plane,
                   const TyingOptions& options, std::span<Vec3> positions);

}  // namespace dartcast
