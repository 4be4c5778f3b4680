// Points at the place of another one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/vec3.hpp"

namespace dartcast {

/// The points that lie, bit by bit but for the sign of 0, where one of a lower number does; ascending. Cost: n log n.
std::vector<std::uint32_t> find_repeated_points(std::span<const Vec3> points);

}  // namespace dartcast
