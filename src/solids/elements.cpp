// Each corner and each side gets the first element that has it as its owner.
#include "solids/elements.hpp"

#include <algorithm>
#include <set>

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

}  // namespace

std::vector<SolidElement> elements_of(const SolidMesh& mesh) {
  std::vector<SolidElement> elements;
  Owners owners(mesh.points.size());
  for (const auto& t : mesh.triangles) owners.add({t, 3}, elements);
  for (const auto& e : mesh.edges) owners.add({{e[0], e[1], e[1]}, 2}, elements);
  for (std::uint32_t p = 0; p < mesh.points.size(); ++p) {
    if (!owners.owned(p)) owners.add({{p, p, p}, 1}, elements);
  }
  return elements;
}

}  // namespace dartcast
