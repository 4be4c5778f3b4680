// Regions and patches from OpenFOAM's zones and patches.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "formats/openfoam/poly_cells.hpp"
#include "mesh/baffles.hpp"

namespace dartcast {
namespace {

/// The number of faces in each patch.
std::vector<std::size_t> patch_sizes(const PolyMesh& mesh) {
  std::vector<std::size_t> sizes(mesh.patches.size(), 0);
  for (const std::uint32_t p : mesh.patch) {
    if (p != none) ++sizes[p];
  }
  return sizes;
}

void add_regions(const PolyMesh& mesh, ParsedMesh& parsed) {
  MeshData& out = parsed.mesh;
  Finding several{"zones", 0, {}, "cells that are in several zones; the first of these is the region"};
  if (!mesh.cell_zones.empty()) out.regions.assign(mesh.cells, 0);
  for (std::size_t z = 0; z < mesh.cell_zones.size(); ++z) {
    const auto tag = static_cast<std::int32_t>(z + 1);
    out.region_names[tag] = mesh.cell_zones[z].name;
    for (const std::uint32_t c : mesh.cell_zones[z].labels) {
      if (out.regions[c] == 0) {
        out.regions[c] = tag;
      } else if (out.regions[c] != tag) {
        several.add(c);
      }
    }
  }
  add_finding(parsed.warnings, several);
}

// The tag of each face: of its patch, else of its first zone; 0: none.
std::vector<std::int32_t> face_tags(const PolyMesh& mesh, ParsedMesh& parsed) {
  std::vector<std::int32_t> tags(mesh.faces.size(), 0);
  for (std::size_t p = 0; p < mesh.patches.size(); ++p) {
    if (mesh.patches[p].type != "empty")
      parsed.mesh.patch_names[static_cast<std::int32_t>(p + 1)] = mesh.patches[p].name;
  }
  for (std::size_t f = 0; f < tags.size(); ++f) tags[f] = static_cast<std::int32_t>(mesh.patch[f] + 1);  // none: 0
  for (std::size_t z = 0; z < mesh.face_zones.size(); ++z) {
    const PolyZone& zone = mesh.face_zones[z];
    const auto tag = static_cast<std::int32_t>(mesh.patches.size() + z + 1);  // also if a patch has the name
    parsed.mesh.patch_names[tag] = zone.name;
    for (const std::uint32_t f : zone.labels) {
      if (tags[f] == 0) tags[f] = tag;
    }
  }
  return tags;
}

void refuse_types(const PolyMesh& mesh) {
  const std::vector<std::size_t> sizes = patch_sizes(mesh);
  for (std::size_t p = 0; p < sizes.size(); ++p) {
    const PolyPatch& patch = mesh.patches[p];
    if (sizes[p] == 0) continue;
    if (patch.type.starts_with("processor"))
      throw InvalidMesh(
          fmt::format("the patch {} leads to another processor's part: name the case's folder, which has "
                      "all parts, or run reconstructParMesh",
                      patch.name));
  }
}

}  // namespace

void add_zones_and_patches(const PolyMesh& mesh, const CornersOfFace& corners, ParsedMesh& parsed) {
  refuse_types(mesh);
  add_cyclic_pairs(mesh, corners, parsed);
  add_regions(mesh, parsed);
  const std::vector<std::int32_t> tags = face_tags(mesh, parsed);
  const auto add_faces = [&](bool of_boundary) {
    for (std::uint32_t f = 0; f < tags.size(); ++f) {
      if (tags[f] == 0 || (mesh.patch[f] != none) != of_boundary) continue;
      const auto face = corners(f);
      if (face.empty()) continue;
      parsed.mesh.add_patch_face(face, tags[f]);
      parsed.mesh.patch_source.push_back(f);
    }
  };
  add_faces(true);
  parsed.mesh.baffle_tags = tags_of_coinciding_faces(parsed.mesh);
  add_faces(false);
}

}  // namespace dartcast
