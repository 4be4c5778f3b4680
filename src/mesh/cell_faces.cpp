// Recognises the type of a cell by its faces.
#include "mesh/cell_faces.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "mesh/cell_types.hpp"

namespace dartcast {
namespace {

constexpr std::uint32_t no_corner_after = std::numeric_limits<std::uint32_t>::max();

/// The type that has as many triangles and quadrilaterals; a polyhedron if there is none.
CellType type_by_counts(const CellFaces& faces) {
  std::size_t triangles = 0;
  std::size_t quadrilaterals = 0;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    triangles += faces[i].size() == 3 ? 1 : 0;
    quadrilaterals += faces[i].size() == 4 ? 1 : 0;
  }
  if (triangles + quadrilaterals != faces.size()) return CellType::polyhedron;
  const std::array counts = {triangles, quadrilaterals};
  if (counts == std::array<std::size_t, 2>{4, 0}) return CellType::tetrahedron;
  if (counts == std::array<std::size_t, 2>{0, 6}) return CellType::hexahedron;
  if (counts == std::array<std::size_t, 2>{2, 3}) return CellType::prism;
  if (counts == std::array<std::size_t, 2>{4, 1}) return CellType::pyramid;
  return CellType::polyhedron;
}

bool same_cycle(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
  if (a.size() != b.size()) return false;
  const auto start = std::find(b.begin(), b.end(), a[0]);
  const auto shift = static_cast<std::size_t>(start - b.begin());
  for (std::size_t k = 0; k < a.size() && start != b.end(); ++k) {
    if (a[k] != b[(k + shift) % b.size()]) return false;
  }
  return start != b.end();
}

/// The corner that comes `steps` after the edge from a to b in the face that has it; none if no face has it.
std::uint32_t after_edge(const CellFaces& faces, std::uint32_t a, std::uint32_t b, std::size_t steps) {
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto face = faces[i];
    for (std::size_t k = 0; k < face.size(); ++k) {
      if (face[k] == a && face[(k + 1) % face.size()] == b) return face[(k + 1 + steps) % face.size()];
    }
  }
  return no_corner_after;
}

/// The corners of a standard cell in the order of MeshData: the base from the first face of its size, then the points
/// above. None if the faces are not those of such a cell.
std::optional<std::array<std::uint32_t, 8>> standard_corners(const CellFaces& faces, CellType type) {
  const std::size_t n = corner_count(type);
  const std::size_t in_base = type == CellType::tetrahedron || type == CellType::prism ? 3 : 4;
  std::size_t base = 0;
  while (faces[base].size() != in_base) ++base;
  std::array<std::uint32_t, 8> corners{};
  std::copy(faces[base].rbegin(), faces[base].rend(), corners.begin());  // as seen from inside
  for (std::size_t k = in_base; k < n; ++k) {
    // Beside the base's edge from corner i to the next one: the next one's point above, then corner i's.
    const std::size_t i = k - in_base;
    const bool apex = n == in_base + 1;
    corners[k] = after_edge(faces, corners[i], corners[(i + 1) % in_base], apex ? 1 : 2);
  }
  const auto wanted = standard_faces(type);
  for (const auto& numbers : wanted) {
    std::array<std::uint32_t, 4> face{};
    for (std::size_t k = 0; k < numbers.size(); ++k) face[k] = corners[numbers[k]];
    const std::span<const std::uint32_t> used(face.data(), numbers.size());
    bool found = false;
    for (std::size_t i = 0; i < faces.size() && !found; ++i) found = same_cycle(used, faces[i]);
    if (!found) return std::nullopt;
  }
  return corners;
}

}  // namespace

void add_cell(const CellFaces& faces, MeshData& mesh) {
  const CellType type = type_by_counts(faces);
  if (type != CellType::polyhedron) {
    if (const auto corners = standard_corners(faces, type)) {
      mesh.add_cell(type, std::span(corners->data(), corner_count(type)));
      return;
    }
  }
  std::vector<std::uint32_t> stream = {static_cast<std::uint32_t>(faces.size())};
  for (std::size_t i = 0; i < faces.size(); ++i) {
    stream.push_back(static_cast<std::uint32_t>(faces[i].size()));
    stream.insert(stream.end(), faces[i].begin(), faces[i].end());
  }
  mesh.add_cell(CellType::polyhedron, stream);
}

}  // namespace dartcast
