// Cells of a map as a mesh again.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/mesh_data.hpp"

namespace dartcast::detail {

/// Writes cells of a map, as they are, into a mesh. Its points are numbered in the order in which they are first named.
class CellsAsMesh {
 public:
  CellsAsMesh(const CombinatorialMap& map, std::span<const Vec3> positions);

  void add(Cell cell);
  /// The number of a vertex among the mesh's points.
  std::uint32_t number(Vertex v);
  [[nodiscard]] const std::vector<Vertex>& vertices() const { return vertices_; }  ///< of each point
  MeshData& mesh() { return mesh_; }

 private:
  static constexpr std::uint32_t none = 0xffffffffU;

  const CombinatorialMap& map_;
  std::span<const Vec3> positions_;
  MeshData mesh_;
  std::vector<Vertex> vertices_;
  std::vector<std::uint32_t> number_;  // of a vertex among the points
  std::vector<std::uint32_t> corners_;
};

}  // namespace dartcast::detail
