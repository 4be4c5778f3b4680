// The input of a walk: a map, and positions at one instant.
#pragma once

#include <cstdint>

#include "dartcast/cell_complex.hpp"

namespace dartcast {

/// Positions as they are stored.
struct Stored {
  const Vec3* at;

  [[nodiscard]] Vec3 operator[](Vertex v) const { return at[v.value]; }
};

/// Positions at the fraction s of a step, on straight lines from old to new; the same doubles for every caller.
struct Between {
  const Vec3* from;
  const Vec3* to;
  double s;

  [[nodiscard]] Vec3 operator[](Vertex v) const {
    if (s == 1.0) return to[v.value];
    return from[v.value] + (to[v.value] - from[v.value]) * s;
  }
};

/// N: the number of a simplex's corners, 4 in space and 3 in the plane.
template <class Positions, std::size_t N = 4>
struct Space {
  const CombinatorialMap* map;
  Positions positions;
  std::uint64_t simplex_count;  ///< no walk meets more

  [[nodiscard]] std::array<Vec3, N> corners(const CellView& cell, const ImplicitSimplex& s) const {
    std::array<Vec3, N> v;
    for (unsigned i = 0; i < N; ++i) {
      v[i] = positions[cell.vertex(s.vertex[i])];
      if constexpr (N == 3) v[i].z = 0.0;  // whatever it is: the plane has none
    }
    return v;
  }
  [[nodiscard]] std::array<Vec3, N> corners(SimplexId id) const {
    const CellView cell = map->view(id.cell);
    return corners(cell, cell.shape().simplices()[id.simplex]);
  }
};

template <std::size_t N = 4>
Space<Stored, N> current_space(const CellComplex& complex) {
  return {&complex.map(), {complex.positions().data()}, complex.simplex_count()};
}
template <std::size_t N = 4>
Space<Stored, N> previous_space(const CellComplex& complex) {
  return {&complex.map(), {complex.previous_positions().data()}, complex.simplex_count()};
}
template <std::size_t N = 4>
Space<Between, N> space_between(const CellComplex& complex, double s) {
  return {
      &complex.map(), {complex.previous_positions().data(), complex.positions().data(), s}, complex.simplex_count()};
}

/// The simplex on the other side of a facet, and the facet's number there. Preconditions: the facet is no boundary.
struct Passage {
  SimplexId simplex;
  std::uint16_t facet;
};
inline Passage pass(const CombinatorialMap& map, SimplexId from, const CellView& cell, Across across) {
  if (!across.outer()) return {{from.cell, across.index}, across.place};
  const std::uint16_t face = across.face();
  const Cell next = cell.neighbour(face);
  const Across entry =
      map.shape(next).entry(cell.neighbour_face(face), cell.shape().triangle_from_other_side(face, across.place));
  return {{next, entry.index}, entry.place};
}

}  // namespace dartcast
