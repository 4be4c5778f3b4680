// Random vectors.
#pragma once

#include "base/random.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast::test {

/// Uniform in the cube [-size, size]^3.
inline Vec3 random_vector(Random& random, double size = 1.0) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

}  // namespace dartcast::test
