// Whether what was read is what was written.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "dartcast/mesh_data.hpp"

namespace dartcast::test {

using Faces = std::vector<std::pair<std::int32_t, std::vector<std::uint32_t>>>;

inline Faces faces_of(const MeshData& mesh) {
  Faces faces;
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    faces.push_back({mesh.patch_tags[f],
                     {mesh.patch_faces.begin() + static_cast<std::ptrdiff_t>(mesh.patch_offsets[f]),
                      mesh.patch_faces.begin() + static_cast<std::ptrdiff_t>(mesh.patch_offsets[f + 1])}});
  }
  return faces;
}

using Cells = std::vector<std::tuple<CellType, std::int32_t, std::vector<std::uint32_t>>>;

/// Cells with their regions, sorted: formats keep no order between types.
inline Cells cells_of(const MeshData& mesh) {
  Cells cells;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    cells.emplace_back(mesh.types[c], mesh.regions.empty() ? 0 : mesh.regions[c],
                       std::vector<std::uint32_t>(mesh.cell(c).begin(), mesh.cell(c).end()));
  }
  std::sort(cells.begin(), cells.end());
  return cells;
}

inline void expect_same(const MeshData& a, const MeshData& b) {
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(cells_of(a), cells_of(b));
  auto x = faces_of(a);
  auto y = faces_of(b);
  std::sort(x.begin(), x.end());
  std::sort(y.begin(), y.end());
  EXPECT_EQ(x, y);
}

}  // namespace dartcast::test
