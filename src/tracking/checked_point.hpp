// Points that a caller gives: refused with a message that names them.
#pragma once

#include <cstddef>

#include "dartcast/vec3.hpp"

namespace dartcast::detail {

/// The point as decisions see it (flushed()). Throws InvalidArgument if a coordinate is not finite or out of the exact
/// range, or in the plane if z is not 0. It names the point with `what` and its index.
Vec3 checked_point(const Vec3& x, const char* what, std::size_t index, unsigned dimension);

}  // namespace dartcast::detail
