// Periodic pairs of a mesh: their motion, from places that a file says are partners. Not installed.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// A place of patch a, and its partner in b.
using PartnerPlaces = std::array<Vec3, 2>;

/// The translation that takes the first places to the second ones, else the rotation; the names are empty. Nothing if neither
/// does, to 1e-4 of the diagonal of the box around the first places. A rotation needs three places that are not in a line.
std::optional<PeriodicPair> fitted_pair(std::span<const PartnerPlaces> places);

/// The rotation about the line of two planes, each with a point and its unit normal out of the mesh, that takes the first
/// plane to the second. Nothing if they are parallel.
std::optional<PeriodicPair> rotation_between(const Vec3& point_a, const Vec3& normal_a, const Vec3& point_b,
                                             const Vec3& normal_b);

/// Drops the pairs that have one of these patches.
void end_pairs(MeshData& mesh, std::span<const std::string> patches);

}  // namespace dartcast
