// Finds and looks up baffles.
#include "mesh/baffles.hpp"

#include <algorithm>
#include <utility>

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

}  // namespace dartcast
