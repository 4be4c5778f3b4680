// Checks of every generated mesh of the plane: conforming, and strictly convex under the fan from every corner. Slow
// and exact; shares no code with the library but MeshData.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "dartcast/mesh_data.hpp"

namespace dartcast::test {

/// Sign of det[b - a, c - a], exactly.
int plane_sign(const Vec3& a, const Vec3& b, const Vec3& c);

/// Cells that do not have every corner on the left of each of their edges, those of the edge itself apart.
std::size_t count_not_convex(const MeshData& mesh);

double area(const MeshData& mesh);

using DirectedEdge = std::pair<std::uint32_t, std::uint32_t>;

std::map<DirectedEdge, std::vector<std::size_t>> directed_edges(const MeshData& mesh);

/// Each edge belongs to one cell in its direction and to at most one in the other; the edges of only one cell enter
/// each point as often as they leave it; every patch face is such an edge, in the direction of its cell; every point is
/// used and has z = 0. Returns the number of boundary edges.
std::size_t expect_conforming_in_plane(const MeshData& mesh);

/// Cells that can be reached from `start` through edges between free cells.
std::vector<bool> reached_from(const MeshData& mesh, std::size_t start);

}  // namespace dartcast::test
