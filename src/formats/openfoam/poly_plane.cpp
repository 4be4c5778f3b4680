// A mesh of one layer as a mesh of the plane. Each cell lies between two faces in patches of the type `empty`; of the
// lower one the mesh has the corners.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "dartcast/error.hpp"
#include "formats/openfoam/poly_cells.hpp"

namespace dartcast {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

bool is_empty(const PolyMesh& mesh, std::uint32_t face) {
  return mesh.patch[face] != none && mesh.patches[mesh.patch[face]].type == "empty";
}

/// The two faces of each cell, either one first.
std::vector<std::array<std::uint32_t, 2>> empty_pairs(const PolyMesh& mesh) {
  std::vector<std::array<std::uint32_t, 2>> pairs(mesh.cells, {none, none});
  const auto refuse = [](std::size_t cell, std::string_view what) {
    throw InvalidMesh(
        fmt::format("cell {} has {}; a mesh of the plane has one layer of cells, each between two faces in "
                    "patches of the type empty",
                    cell, what));
  };
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    if (!is_empty(mesh, f)) continue;
    auto& pair = pairs[mesh.owner[f]];
    if (pair[1] != none) refuse(mesh.owner[f], "more than two of them");
    pair[pair[0] == none ? 0 : 1] = f;
  }
  for (std::size_t c = 0; c < pairs.size(); ++c) {
    if (pairs[c][1] == none) refuse(c, "fewer than two faces in patches of the type empty");
  }
  return pairs;
}

/// The lower of the two faces of each cell along an axis; none if these are not all below all others.
std::vector<std::uint32_t> lower_faces(const PolyMesh& mesh, const std::vector<std::array<std::uint32_t, 2>>& pairs,
                                       double Vec3::*axis) {
  std::vector<std::uint32_t> lower;
  double highest_below = -infinity;
  double lowest_above = infinity;
  for (const auto& [a, b] : pairs) {
    const auto height = [&](std::uint32_t face) { return mesh.points[mesh.faces[face][0]].*axis; };
    const bool first = height(a) < height(b);
    lower.push_back(first ? a : b);
    for (const std::uint32_t p : mesh.faces[first ? a : b])
      highest_below = std::max(highest_below, mesh.points[p].*axis);
    for (const std::uint32_t p : mesh.faces[first ? b : a]) lowest_above = std::min(lowest_above, mesh.points[p].*axis);
  }
  if (!(highest_below < lowest_above)) lower.clear();
  return lower;
}

std::vector<std::uint32_t> lower_faces_along_z(const PolyMesh& mesh) {
  const auto pairs = empty_pairs(mesh);
  std::vector<std::uint32_t> lower = lower_faces(mesh, pairs, &Vec3::z);
  if (!lower.empty()) return lower;
  for (const auto& [axis, name] : {std::pair{&Vec3::x, "x"}, std::pair{&Vec3::y, "y"}}) {
    if (!lower_faces(mesh, pairs, axis).empty())
      throw InvalidMesh(
          fmt::format("the layer of cells lies across {0}; a mesh of the plane lies across z: turn it with "
                      "transformPoints -rotate \"(({1}) (0 0 1))\"",
                      name, name[0] == 'x' ? "1 0 0" : "0 1 0"));
  }
  throw InvalidMesh("the faces in patches of the type empty do not lie on two sides of a layer across z");
}

}  // namespace

bool has_empty_faces(const PolyMesh& mesh) {
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    if (is_empty(mesh, f)) return true;
  }
  return false;
}

ParsedMesh mesh_in_plane(const PolyMesh& mesh, std::vector<std::uint32_t>& kept) {
  const std::vector<std::uint32_t> lower = lower_faces_along_z(mesh);
  ParsedMesh parsed;
  std::vector<std::uint32_t> number(mesh.points.size(), none);
  for (const std::uint32_t f : lower) {
    for (const std::uint32_t p : mesh.faces[f]) number[p] = 0;
  }
  for (std::uint32_t p = 0; p < number.size(); ++p) {
    if (number[p] == none) continue;
    number[p] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(p);
    parsed.mesh.points.push_back({mesh.points[p].x, mesh.points[p].y, 0.0});
  }
  std::vector<std::uint32_t> corners;
  for (const std::uint32_t f : lower) {
    corners.clear();
    for (const std::uint32_t p : mesh.faces[f]) corners.push_back(number[p]);
    std::reverse(corners.begin(), corners.end());  // seen from above, not from below
    const std::size_t n = corners.size();
    parsed.mesh.add_cell(n == 3 ? CellType::triangle : (n == 4 ? CellType::quadrilateral : CellType::polygon), corners);
  }
  // As the owner has it.
  const auto edge = [&](std::uint32_t f) -> std::span<const std::uint32_t> {
    corners.clear();
    for (const std::uint32_t p : mesh.faces[f]) {
      if (number[p] != none) corners.push_back(number[p]);
    }
    const bool side = corners.size() == 2 && mesh.faces[f].size() == 4;
    if (side && corners[0] == number[mesh.faces[f][0]] && corners[1] == number[mesh.faces[f][3]])
      std::swap(corners[0], corners[1]);  // from the last to the first
    return side ? std::span<const std::uint32_t>(corners) : std::span<const std::uint32_t>();
  };
  add_zones_and_patches(mesh, edge, parsed);
  return parsed;
}

}  // namespace dartcast
