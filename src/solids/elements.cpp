// Each corner and each side gets the first element that has it as its owner. Then the elements are sorted in halves: those
// on either side of the median along the longest extent, and so on.
#include "solids/elements.hpp"

#include <algorithm>
#include <cstddef>
#include <set>
#include <span>
#include <utility>

namespace dartcast {

namespace {

class Owners {
 public:
  explicit Owners(std::size_t points) : owned_(points, 0) {}

  void add(SolidElement e, std::vector<SolidElement>& elements) {
    std::array<std::uint32_t, 3> key = e.vertex;
    std::sort(key.begin(), key.begin() + e.count);
    if (e.count == 3 && !triangles_.insert(key).second) return;
    for (unsigned i = 0; i < e.count; ++i) {
      if (!owned_[e.vertex[i]]) e.own_corners |= static_cast<std::uint8_t>(1U << i);
      owned_[e.vertex[i]] = 1;
    }
    for (unsigned i = 0; i < side_count(e); ++i) {
      const auto [a, b] = std::minmax(e.vertex[i], e.vertex[(i + 1) % e.count]);
      if (sides_.insert({a, b}).second) e.own_sides |= static_cast<std::uint8_t>(1U << i);
    }
    if (e.count != 2 || e.own_sides != 0) elements.push_back(e);
  }
  [[nodiscard]] bool owned(std::uint32_t point) const { return owned_[point] != 0; }

 private:
  std::vector<std::uint8_t> owned_;
  std::set<std::array<std::uint32_t, 2>> sides_;
  std::set<std::array<std::uint32_t, 3>> triangles_;
};

Vec3 middle_of(const SolidElement& e, std::span<const Vec3> points) {
  Vec3 sum;
  for (unsigned i = 0; i < e.count; ++i) sum += points[e.vertex[i]];
  return sum * (1.0 / e.count);
}

void sort_in_halves(std::span<SolidElement> elements, std::span<const Vec3> points) {
  constexpr std::size_t group = elements_in_group;
  constexpr std::size_t too_small = 8;
  if (elements.size() <= too_small) return;
  Vec3 low = middle_of(elements[0], points);
  Vec3 high = low;
  for (const SolidElement& e : elements) {
    const Vec3 m = middle_of(e, points);
    low = {std::min(low.x, m.x), std::min(low.y, m.y), std::min(low.z, m.z)};
    high = {std::max(high.x, m.x), std::max(high.y, m.y), std::max(high.z, m.z)};
  }
  const Vec3 size = high - low;
  const bool along_x = size.x >= size.y && size.x >= size.z;
  const bool along_y = !along_x && size.y >= size.z;
  const auto key = [&](const SolidElement& e) {
    const Vec3 m = middle_of(e, points);
    return std::pair(along_x ? m.x : along_y ? m.y : m.z, e.vertex);
  };
  const std::size_t middle = elements.size() / 2;
  const std::size_t half = elements.size() > group ? std::max(group, middle / group * group) : middle;  // whole groups
  std::nth_element(elements.begin(), elements.begin() + static_cast<std::ptrdiff_t>(half), elements.end(),
                   [&](const SolidElement& a, const SolidElement& b) { return key(a) < key(b); });
  sort_in_halves(elements.first(half), points);
  sort_in_halves(elements.subspan(half), points);
}

}  // namespace

std::vector<SolidElement> elements_of(const SolidMesh& mesh) {
  std::vector<SolidElement> elements;
  Owners owners(mesh.points.size());
  for (const auto& t : mesh.triangles) owners.add({t, 3}, elements);
  for (const auto& e : mesh.edges) owners.add({{e[0], e[1], e[1]}, 2}, elements);
  for (std::uint32_t p = 0; p < mesh.points.size(); ++p) {
    if (!owners.owned(p)) owners.add({{p, p, p}, 1}, elements);
  }
  sort_in_halves(elements, mesh.points);
  return elements;
}

}  // namespace dartcast
