// Measures a mesh: its bounds and the edges of its cells.
#include "mesh/mesh_scale.hpp"

#include <algorithm>
#include <vector>

#include "base/parallel.hpp"
#include "mesh/cell_types.hpp"

namespace dartcast {

namespace {

// The sum of a cell's edges is rounded: the same for each part that has the cell.
void add_cell_scale(const MeshData& mesh, std::size_t c, MeshScale& scale) {
  double sum = 0.0;
  for_each_face(mesh, c, [&](std::span<const std::uint32_t> face) {
    const std::size_t sides = face.size() == 2 ? 1 : face.size();
    for (std::size_t k = 0; k < sides; ++k) {
      const std::uint32_t from = face[k];
      const std::uint32_t to = face[(k + 1) % face.size()];
      const Vec3& p = mesh.points[from];
      scale.low = {std::min(scale.low.x, p.x), std::min(scale.low.y, p.y), std::min(scale.low.z, p.z)};
      scale.high = {std::max(scale.high.x, p.x), std::max(scale.high.y, p.y), std::max(scale.high.z, p.z)};
      if (sides > 1 && from > to) continue;  // two faces have it, in opposite directions
      const double length = norm(mesh.points[to] - p);
      scale.smallest_edge = std::min(scale.smallest_edge, length);
      sum += length;
      ++scale.edge_count;
    }
  });
  scale.edges.add(sum);
}

}  // namespace

MeshScale& MeshScale::operator+=(const MeshScale& o) {
  low = {std::min(low.x, o.low.x), std::min(low.y, o.low.y), std::min(low.z, o.low.z)};
  high = {std::max(high.x, o.high.x), std::max(high.y, o.high.y), std::max(high.z, o.high.z)};
  smallest_edge = std::min(smallest_edge, o.smallest_edge);
  edges += o.edges;
  edge_count += o.edge_count;
  return *this;
}

double MeshScale::size() const {
  return edge_count == 0 ? 0.0 : std::max({high.x - low.x, high.y - low.y, high.z - low.z});
}

MeshScale mesh_scale(const MeshData& mesh, Threads threads, std::span<const std::uint32_t> parts, std::uint32_t part) {
  constexpr std::size_t grain = 16384;
  std::vector<MeshScale> chunks(chunk_count(mesh.cell_count(), grain));
  parallel_for(mesh.cell_count(), grain, threads, [&](std::size_t begin, std::size_t end) {
    MeshScale& scale = chunks[begin / grain];
    for (std::size_t c = begin; c < end; ++c) {
      if (parts.empty() || parts[c] == part) add_cell_scale(mesh, c, scale);
    }
  });
  MeshScale all;
  for (const MeshScale& chunk : chunks) all += chunk;
  return all;
}

void scale_mesh(MeshData& mesh, double factor) {
  for (Vec3& x : mesh.points) x *= factor;
  for (PeriodicPair& pair : mesh.periodic) {
    pair.translate *= factor;
    pair.centre *= factor;
  }
}

}  // namespace dartcast
