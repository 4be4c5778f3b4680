// Tetrahedra around closed surfaces: made by another program, and then checked.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "dartcast/mesh_data.hpp"
#include "dartcast/scene.hpp"
#include "meshing/closed_surfaces.hpp"

namespace dartcast {

/// The corners of the box around all surfaces: low and high.
struct OuterBox {
  Vec3 low, high;
};
OuterBox outer_box(const ClosedSurfaces& surfaces, double factor);

/// The tetrahedra that a program has made. Point i of the surfaces is point i here, bit by bit.
struct Tetrahedra {
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 4>> cells;
};

/// Throws Error with the reason if a program is missing, fails, takes too long, or does not keep the points.
Tetrahedra run_tetgen(const ClosedSurfaces& surfaces, const SurfaceScene& scene, std::uint64_t memory);
Tetrahedra run_gmsh(const ClosedSurfaces& surfaces, const SurfaceScene& scene, std::uint64_t memory);

/// The mesh with regions, patches and free cells. A region follows from the triangles that lie between it and the box.
/// Throws Error if a triangle is not a face of two tetrahedra, the surface leaks, a region is missing, or a volume
/// differs.
MeshData mesh_with_regions(const ClosedSurfaces& surfaces, const SurfaceScene& scene, Tetrahedra tetrahedra);

}  // namespace dartcast
