// Finds points at the place of another one, by sorting.
#include "mesh/repeated_points.hpp"

#include <algorithm>
#include <cstring>

namespace dartcast {

std::vector<std::uint32_t> find_repeated_points(std::span<const Vec3> points) {
  struct Key {
    std::uint64_t hash;
    std::uint32_t point;
  };
  const auto mix = [](std::uint64_t h, double x) {
    const double positive_zero = x + 0.0;
    std::uint64_t bits = 0;
    std::memcpy(&bits, &positive_zero, sizeof bits);
    h = (h ^ bits) * 0x9e3779b97f4a7c15ULL;
    return h ^ (h >> 29U);
  };
  std::vector<Key> keys(points.size());
  for (std::uint32_t p = 0; p < keys.size(); ++p) {
    const Vec3& x = points[p];
    keys[p] = {mix(mix(mix(0x1234567, x.x), x.y), x.z), p};
  }
  std::sort(keys.begin(), keys.end(), [&](const Key& a, const Key& b) {
    if (a.hash != b.hash) return a.hash < b.hash;
    const Vec3& x = points[a.point];
    const Vec3& y = points[b.point];
    if (x.x != y.x) return x.x < y.x;
    if (x.y != y.y) return x.y < y.y;
    return x.z != y.z ? x.z < y.z : a.point < b.point;
  });
  std::vector<std::uint32_t> repeated;
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (points[keys[i].point] == points[keys[i - 1].point]) repeated.push_back(keys[i].point);
  }
  std::sort(repeated.begin(), repeated.end());
  return repeated;
}

}  // namespace dartcast
