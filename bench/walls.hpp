// The walls of a scene as triangles: what a bounding volume hierarchy is built over.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/cell_complex.hpp"

namespace dartcast::bench {

/// Every fan triangle of every wall face seen from a free cell, and the points that they use.
struct Walls {
  struct Name {
    CellFace face;  ///< of the free cell
    std::uint16_t triangle;
    auto operator<=>(const Name&) const = default;
  };

  std::vector<std::uint32_t> points;                    ///< numbers of the complex's positions, increasing
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into `points`; clockwise seen from the free side
  std::vector<Name> names;                              ///< of the triangles, sorted

  /// The number of a triangle. Precondition: there is one of that name.
  [[nodiscard]] std::uint32_t number(const Name& name) const;
  /// Where the points are now.
  void gather(std::span<const Vec3> positions, std::vector<Vec3>& out) const;
};

/// Cost: linear in the cells.
Walls walls_of(const CellComplex& complex);

}  // namespace dartcast::bench
