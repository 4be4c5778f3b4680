// Compares four points of a cell with a box at a time. Compiled once for each instruction set.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "base/double4.inl"
#include "dynamics/reached_faces.hpp"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {

std::uint64_t faces_in_reach(const Shape& shape, const std::uint32_t* vertices, const Vec3* before, const Vec3* after,
                             const MovingBox& box) {
  const Vec3x4 low = splat(box.low);
  const Vec3x4 high = splat(box.high);
  const Vec3x4 shift = splat(box.shift);
  const std::uint32_t count = shape.point_count();
  std::array<std::uint64_t, 6> beyond{};  // for each side of the box, a bit for each point
  for (std::uint32_t i = 0; i < count; i += 4) {
    const Index4 at = index4_from(i, count);
    const std::array<std::uint32_t, 4> v = {vertices[at.at[0]], vertices[at.at[1]], vertices[at.at[2]],
                                            vertices[at.at[3]]};
    const Vec3x4 a = load_vec3x4(before[v[0]], before[v[1]], before[v[2]], before[v[3]]);
    const Vec3x4 b = load_vec3x4(after[v[0]], after[v[1]], after[v[2]], after[v[3]]) - shift;
    beyond[0] |= std::uint64_t{lanes_set((a.x < low.x) & (b.x < low.x))} << i;
    beyond[1] |= std::uint64_t{lanes_set((a.y < low.y) & (b.y < low.y))} << i;
    beyond[2] |= std::uint64_t{lanes_set((a.z < low.z) & (b.z < low.z))} << i;
    beyond[3] |= std::uint64_t{lanes_set((a.x > high.x) & (b.x > high.x))} << i;
    beyond[4] |= std::uint64_t{lanes_set((a.y > high.y) & (b.y > high.y))} << i;
    beyond[5] |= std::uint64_t{lanes_set((a.z > high.z) & (b.z > high.z))} << i;
  }
  std::uint64_t reached = 0;
  for (std::uint16_t f = 0; f < shape.face_count(); ++f) {
    const std::uint64_t points = shape.points_of_face(f);
    const bool misses = (points & ~beyond[0]) == 0 || (points & ~beyond[1]) == 0 || (points & ~beyond[2]) == 0 ||
                        (points & ~beyond[3]) == 0 || (points & ~beyond[4]) == 0 || (points & ~beyond[5]) == 0;
    reached |= std::uint64_t{!misses} << f;
  }
  return reached;
}

}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
