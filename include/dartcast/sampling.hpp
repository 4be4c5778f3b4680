// Points sampled from a surface, on it and in it, about evenly: the particles of a body.
//
// Random candidates, one in each piece of a fine division, are taken in random order, each unless a sample is nearer
// than the spacing ("dart throwing": R. L. Cook, "Stochastic sampling in computer graphics", 1986; on meshes: D. Cline,
// S. Jeschke, K. White, A. Razdan, P. Wonka, "Dart throwing on surfaces", 2009). Because every piece has a candidate,
// what is left between the samples is bounded, too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// Lengths in the surface's unit.
struct SamplingOptions {
  double spacing = 0.0;            ///< > 0: no two samples are nearer to each other
  std::uint64_t seed = 1;          ///< the same samples for the same seed, surface and spacing
  std::size_t max_count = 100000;  ///< samples that the caller is ready for
};

/// How far a point may be from the nearest sample, in spacings: a point of the surface; a point inside that is deeper
/// under the surface than `cell_diagonal`; any point inside, where samples are taken on the surface, too. Each is 1,
/// the size of the pieces that hold a candidate each, and a hundredth or less for rounding.
inline constexpr double surface_cover = 1.26;
inline constexpr double cell_diagonal = 0.8661;  // of candidates' cubes, of half a spacing: sqrt(3) / 2
inline constexpr double volume_cover = 1.8661;
inline constexpr double solid_cover = 2.1261;

/// Samples on a surface, closed or open; at least one. Throws InvalidArgument where the spacing is not positive and
/// finite, or below 2^-30 of the largest coordinate (samples would be rounding), or where it would take more than
/// `max_count` samples (or 200 candidates for each of these), saying what spacing may do; InvalidMesh as
/// surface_triangles(). Cost: 64 to 128 candidates per spacing^2 of area, one per triangle at least.
std::vector<Vec3> sample_surface(const MeshData& surface, const SamplingOptions& options);

/// Samples strictly inside of a closed surface; none where the body is thinner than the spacing, perhaps. Throws as
/// sample_surface(), and InvalidMesh as check_closed(). Cost: 8 candidates per spacing^3 of the surface's box, one
/// exact decision of inside each unless a sample is near.
std::vector<Vec3> sample_volume(const MeshData& surface, const SamplingOptions& options);

/// A whole body: samples on its surface (the first `on_surface`), then inside, none nearer to another than the spacing.
/// Throws and costs as both.
struct SolidSamples {
  std::vector<Vec3> points;
  std::size_t on_surface = 0;
};
SolidSamples sample_solid(const MeshData& surface, const SamplingOptions& options);

}  // namespace dartcast
