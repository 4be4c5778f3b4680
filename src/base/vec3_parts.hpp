// Parts of vectors. Not installed.
#pragma once

#include <algorithm>
#include <cmath>

#include "dartcast/vec3.hpp"

namespace dartcast {

/// The largest magnitude of a component.
inline double largest_component(const Vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// The part of v in the plane across a unit normal.
inline Vec3 across_normal(const Vec3& v, const Vec3& normal) { return v - normal * dot(v, normal); }

}  // namespace dartcast
