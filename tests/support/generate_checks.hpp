// Checks of every generated mesh: conforming, closed, and positive under the pulling triangulation. Slow and exact;
// shares no code with the library but MeshData and its list of faces.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "dartcast/mesh_data.hpp"
#include "mesh/cell_types.hpp"

namespace dartcast::test {

using CornerNumbers = std::vector<std::uint32_t>;

/// A face's corners from its lowest on, in the order given.
CornerNumbers from_lowest(std::span<const std::uint32_t> face);

CornerNumbers reversed(CornerNumbers f);

/// Every face of every cell, from its lowest corner on, with the cells that have it in this orientation.
std::map<CornerNumbers, std::vector<std::size_t>> all_faces(const MeshData& mesh);

/// Calls visit(a, b, c, d) for each simplex of the cell's pulling triangulation: the cone from its lowest vertex over
/// the fans of the faces without it.
template <class Visit>
void for_each_simplex(const MeshData& mesh, std::size_t cell, Visit&& visit) {
  std::uint32_t apex = 0xffffffffU;
  for_each_face(mesh, cell, [&](std::span<const std::uint32_t> f) {
    apex = std::min(apex, *std::min_element(f.begin(), f.end()));
  });
  for_each_face(mesh, cell, [&](std::span<const std::uint32_t> f) {
    if (std::find(f.begin(), f.end(), apex) != f.end()) return;
    const CornerNumbers fan = from_lowest(f);
    // Counterclockwise from the outside is clockwise from the apex: swapped, the simplex is positive.
    for (std::size_t i = 1; i + 1 < fan.size(); ++i) visit(fan[0], fan[i + 1], fan[i], apex);
  });
}

std::size_t count_not_positive(const MeshData& mesh, std::span<const Vec3> points);

double volume(const MeshData& mesh);

/// Each face belongs to one cell in its orientation and to at most one in the other; the faces of only one cell form a
/// closed surface; every patch face is a face; every point is used; arrays have the sizes they should. Returns the
/// number of boundary faces.
std::size_t expect_conforming(const MeshData& mesh);

/// Number of patch faces of each name.
std::map<std::string, std::size_t> patch_sizes(const MeshData& mesh);

}  // namespace dartcast::test
