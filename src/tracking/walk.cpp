// Reports a walk that does not end, with its replay.
#include "tracking/walk.hpp"

#include <fmt/format.h>

namespace dartcast::detail {

void throw_overrun(const CombinatorialMap& map, SimplexId start, const Vec3& p, const Vec3& q) {
  throw InternalError(
      fmt::format("a walk met more simplices than there are: please report this with the scene and this replay: cell = "
                  "{}, simplex = {}, "
                  "p = [{:a}, {:a}, {:a}], q = [{:a}, {:a}, {:a}]",
                  map.source(start.cell), start.simplex, p.x, p.y, p.z, q.x, q.y, q.z));
}

}  // namespace dartcast::detail
