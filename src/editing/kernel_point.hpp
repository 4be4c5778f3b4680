// A point from which a closed surface is seen from the inside.
#pragma once

#include <optional>
#include <span>

#include "complex/cone_point.hpp"

namespace dartcast::detail {

/// A point strictly behind the planes of all triangles, about as far from them as can be: the middle of the largest
/// ball. Nothing where none is found. What is returned is so by exact signs; that there is none is told by floating
/// point, so that a kernel thinner than about 10^-12 of the surface may be missed. Cost: linear in the triangles, some
/// ten to twenty times.
std::optional<Vec3> kernel_point(std::span<const ConeTriangle> triangles);

}  // namespace dartcast::detail
