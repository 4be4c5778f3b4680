// Checks only what depends on the places of points: their range and how cells are oriented.
#include "mesh/same_cells.hpp"

#include <algorithm>

#include "dartcast/predicates.hpp"
#include "mesh/orientation.hpp"

namespace dartcast {

bool stays_valid(const MeshData& mesh, std::span<const Vec3> points) {
  const bool plane = mesh.dimension() == 2;
  const auto fits = [&](const Vec3& x) { return in_exact_range(x) && (!plane || x.z == 0.0); };
  if (!std::all_of(points.begin(), points.end(), fits)) return false;
  MeshData moved;
  moved.points.assign(points.begin(), points.end());
  moved.types = mesh.types;
  moved.connectivity = mesh.connectivity;
  moved.offsets = mesh.offsets;
  for (std::size_t c = 0; c < moved.cell_count(); ++c) {
    if (orient_cell(moved, c) != Orientation::positive) return false;
  }
  return true;
}

}  // namespace dartcast
