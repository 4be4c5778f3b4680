// Finds and looks up baffles.
#include "mesh/baffles.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "mesh/structure.hpp"

namespace dartcast {
namespace {

std::vector<std::uint32_t> sorted(std::span<const std::uint32_t> corners) {
  std::vector<std::uint32_t> out(corners.begin(), corners.end());
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

bool is_baffle(const MeshData& mesh, std::int32_t tag) {
  return std::find(mesh.baffle_tags.begin(), mesh.baffle_tags.end(), tag) != mesh.baffle_tags.end();
}

Baffles::Baffles(const MeshData& mesh) {
  if (mesh.baffle_tags.empty()) return;
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    if (is_baffle(mesh, mesh.patch_tags[f])) faces_.push_back(sorted(mesh.patch_face(f)));
  }
  std::sort(faces_.begin(), faces_.end());
}

bool Baffles::contains(std::span<const std::uint32_t> corners) const {
  return !faces_.empty() && std::binary_search(faces_.begin(), faces_.end(), sorted(corners));
}

std::vector<std::int32_t> tags_of_coinciding_faces(const MeshData& mesh) {
  std::vector<std::pair<std::vector<std::uint32_t>, std::int32_t>> faces;
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f)
    faces.emplace_back(sorted(mesh.patch_face(f)), mesh.patch_tags[f]);
  std::sort(faces.begin(), faces.end());
  std::vector<std::int32_t> tags;
  for (std::size_t i = 1; i < faces.size(); ++i) {
    if (faces[i].first == faces[i - 1].first) tags.insert(tags.end(), {faces[i - 1].second, faces[i].second});
  }
  std::sort(tags.begin(), tags.end());
  tags.erase(std::unique(tags.begin(), tags.end()), tags.end());
  return tags;
}

void list_both_sides(MeshData& mesh, const std::set<std::int32_t>& tags) {
  std::vector<std::uint8_t> cells(mesh.patch_tags.size());
  for_each_patch_face_of_cells(mesh, [&](std::size_t f, std::size_t /*cell*/) { ++cells[f]; });
  std::map<std::vector<std::uint32_t>, unsigned> listed;
  for (std::size_t f = 0; f < cells.size(); ++f) {
    if (cells[f] > 1) ++listed[sorted(mesh.patch_face(f))];
  }
  for (std::size_t f = 0; f < cells.size(); ++f) {
    const auto face = mesh.patch_face(f);
    if (cells[f] < 2 || tags.count(mesh.patch_tags[f]) == 0 || listed[sorted(face)] > 1) continue;
    mesh.add_patch_face(std::vector<std::uint32_t>(face.rbegin(), face.rend()), mesh.patch_tags[f]);
    if (!mesh.patch_source.empty()) mesh.patch_source.push_back(mesh.patch_source[f]);
  }
}

}  // namespace dartcast
