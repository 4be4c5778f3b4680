// What a reader of one file format hands on, before the mesh is inspected.
#pragma once

#include <string>
#include <vector>

#include "dartcast/mesh/mesh_data.hpp"
#include "dartcast/mesh/report.hpp"

namespace dartcast {

/// Ids that name no point are kept as 0xffffffff, for inspect() to find. Faces of groups and, in planar meshes, all
/// faces are in the mesh's patch faces.
struct ParsedMesh {
  MeshData mesh;
  std::string format;
  Finding second_order{"second_order",
                       0,
                       {},
                       "cells of second or higher order, with curved sides; write the mesh with linear "
                       "cells (Gmsh: -order 1)"};
  Finding unsupported{"cell_type", 0, {}, "cells of a type that cannot be used"};
};

inline constexpr std::uint32_t no_point = 0xffffffffU;

/// Last step of each reader. In a mesh with cells only faces with a tag are kept; without names or tags regions stay
/// empty.
inline void finish(ParsedMesh& parsed) {
  MeshData& mesh = parsed.mesh;
  bool tagged = false;
  for (const std::int32_t tag : mesh.regions) tagged = tagged || tag != 0;
  if (!tagged) mesh.regions.clear();
  if (mesh.types.empty()) return;
  MeshData kept;
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const std::size_t begin = mesh.patch_offsets[f];
    if (mesh.patch_tags[f] == 0) continue;
    kept.add_patch_face({mesh.patch_faces.data() + begin, mesh.patch_offsets[f + 1] - begin}, mesh.patch_tags[f]);
  }
  mesh.patch_faces = std::move(kept.patch_faces);
  mesh.patch_offsets = std::move(kept.patch_offsets);
  mesh.patch_tags = std::move(kept.patch_tags);
}

}  // namespace dartcast
