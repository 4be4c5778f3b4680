// The filter of a point and a triangle that both move, for four pairs at a time. Compiled once for each instruction set.
// predicates/moving_pair.cpp has its bound.
#pragma once

#include <array>
#include <cstddef>

#include "base/double4.inl"
#include "dartcast/predicates.hpp"
#include "dynamics/moving_walls.hpp"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

inline Double4 flushed4(const Double4& x) { return choose(magnitude(x) < splat(smallest_magnitude), splat(0.0), x); }
inline Vec3x4 flushed4(const Vec3x4& v) { return {flushed4(v.x), flushed4(v.y), flushed4(v.z)}; }

// A bit for each pair that is proved apart: the volume has one sign.
unsigned apart4(const std::array<const WayAndWall*, 4>& pairs, const ParticleState* states, const Vec3* targets,
                const Vec3* before, const Vec3* after) {
  const auto ways = [&](const auto& at) { return load_vec3x4(at(0), at(1), at(2), at(3)); };
  const Vec3x4 p = ways([&](int i) -> const Vec3& { return states[pairs[i]->way].position; });
  const Vec3x4 q = ways([&](int i) -> const Vec3& { return targets[pairs[i]->way]; });
  Vec3x4 from[3];
  Vec3x4 to[3];
  Vec3x4 largest = {};
  for (int k = 0; k < 3; ++k) {
    from[k] = flushed4(ways([&](int i) -> const Vec3& { return before[pairs[i]->corners[k]]; })) - p;
    to[k] = flushed4(ways([&](int i) -> const Vec3& { return after[pairs[i]->corners[k]]; })) - q;
    largest = larger(largest, larger(magnitude(from[k]), magnitude(to[k])));
  }
  const Vec3x4 n0 = cross(from[1], from[2]);
  const Vec3x4 n1 = cross(from[1], to[2]) + cross(to[1], from[2]);
  const Vec3x4 n2 = cross(to[1], to[2]);
  const Double4 c0 = dot(from[0], n0);
  const Double4 c1 = dot(to[0], n0) + dot(from[0], n1);
  const Double4 c2 = dot(from[0], n2) + dot(to[0], n1);
  const Double4 c3 = dot(to[0], n2);
  const Double4 volume = largest.x * largest.y * largest.z;
  const Double4 bound = 180 * (0x1p-53 * (1 + 0x1p-10)) * volume;
  const Double4 minor = smaller(smaller(largest.y * largest.z, largest.z * largest.x), largest.x * largest.y);
  // Written so that what is no number proves nothing.
  const Mask4 in_range = (detail::DARTCAST_SIMD::largest(largest) < splat(0x1p300)) & (volume > splat(0x1p-700)) &
                         (minor > splat(0x1p-900));
  const Mask4 before_it = (c0 > bound) & (c1 > bound) & (c2 > bound) & (c3 > bound);
  const Mask4 behind_it = (c0 < -bound) & (c1 < -bound) & (c2 < -bound) & (c3 < -bound);
  return lanes_set(in_range & (before_it | behind_it));
}

}  // namespace

std::size_t undecided_pairs(std::span<WayAndWall> pairs, const ParticleState* states, const Vec3* targets,
                            const Vec3* before, const Vec3* after) {
  std::size_t kept = 0;
  const auto count = static_cast<std::uint32_t>(pairs.size());
  for (std::uint32_t i = 0; i < count; i += 4) {
    const Index4 at = index4_from(i, count);
    const unsigned apart = apart4({&pairs[at.at[0]], &pairs[at.at[1]], &pairs[at.at[2]], &pairs[at.at[3]]}, states,
                                  targets, before, after);
    for (std::uint32_t k = i; k < std::min(i + 4, count); ++k) {
      if (((apart >> (k - i)) & 1U) == 0) pairs[kept++] = pairs[k];
    }
  }
  return kept;
}

}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
