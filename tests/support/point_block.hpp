// Points of a body to try.
#pragma once

#include <vector>

#include "dynamics/mat3.hpp"

namespace dartcast::test {

/// A lattice of n x n x n points with this spacing around a centre, turned.
inline std::vector<Vec3> block(int n, double spacing, const Vec3& centre, const Quaternion& turn) {
  const Mat3 m = matrix(normalized(turn));
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      for (int k = 0; k < n; ++k)
        points.push_back(centre + m * (Vec3{i - 0.5 * (n - 1), j - 0.5 * (n - 1), k - 0.5 * (n - 1)} * spacing));
    }
  }
  return points;
}

}  // namespace dartcast::test
