// The last step of each mesh reader: which elements are cells, and which are patch faces.
#include "formats/parsed_mesh.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "mesh/cell_types.hpp"

namespace dartcast {

bool take_plane(ParsedMesh& parsed) {
  MeshData& mesh = parsed.mesh;
  if (!mesh.types.empty() || mesh.patch_tags.empty()) return false;
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    mesh.types.push_back(plane_type(mesh.patch_offsets[f + 1] - mesh.patch_offsets[f]));
  }
  mesh.connectivity = std::exchange(mesh.patch_faces, {});
  mesh.offsets = std::exchange(mesh.patch_offsets, {0});
  mesh.regions = std::exchange(mesh.patch_tags, {});
  mesh.source = std::exchange(mesh.patch_source, std::exchange(parsed.edge_source, {}));
  mesh.region_names = std::exchange(mesh.patch_names, std::exchange(parsed.edge_names, {}));
  for (std::size_t e = 0; e < parsed.edges.size(); ++e) mesh.add_patch_face(parsed.edges[e], parsed.edge_tags[e]);
  return true;
}

void finish(ParsedMesh& parsed) {
  take_plane(parsed);
  MeshData& mesh = parsed.mesh;
  if (std::all_of(mesh.regions.begin(), mesh.regions.end(), [](std::int32_t tag) { return tag == 0; }))
    mesh.regions.clear();
  MeshData kept;
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    if (mesh.patch_tags[f] == 0) continue;
    kept.add_patch_face(mesh.patch_face(f), mesh.patch_tags[f]);
    kept.patch_source.push_back(mesh.patch_source.empty() ? static_cast<std::uint32_t>(f) : mesh.patch_source[f]);
  }
  mesh.patch_faces = std::move(kept.patch_faces);
  mesh.patch_offsets = std::move(kept.patch_offsets);
  mesh.patch_tags = std::move(kept.patch_tags);
  mesh.patch_source = std::move(kept.patch_source);
}

}  // namespace dartcast
