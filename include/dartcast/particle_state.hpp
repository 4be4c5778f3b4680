// The state of a particle: the paper's S = (p, k, i), with the simplex in place of the dart.
#pragma once

#include <array>
#include <cstdint>

#include "dartcast/ids.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

class CombinatorialMap;

/// A plain record with this meaning: `position` lies in the closed simplex that the record names, and the cell is free
/// (guarantee G3). The walls are those of the last contact, until the particle leaves them.
struct ParticleState {
  Vec3 position;
  Cell cell;
  std::uint16_t simplex = 0;
  std::uint8_t touching_count = 0;
  bool held =
      false;  ///< its simplex is not positive now, or its cell is blocked: it moves with the mesh, takes no step
  std::array<CellFace, 3> touching{};

  /// The simplex that holds the particle.
  [[nodiscard]] SimplexId at() const { return {cell, simplex}; }
  /// Sets simplex and position. Precondition: the closed simplex holds the point.
  void put(SimplexId s, const Vec3& p) {
    position = p;
    cell = s.cell;
    simplex = s.simplex;
  }
};

/// Barycentric coordinates that a held particle keeps; in the plane the fourth is 0.
using Weights = std::array<double, 4>;

/// The paper's k and i, derived from a state.
struct Forecast {
  /// Kind of the map's cell that the particle is in (volume; in the plane face), or that it touches after a contact.
  Kind kind = Kind::volume;
  Dart dart;  ///< edge of the base of the particle's simplex; its face is the one that it is heading for
  CellFace face;
};

/// The kind from exact zeros, or from the walls touched, and the dart of the simplex's base. `corners` are those of the
/// state's simplex. Cost: four exact signs.
Forecast forecast(const CombinatorialMap& map, const ParticleState& state, const Corners& corners);

/// The cell of the map that holds a point in its interior: its kind, and a dart of that face, edge or vertex. The dart
/// is invalid inside a cell.
struct Placement {
  Kind kind = Kind::volume;
  Dart dart;
};
/// Where in the map a point of the closed simplex is, by exact signs. `corners`: those of the simplex.
Placement placement(const CombinatorialMap& map, SimplexId simplex, const Corners& corners, const Vec3& x);

/// Whether a point is in a free cell, in a blocked cell or outside.
enum class Place : std::uint8_t { free, blocked, outside };

/// Where a point is in the scene.
struct Location {
  Place place = Place::outside;
  SimplexId simplex;         ///< invalid outside
  Kind kind = Kind::volume;  ///< kind of the map's cell that holds the point in its interior
  Dart dart;                 ///< of that face, edge or vertex; invalid for a volume
};

}  // namespace dartcast
