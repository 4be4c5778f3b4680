// Whether a part is what it says, seen from the whole mesh.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/mesh_part.hpp"
#include "mesh/cell_types.hpp"
#include "mesh/faces.hpp"
#include "parts/part_cutter.hpp"

namespace dartcast::test {

inline std::vector<std::uint32_t> sorted_face(std::span<const std::uint32_t> face) {
  std::vector<std::uint32_t> sorted(face.begin(), face.end());
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

// A cell's faces by the points of the whole.
inline std::vector<std::vector<std::uint32_t>> faces_in_whole(const MeshPart& part, std::size_t c) {
  std::vector<std::vector<std::uint32_t>> faces;
  for_each_face(part.mesh, c, [&](std::span<const std::uint32_t> face) {
    auto& corners = faces.emplace_back();
    for (const std::uint32_t p : face) corners.push_back(part.points[p]);
  });
  return faces;
}

// All cells that share a point with an own cell are there.
inline void expect_ghosts(const MeshData& whole, const std::vector<std::uint32_t>& owners, const MeshPart& part) {
  std::vector<bool> near(whole.points.size());
  for (std::size_t c = 0; c < owners.size(); ++c) {
    if (owners[c] != part.part) continue;
    for_each_face(whole, c, [&](auto face) {
      for (const std::uint32_t p : face) near[p] = true;
    });
  }
  for (std::uint32_t c = 0; c < owners.size(); ++c) {
    bool touches = false;
    for_each_face(whole, c, [&](auto face) {
      for (const std::uint32_t p : face) touches = touches || near[p];
    });
    if (touches) EXPECT_TRUE(std::binary_search(part.cells.begin(), part.cells.end(), c)) << c;
  }
}

// Faces on the boundary are unknown but for those on the boundary of the whole.
inline void expect_unknown_faces(const MeshData& whole, const MeshPart& part) {
  std::set<std::vector<std::uint32_t>> outer;
  const BoundaryFaces all = match_faces(whole).boundary;
  for (std::size_t f = 0; f < all.size(); ++f) outer.insert(sorted_face(all.face(f)));
  std::set<std::vector<std::uint32_t>> unknown;
  for (std::size_t f = 0; f < part.mesh.patch_tags.size(); ++f) {
    if (part.mesh.patch_names.at(part.mesh.patch_tags[f]) != unknown_patch) continue;
    std::vector<std::uint32_t> corners;
    for (const std::uint32_t p : part.mesh.patch_face(f)) corners.push_back(part.points[p]);
    EXPECT_TRUE(unknown.insert(sorted_face(corners)).second);
  }
  const BoundaryFaces around = match_faces(part.mesh).boundary;
  for (std::size_t f = 0; f < around.size(); ++f) {
    std::vector<std::uint32_t> corners;
    for (const std::uint32_t p : around.face(f)) corners.push_back(part.points[p]);
    EXPECT_NE(unknown.erase(sorted_face(corners)) > 0, outer.contains(sorted_face(corners)));
  }
  EXPECT_TRUE(unknown.empty());
}

// The map gives own cells the same patches and walls.
inline void expect_same_walls(const MeshData& whole, const MeshPart& part) {
  const CombinatorialMap map(part.mesh);
  const CombinatorialMap map_of_whole(whole);
  std::vector<std::string> names = map_of_whole.patch_names();
  names.emplace_back(unknown_patch);
  EXPECT_EQ(map.patch_names(), names);
  const std::vector<Cell> here = handles_of(part.mesh);
  for (std::size_t c = 0; c < part.cells.size(); ++c) {
    if (part.owners[c] != part.part) continue;
    for (std::uint16_t f = 0; f < map.view(here[c]).shape().face_count(); ++f) {
      EXPECT_EQ(map.patch(CellFace{here[c], f}), map_of_whole.patch(CellFace{part.handles[c], f}));
      EXPECT_EQ(map.view(here[c]).is_wall(f), map_of_whole.view(part.handles[c]).is_wall(f));
    }
  }
}

// Cells, points, ghosts, patches and unknown faces. `owners`: of the cells of the whole.
inline void expect_is_part(const MeshData& whole, const std::vector<std::uint32_t>& owners, const MeshPart& part,
                           const std::string& name) {
  SCOPED_TRACE(name);
  ASSERT_EQ(part.points.size(), part.mesh.points.size());
  ASSERT_EQ(part.cells.size(), part.mesh.cell_count());
  ASSERT_EQ(part.owners.size(), part.cells.size());
  ASSERT_EQ(part.handles.size(), part.cells.size());
  for (std::size_t i = 0; i < part.points.size(); ++i) {
    ASSERT_TRUE(i == 0 || part.points[i - 1] < part.points[i]);
    ASSERT_EQ(part.mesh.points[i], whole.points[part.points[i]]);
  }
  const std::vector<Cell> handles = handles_of(whole);
  for (std::size_t c = 0; c < part.cells.size(); ++c) {
    const std::uint32_t w = part.cells[c];
    ASSERT_TRUE(c == 0 || part.cells[c - 1] < w);
    EXPECT_EQ(part.owners[c], owners[w]);
    EXPECT_EQ(part.handles[c], handles[w]);
    EXPECT_EQ(part.mesh.types[c], whole.types[w]);
    EXPECT_EQ(part.mesh.source[c], whole.source.empty() ? w : whole.source[w]);
    EXPECT_EQ(part.mesh.free.empty() || part.mesh.free[c] != 0, whole.free.empty() || whole.free[w] != 0);
    std::vector<std::vector<std::uint32_t>> faces;
    for_each_face(whole, w, [&](auto face) { faces.emplace_back(face.begin(), face.end()); });
    EXPECT_EQ(faces_in_whole(part, c), faces);
  }
  expect_ghosts(whole, owners, part);
  expect_unknown_faces(whole, part);
  expect_same_walls(whole, part);
}

}  // namespace dartcast::test
