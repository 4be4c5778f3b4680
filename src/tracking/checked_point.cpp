// Refuses points that no decision can be made on.
#include "tracking/checked_point.hpp"

#include <fmt/format.h>

#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"

namespace dartcast::detail {

Vec3 checked_point(const Vec3& x, const char* what, std::size_t index, unsigned dimension) {
  if (!in_exact_range(x))
    throw InvalidArgument(
        fmt::format("{} {} is ({}, {}, {}): coordinates must be finite, and at most 2^300 in magnitude", what, index,
                    x.x, x.y, x.z));
  const Vec3 point = flushed(x);
  if (dimension == 2 && point.z != 0.0)
    throw InvalidArgument(fmt::format("{} {} is ({}, {}, {}): in the plane z must be 0", what, index, x.x, x.y, x.z));
  return point;
}

}  // namespace dartcast::detail
