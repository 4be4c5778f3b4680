// Writes meshes as SimVascular's folders.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/mesh_files.hpp"
#include "support/sample_mesh.hpp"
#include "support/vtp_text.hpp"

namespace dartcast::test {

/// A mesh as it was written, and the corners of the faces of each patch.
struct SimVascularCase {
  MeshData mesh;
  std::map<std::string, std::set<std::set<std::uint32_t>>> patches;
};

/// Each patch is in a .vtp file, whose points are those of the mesh in another order.
inline SimVascularCase write_simvascular_case(const std::filesystem::path& folder, MeshData mesh, bool with_ids) {
  SimVascularCase made{mesh, {}};
  const std::size_t n = mesh.points.size();
  DataArray ids{"GlobalNodeID", 1, {}};
  for (std::size_t p = 0; p < n; ++p) ids.values.push_back(static_cast<double>(1 + (7 * p) % n));
  if (with_ids) mesh.point_data.push_back(ids);
  std::map<std::int32_t, std::vector<std::size_t>> faces;
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) faces[mesh.patch_tags[f]].push_back(f);
  std::filesystem::create_directories(folder / "mesh-surfaces");
  for (const auto& [tag, list] : faces) {
    std::vector<std::uint32_t> used;
    for (const std::size_t f : list) used.insert(used.end(), mesh.patch_face(f).begin(), mesh.patch_face(f).end());
    std::sort(used.rbegin(), used.rend());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    std::vector<Vec3> points;
    std::vector<std::int64_t> numbers;
    for (const std::uint32_t p : used) {
      points.push_back(mesh.points[p]);
      numbers.push_back(static_cast<std::int64_t>(ids.values[p]));
      if (with_ids) points.back() *= 1.0 + 1e-7;  // as numbers of fewer digits
    }
    std::vector<std::vector<std::uint32_t>> own;
    const std::string name = mesh.patch_names.at(tag);
    for (const std::size_t f : list) {
      own.emplace_back();
      for (const std::uint32_t p : mesh.patch_face(f))
        own.back().push_back(static_cast<std::uint32_t>(std::find(used.begin(), used.end(), p) - used.begin()));
      made.patches[name].insert({mesh.patch_face(f).begin(), mesh.patch_face(f).end()});
    }
    write_bytes(folder / "mesh-surfaces" / (name + ".vtp"),
                vtp_text(points, own, with_ids ? vtp_array("GlobalNodeID", numbers) : ""));
  }
  mesh.patch_faces.clear();
  mesh.patch_offsets = {0};
  mesh.patch_tags.clear();
  mesh.patch_names.clear();
  write_mesh(mesh, folder / "mesh-complete.mesh.vtu");
  return made;
}

}  // namespace dartcast::test
