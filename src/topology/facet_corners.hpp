// The corners of a simplex's facets, in order.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace dartcast {

/// The corners of the facet opposite to corner i, in an order for which orient3d(a, b, c, x) is positive on the side of
/// corner i. In the plane: orient2d(a, b, x).
inline constexpr std::array<std::array<std::uint8_t, 3>, 4> facet_corners = {
    {{2, 1, 3}, {0, 2, 3}, {1, 0, 3}, {0, 1, 2}}};
inline constexpr std::array<std::array<std::uint8_t, 2>, 3> plane_facet_corners = {{{1, 2}, {2, 0}, {0, 1}}};

/// Corner i of a facet of a simplex with N corners.
template <std::size_t N>
constexpr unsigned facet_corner(unsigned facet, unsigned i) {
  if constexpr (N == 4) return facet_corners[facet][i];
  return plane_facet_corners[facet % 3][i % 2];
}

}  // namespace dartcast
