// A point from which a closed surface is seen from the inside.
#pragma once

#include <optional>
#include <span>

#include "complex/cone_point.hpp"

namespace dartcast::detail {

/// A point strictly behind the planes of all triangles, and about as far from them as possible: the middle of the
/// largest ball. Nothing if none is found. A returned point is correct by exact signs. Its absence is decided in
/// floating point, so a kernel thinner than about 10^-12 of the surface may be missed. Cost: linear in the triangles,
/// some ten to twenty times.
std::optional<Vec3> kernel_point(std::span<const ConeTriangle> triangles);

}  // namespace dartcast::detail
