// The walls near a sphere. The search starts in the cell of the centre, and goes through the faces that the sphere
// reaches.
//
// It never searches the whole scene, and never looks through a wall. It always finds the wall that a sphere touches
// first: the straight way from the centre to the point of contact crosses free cells alone, through faces that the
// sphere meets.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/contact.hpp"
#include "dartcast/dynamics.hpp"
#include "dartcast/particle_state.hpp"
#include "dynamics/swept_sphere.hpp"

namespace dartcast {

/// A fan triangle of a wall face of a free cell. In the plane an edge: its second corner twice.
struct NearWall {
  CellFace face;  ///< of the free cell
  std::uint16_t triangle = 0;
  std::array<std::uint16_t, 3> local{};  ///< numbers of the corners in the cell
  std::array<Vertex, 3> vertex;
  MovingTriangle corners;  ///< before and after the last move of the vertices; both as they are now without a move
};

/// A place on the walls that a sphere may touch.
struct WallFeature {
  Vec3 point;
  Vec3 normal;             ///< unit, from the point to the centre; where these are equal, the wall's own
  double distance = 0.0;   ///< from the centre
  Vec3 displacement;       ///< of that point of the wall in the last move of the vertices
  Kind kind = Kind::face;  ///< of the map's cell that holds the point
  Dart dart;               ///< of that
  CellFace face;           ///< of the free cell
  std::uint16_t triangle = 0;
  Patch patch;

  /// With `normal` instead of the wall's own.
  [[nodiscard]] WallHit hit() const { return {face, triangle, patch, normal}; }
};

/// touching_bound as a length.
double touching_slack(const Vec3& centre, double radius);

/// Memory of searches, for one thread at a time. After a few searches none allocates.
class NearWalls {
 public:
  /// Walls that meet the box around a sphere on its way. `cell` holds `sphere.from`. `moving`: the vertices move from
  /// their previous positions to their current ones while the centre moves; else they do not move. The order is that
  /// of the search, which depends on the scene alone. Walls with a corner that is not finite are left out. Valid
  /// until the next search. Cost: 0.1 to 0.3 us for each cell reached (those which the sphere meets while it moves,
  /// and few more); each is looked at once.
  std::span<const NearWall> search(const CellComplex& complex, Cell cell, const MovingSphere& sphere, bool moving);

  /// The nearest point to `centre` of each wall of the last search, as the wall was before the move. Valid until the
  /// next search or call of this.
  std::span<const NearestOnTriangle> nearest(const Vec3& centre);

  /// The places on walls that are no farther from `centre` than `reach`, as the walls stand now, and nearer than all
  /// of the wall around them (so that a vertex or an edge of a wall that is nearer elsewhere does not count), each
  /// once, however many triangles share it. Sorted by distance, equal ones in the order of the search. `displacement`
  /// is that of the last move where `moved` is set, else 0. Valid until the next search. Cost: that of the search,
  /// and 0.1 us a triangle.
  std::span<const WallFeature> within(const CellComplex& complex, Cell cell, const Vec3& centre, double reach,
                                      bool moved);

  /// The place of one wall's triangle that is nearest to `centre`. `moved`: as above.
  [[nodiscard]] static WallFeature place_on(const CellComplex& complex, CellFace face, std::uint16_t triangle,
                                            const Vec3& centre, bool moved);

  /// Cells that the last search looked at.
  [[nodiscard]] std::size_t cells_reached() const { return cells_.size(); }

 private:
  struct Reach;

  [[nodiscard]] std::size_t slot(Cell c) const;
  void grow();
  void add(Cell c);
  void visit(const CellComplex& complex, const Reach& reach, Cell c, bool moving);
  static void describe(const CellComplex& complex, const NearWall& wall, const NearestOnTriangle& nearest, bool moved,
                       WallFeature& feature);
  void add_walls(const CellComplex& complex, const Reach& reach, CellFace face, bool moving);

  std::vector<Cell> cells_;           // in the order in which they were reached
  std::vector<std::uint32_t> table_;  // of cells reached: one more than the place in cells_, 0 where empty
  std::vector<std::size_t> slots_;    // of cells_, in the table
  std::vector<std::uint8_t> sides_;   // of a cell's points, while it is looked at
  std::vector<NearWall> walls_;
  std::vector<WallFeature> features_;
  std::vector<NearestOnTriangle> nearest_;   // of walls_
  std::vector<std::array<Vertex, 3>> keys_;  // the vertices of each feature found
};

/// NearWalls::within() for a particle of radius `reach`, or the like, at its state.
inline std::span<const WallFeature> walls_within(const CellComplex& complex, const ParticleState& state, double reach,
                                                 NearWalls& scratch, bool moved = false) {
  return scratch.within(complex, state.cell, state.position, reach, moved);
}

}  // namespace dartcast
