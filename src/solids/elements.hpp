// The elements of a solid: its triangles, the edges that no triangle has, the points that neither has.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "dartcast/solids.hpp"

namespace dartcast {

/// A point, an edge or a triangle. Elements share corners and sides, but each of these is tested once: by the element that
/// owns it.
struct SolidElement {
  std::array<std::uint32_t, 3> vertex{};
  std::uint8_t count = 1;        ///< of corners
  std::uint8_t own_corners = 0;  ///< bit i: corner i
  std::uint8_t own_sides = 0;    ///< bit i: the side from corner i to the next
};

/// The number of an element's sides.
constexpr unsigned side_count(const SolidElement& e) { return e.count == 3 ? 3 : e.count - 1; }

/// The most elements that one search for walls serves.
inline constexpr std::uint32_t elements_in_group = 512;

/// All triangles, edges and points of a mesh, in an order in which each group has neighbours, and each half of
/// it, and so on. An edge or a triangle that is
/// listed twice counts once. Precondition: check() accepts the mesh. Cost: n log n.
std::vector<SolidElement> elements_of(const SolidMesh& mesh);

}  // namespace dartcast
