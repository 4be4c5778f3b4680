// The faces of a mesh that stay walls though two cells have them.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <vector>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// Whether a patch is one of MeshData::baffle_tags.
bool is_baffle(const MeshData& mesh, std::int32_t tag);

/// The faces of MeshData::baffle_tags by their corners, in any order. Cost: n log n in the faces of these patches.
class Baffles {
 public:
  explicit Baffles(const MeshData& mesh);

  [[nodiscard]] bool contains(std::span<const std::uint32_t> corners) const;

 private:
  std::vector<std::vector<std::uint32_t>> faces_;  // sorted, and each face's corners, too
};

/// The tags of patches that have a face with the corners of another patch face, ascending. Cost: n log n.
std::vector<std::int32_t> tags_of_coinciding_faces(const MeshData& mesh);

/// Adds to the patch faces of these tags that two cells have, and that are listed once, the same from the other side.
void list_both_sides(MeshData& mesh, const std::set<std::int32_t>& tags);

}  // namespace dartcast
