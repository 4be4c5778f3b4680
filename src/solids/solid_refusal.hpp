// Whether a solid may be where it is.
#pragma once

#include <span>

#include "dartcast/cell_complex.hpp"
#include "dartcast/solids.hpp"
#include "solids/elements.hpp"

namespace dartcast {

/// Why a solid is refused at these points, with walls as they stand; SolidRefusal::none if it is not, and
/// cell_not_positive if there is no other reason. `cells`: the free
/// cell of each point; invalid if there is none. Cost: some 2 us an element; for closed solids n log n.
SolidPlacement find_refusal(const CellComplex& complex, std::span<const Vec3> points,
                            std::span<const SolidElement> elements, std::span<const Cell> cells);

/// The points of a solid, and its elements with their numbers.
struct SolidShape {
  std::span<const Vec3> points;
  std::span<const SolidElement> elements;
};

/// SolidRefusal::meets_solid and a place of the first if two solids touch, cross or hold one another; else none. Cost: n
/// log n.
SolidPlacement find_overlap(const SolidShape& solid, const SolidShape& other);

}  // namespace dartcast
