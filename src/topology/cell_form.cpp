// The standard order of a cell's corners, and the key of its shape.
#include "topology/cell_form.hpp"

#include <algorithm>
#include <vector>

#include "mesh/cell_types.hpp"

namespace dartcast {

namespace {

using Permutation = std::vector<std::uint8_t>;

// All rotations of a standard type onto itself, from two that generate them.
std::vector<Permutation> make_rotations(CellType type) {
  std::vector<Permutation> generators;
  switch (type) {
    case CellType::tetrahedron: generators = {{1, 2, 0, 3}, {1, 0, 3, 2}}; break;
    case CellType::hexahedron: generators = {{1, 2, 3, 0, 5, 6, 7, 4}, {4, 5, 1, 0, 7, 6, 2, 3}}; break;
    case CellType::prism: generators = {{1, 2, 0, 4, 5, 3}, {3, 5, 4, 0, 2, 1}}; break;
    case CellType::pyramid: generators = {{1, 2, 3, 0, 4}}; break;
    case CellType::triangle: generators = {{1, 2, 0}}; break;
    case CellType::quadrilateral: generators = {{1, 2, 3, 0}}; break;
    case CellType::polyhedron:
    case CellType::polygon: return {};
  }
  Permutation identity(corner_count(type));
  for (std::size_t i = 0; i < identity.size(); ++i) identity[i] = static_cast<std::uint8_t>(i);
  std::vector<Permutation> all = {identity};
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (const auto& g : generators) {
      Permutation product(identity.size());
      for (std::size_t k = 0; k < product.size(); ++k) product[k] = all[i][g[k]];
      if (std::find(all.begin(), all.end(), product) == all.end()) all.push_back(product);
    }
  }
  return all;
}

std::span<const Permutation> rotations(CellType type) {
  static const std::array<std::vector<Permutation>, 7> all = {
      make_rotations(CellType::tetrahedron),  make_rotations(CellType::hexahedron), make_rotations(CellType::prism),
      make_rotations(CellType::pyramid),      make_rotations(CellType::polyhedron), make_rotations(CellType::triangle),
      make_rotations(CellType::quadrilateral)};
  return all[static_cast<std::size_t>(type)];
}

}  // namespace

StandardCorners turned(CellType type, std::span<const std::uint32_t> corners) {
  const auto symmetries = rotations(type);
  StandardCorners best{};
  StandardCorners next{};
  for (std::size_t r = 0; r < symmetries.size(); ++r) {
    for (std::size_t i = 0; i < corners.size(); ++i) next[i] = corners[symmetries[r][i]];
    if (r == 0 || next < best) best = next;
  }
  return best;
}

std::uint32_t standard_signature(CellType type, std::span<const std::uint32_t> corners) {
  std::uint32_t signature = static_cast<std::uint32_t>(type);
  if (dimension(type) == 2) return signature;
  for (const auto& face : standard_faces(type)) {
    std::uint32_t lowest = 0;
    for (std::uint32_t k = 1; k < face.size(); ++k) {
      if (corners[face[k]] < corners[face[lowest]]) lowest = k;
    }
    signature = signature * 4 + lowest;
  }
  return signature;
}

ShapeKey standard_key(CellType type, std::span<const std::uint32_t> corners) {
  ShapeKey key;
  key.corner_count = static_cast<std::uint16_t>(corners.size());
  key.apex = lowest_corner(corners);
  for (const auto& face : standard_faces(type)) {
    set_from_lowest(key.faces.emplace_back().corners, std::vector<std::uint16_t>(face.begin(), face.end()), corners);
  }
  return key;
}

void set_from_lowest(std::vector<std::uint16_t>& face, std::span<const std::uint16_t> corners,
                     std::span<const std::uint32_t> vertices) {
  auto first = corners.begin();
  if (corners.size() > 2)
    first = std::min_element(corners.begin(), corners.end(), [&](auto a, auto b) { return vertices[a] < vertices[b]; });
  face.assign(first, corners.end());
  face.insert(face.end(), corners.begin(), first);
}

std::uint16_t lowest_corner(std::span<const std::uint32_t> vertices) {
  return static_cast<std::uint16_t>(std::min_element(vertices.begin(), vertices.end()) - vertices.begin());
}

}  // namespace dartcast
