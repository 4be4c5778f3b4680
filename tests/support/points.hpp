// Lists of points.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "dartcast/vec3.hpp"

namespace dartcast::test {

/// The images of points under a map.
inline std::vector<Vec3> mapped(std::span<const Vec3> points, const std::function<Vec3(const Vec3&)>& map) {
  std::vector<Vec3> images;
  for (const Vec3& p : points) images.push_back(map(p));
  return images;
}

}  // namespace dartcast::test
