// Counts the walls among patch faces.
#include "mesh/patch_walls.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>

#include "dartcast/error.hpp"
#include "mesh/baffles.hpp"
#include "mesh/structure.hpp"

namespace dartcast {
namespace {

std::string why_no_wall(const PatchFaces& faces) {
  if (!faces.inner.empty())
    return fmt::format(
        "its {} faces lie between two free cells: name it in the key walls, block the cells on one side with the key "
        "free, or do not name it",
        faces.inner.size());
  if (faces.blocked > 0)
    return fmt::format("its {} faces are faces of blocked cells alone: free the cells on one side, or do not name it",
                       faces.blocked);
  return "no cell has a face of it: do not name it";
}

}  // namespace

std::map<std::string, PatchFaces> faces_of_patches(const MeshData& mesh) {
  std::vector<std::uint8_t> free_sides(mesh.patch_tags.size());
  for_each_patch_face_of_cells(mesh, [&](std::size_t f, std::size_t c) {
    if (mesh.free.empty() || mesh.free[c] != 0) ++free_sides[f];
  });
  std::map<std::string, PatchFaces> patches;
  for (const auto& [tag, name] : mesh.patch_names) patches[name];
  for (std::size_t f = 0; f < free_sides.size(); ++f) {
    const auto named = mesh.patch_names.find(mesh.patch_tags[f]);
    PatchFaces& faces = patches[named != mesh.patch_names.end() ? named->second : std::to_string(mesh.patch_tags[f])];
    if (free_sides[f] == 0) {
      ++faces.blocked;
    } else if (free_sides[f] == 1 || is_baffle(mesh, mesh.patch_tags[f])) {
      ++faces.walls;
    } else {
      faces.inner.push_back(mesh.patch_source.empty() ? f : mesh.patch_source[f]);
    }
  }
  patches.erase("");  // no patch
  return patches;
}

Finding inner_patch_faces(const MeshData& mesh) {
  Finding finding{"inner_faces", 0, {}, ""};
  std::vector<std::string> names;
  for (const auto& [name, faces] : faces_of_patches(mesh)) {
    if (!faces.inner.empty()) names.push_back(name);
    for (const std::size_t f : faces.inner) finding.add(f);
  }
  finding.message = fmt::format(
      "faces of named groups between two free cells ({}): particles pass them, unless the key walls names them or the "
      "cells on one side are blocked",
      fmt::join(names, ", "));
  return finding;
}

void expect_walls(const MeshData& mesh, std::span<const std::string> patches) {
  if (patches.empty()) return;
  const auto known = faces_of_patches(mesh);
  for (const std::string& name : patches) {
    const auto found = known.find(name);
    if (found == known.end() || found->second.walls > 0) continue;
    throw InvalidMesh(fmt::format("the patch '{}' has no wall face: {}", name, why_no_wall(found->second)));
  }
}

}  // namespace dartcast
