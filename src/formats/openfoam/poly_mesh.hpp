// OpenFOAM's mesh as its files have it: faces with their owners and neighbours, patches and zones.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "dartcast/vec3.hpp"
#include "formats/openfoam/foam_file.hpp"

namespace dartcast {

/// In place of a neighbour or a patch.
inline constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

struct PolyPatch {
  std::string name;
  std::string type;         ///< as "wall", "patch", "empty", "cyclic", "processor"
  std::string neighbour{};  ///< cyclic: the patch that it leads to
  std::string refers{};     ///< processorCyclic: the patch of the whole that its faces are of
};

/// A patch, and its faces, which are consecutive.
struct PolyPatchRange {
  PolyPatch patch;
  std::size_t first = 0;
  std::size_t size = 0;
};

struct PolyZone {
  std::string name;
  std::vector<std::uint32_t> labels;
};

/// The corners of a face are counterclockwise as seen from outside its owner.
struct PolyMesh {
  std::vector<Vec3> points;
  FoamLists faces;
  std::vector<std::uint32_t> owner;      ///< one per face
  std::vector<std::uint32_t> neighbour;  ///< one per face; `none` on the boundary
  std::vector<std::uint32_t> patch;      ///< one per face; `none` inside
  std::size_t cells = 0;
  std::vector<PolyPatch> patches;
  std::vector<PolyZone> cell_zones;
  std::vector<PolyZone> face_zones;
};

/// Reads points, faces, owner, neighbour, boundary and the zones of a folder. Labels are in range, and each face has at
/// least three corners. Throws InvalidMesh with file and line, or byte.
PolyMesh read_poly_mesh(const std::filesystem::path& folder, std::uint64_t max_memory);

/// The patches of a folder alone. Throws likewise.
std::vector<PolyPatchRange> read_poly_patches(const std::filesystem::path& folder, std::uint64_t max_memory);

/// The points of a folder alone.
std::vector<Vec3> read_poly_points(const std::filesystem::path& folder, std::uint64_t max_memory);

}  // namespace dartcast
