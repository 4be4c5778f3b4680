// Finds vertices and edges where the boundary of a mesh is pinched.
#include "mesh/manifold.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

namespace dartcast {
namespace {

/// A side of a boundary face, with the places of its two ends in BoundaryFaces::corners.
struct FaceSide {
  std::uint32_t low;
  std::uint32_t high;
  std::size_t low_place;
  std::size_t high_place;
};

std::vector<FaceSide> sorted_sides(const BoundaryFaces& boundary) {
  std::vector<FaceSide> sides;
  sides.reserve(boundary.corners.size());
  for (std::size_t f = 0; f < boundary.size(); ++f) {
    const std::size_t begin = boundary.offsets[f];
    const std::size_t n = boundary.offsets[f + 1] - begin;
    if (n == 2) continue;
    for (std::size_t k = 0; k < n; ++k) {
      std::size_t i = begin + k;
      std::size_t j = begin + (k + 1) % n;
      if (boundary.corners[i] > boundary.corners[j]) std::swap(i, j);
      sides.push_back({boundary.corners[i], boundary.corners[j], i, j});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const FaceSide& a, const FaceSide& b) {
    return std::tie(a.low, a.high, a.low_place) < std::tie(b.low, b.high, b.low_place);
  });
  return sides;
}

}  // namespace

Pinches find_pinches(const FaceMatch& match) {
  Pinches out;
  const BoundaryFaces& boundary = match.boundary;
  const std::vector<FaceSide> sides = sorted_sides(boundary);
  std::vector<std::size_t> parent(boundary.corners.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  std::vector<std::uint32_t> ends;
  for (std::size_t i = 0, j = 0; i < sides.size(); i = j) {
    for (j = i + 1; j < sides.size() && sides[j].low == sides[i].low && sides[j].high == sides[i].high;) ++j;
    if (j - i != 2) {
      out.edges.push_back(sides[i].low);
      ends.insert(ends.end(), {sides[i].low, sides[i].high});
      continue;
    }
    parent[root(sides[i].low_place)] = root(sides[i + 1].low_place);
    parent[root(sides[i].high_place)] = root(sides[i + 1].high_place);
  }
  std::sort(ends.begin(), ends.end());
  // Around a point, each fan of faces has one root; in the plane each fan of cells has one edge that starts there.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> fans;
  for (std::size_t f = 0; f < boundary.size(); ++f) {
    const std::size_t begin = boundary.offsets[f];
    const std::size_t end = boundary.offsets[f + 1] - begin == 2 ? begin + 1 : boundary.offsets[f + 1];
    for (std::size_t i = begin; i < end; ++i) {
      if (parent[i] == i) fans.emplace_back(boundary.corners[i], match.part[boundary.cells[f]]);
    }
  }
  std::sort(fans.begin(), fans.end());
  for (std::size_t i = 1; i < fans.size(); ++i) {
    const std::uint32_t point = fans[i].first;
    if (fans[i] != fans[i - 1] || (!out.points.empty() && out.points.back() == point)) continue;
    if (!std::binary_search(ends.begin(), ends.end(), point)) out.points.push_back(point);
  }
  return out;
}

}  // namespace dartcast
