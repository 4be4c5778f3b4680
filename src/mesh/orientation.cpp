// Orients each cell by exact signs of its corners; mirrors cells that are inside out.
#include "mesh/orientation.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <tuple>
#include <vector>

#include "dartcast/predicates.hpp"
#include "mesh/cell_types.hpp"

namespace dartcast {
namespace {

/// A corner and its three neighbours along edges, turning so that the determinant is positive in a positive cell.
using Corner = std::array<std::uint8_t, 4>;

std::span<const Corner> corners_of(CellType type) {
  static constexpr std::array<Corner, 1> tetrahedron = {{{0, 1, 2, 3}}};
  static constexpr std::array<Corner, 8> hexahedron = {
      {{0, 1, 3, 4}, {1, 2, 0, 5}, {2, 3, 1, 6}, {3, 0, 2, 7}, {4, 7, 5, 0}, {5, 4, 6, 1}, {6, 5, 7, 2}, {7, 6, 4, 3}}};
  static constexpr std::array<Corner, 6> prism = {
      {{0, 1, 2, 3}, {1, 2, 0, 4}, {2, 0, 1, 5}, {3, 5, 4, 0}, {4, 3, 5, 1}, {5, 4, 3, 2}}};
  static constexpr std::array<Corner, 4> pyramid = {{{0, 1, 3, 4}, {1, 2, 0, 4}, {2, 3, 1, 4}, {3, 0, 2, 4}}};
  switch (type) {
    case CellType::tetrahedron: return tetrahedron;
    case CellType::hexahedron: return hexahedron;
    case CellType::prism: return prism;
    case CellType::pyramid: return pyramid;
    case CellType::polyhedron:
    case CellType::triangle:
    case CellType::quadrilateral:
    case CellType::polygon: break;
  }
  return {};
}

struct Votes {
  int positive = 0;
  int negative = 0;

  void add(Sign s) {
    if (s == Sign::positive) ++positive;
    if (s == Sign::negative) ++negative;
  }
};

Votes count_corners(const MeshData& mesh, std::size_t c) {
  const auto cell = mesh.cell(c);
  const auto& p = mesh.points;
  Votes votes;
  for (const Corner& k : corners_of(mesh.types[c])) {
    votes.add(orient3d(p[cell[k[0]]], p[cell[k[1]]], p[cell[k[2]]], p[cell[k[3]]]));
  }
  return votes;
}

/// Each face of a convex polyhedron has all corners behind it. The first and last corner in the order of coordinates
/// are corners of the hull whatever the cell's shape.
Votes count_faces(const MeshData& mesh, std::size_t c) {
  const auto& p = mesh.points;
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    return std::tie(p[a].x, p[a].y, p[a].z) < std::tie(p[b].x, p[b].y, p[b].z);
  };
  std::uint32_t low = mesh.cell(c)[2];
  std::uint32_t high = low;
  for_each_face(mesh, c, [&](std::span<const std::uint32_t> face) {
    for (const std::uint32_t v : face) {
      if (before(v, low)) low = v;
      if (before(high, v)) high = v;
    }
  });
  Votes votes;
  for_each_face(mesh, c, [&](std::span<const std::uint32_t> face) {
    for (std::size_t k = 2; k < face.size(); ++k) {
      votes.add(-orient3d(p[face[0]], p[face[k - 1]], p[face[k]], p[low]));
      votes.add(-orient3d(p[face[0]], p[face[k - 1]], p[face[k]], p[high]));
    }
  });
  return votes;
}

/// Take a closed polygon whose corners all turn left or go straight. It is weakly convex exactly if its edges turn once
/// from forward to backward, in the order of coordinates. Then it is two chains between its first and its last corner,
/// each bent one way only. More turns are more rounds, or edges that go back on themselves.
Orientation orient_polygon(const MeshData& mesh, std::size_t c) {
  const auto cell = mesh.cell(c);
  const std::size_t n = cell.size();
  const auto at = [&](std::size_t k) -> const Vec3& { return mesh.points[cell[k % n]]; };
  const auto forward = [&](std::size_t k) { return std::tie(at(k).x, at(k).y) < std::tie(at(k + 1).x, at(k + 1).y); };
  Votes votes;
  std::size_t turns = 0;
  bool all_long = true;
  for (std::size_t k = 0; k < n; ++k) {
    votes.add(orient2d(at(k), at(k + 1), at(k + 2)));
    turns += forward(k) && !forward(k + 1) ? 1 : 0;
    all_long = all_long && (at(k).x != at(k + 1).x || at(k).y != at(k + 1).y);
  }
  if (votes.positive == 0 && votes.negative == 0) return Orientation::flat;
  if ((votes.positive > 0 && votes.negative > 0) || turns != 1 || !all_long) return Orientation::inverted;
  return votes.positive > 0 ? Orientation::positive : Orientation::mirrored;
}

void mirror(MeshData& mesh, std::size_t c) {
  std::uint32_t* cell = mesh.connectivity.data() + mesh.offsets[c];
  switch (mesh.types[c]) {
    case CellType::tetrahedron: std::swap(cell[1], cell[2]); return;
    case CellType::pyramid: std::swap(cell[1], cell[3]); return;
    case CellType::prism:
      std::swap(cell[1], cell[2]);
      std::swap(cell[4], cell[5]);
      return;
    case CellType::hexahedron:
      std::swap(cell[1], cell[3]);
      std::swap(cell[5], cell[7]);
      return;
    case CellType::triangle:
    case CellType::quadrilateral:
    case CellType::polygon: std::reverse(cell + 1, mesh.connectivity.data() + mesh.offsets[c + 1]); return;
    case CellType::polyhedron: break;
  }
  std::size_t at = 1;
  for (std::uint32_t f = 0; f < cell[0]; ++f) {
    std::reverse(cell + at + 1, cell + at + 1 + cell[at]);
    at += cell[at] + 1;
  }
}

}  // namespace

Orientation orient_cell(MeshData& mesh, std::size_t c) {
  if (dimension(mesh.types[c]) == 2) {
    const Orientation found = orient_polygon(mesh, c);
    if (found == Orientation::mirrored) mirror(mesh, c);
    return found;
  }
  const Votes votes = mesh.types[c] == CellType::polyhedron ? count_faces(mesh, c) : count_corners(mesh, c);
  if (votes.positive == 0 && votes.negative == 0) return Orientation::flat;
  if (votes.positive == votes.negative) return Orientation::inverted;
  if (votes.positive > votes.negative) return Orientation::positive;
  mirror(mesh, c);
  return Orientation::mirrored;
}

}  // namespace dartcast
