// The walls near a sphere, or near a point, an edge or a triangle that moves. The search starts in the cell of the
// centre, or of the first corner. It goes through the faces that the sphere or the element reaches.
//
// It never searches the whole scene, and never looks through a wall. It always finds the wall that is touched first.
// For a sphere: the straight way from the centre to the point of contact crosses free cells alone, through faces that
// the sphere meets. For an element: until the first touch it is connected, and in free cells alone. Follow its first
// corner up to the time of that touch, then the element to the point of contact. This way passes from cell to cell only
// through faces that the element meets at some time.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/contact.hpp"
#include "dartcast/dynamics.hpp"
#include "dartcast/particle_state.hpp"
#include "dynamics/places_between.hpp"
#include "dynamics/swept_sphere.hpp"
#include "mesh/box_tree.hpp"

namespace dartcast {

/// A fan triangle of a wall face of a free cell. In the plane an edge: its second corner twice.
struct NearWall {
  CellFace face;  ///< of the free cell
  std::uint16_t triangle = 0;
  std::array<std::uint16_t, 3> local{};  ///< numbers of the corners in the cell
  std::array<Vertex, 3> vertex;
  MovingTriangle corners;  ///< before and after the last move of the vertices; both as they are now without a move
};

/// A point, an edge or a triangle whose corners move on straight lines, t in [0, 1].
struct MovingElement {
  std::array<Vec3, 3> from{};
  std::array<Vec3, 3> to{};
  unsigned count = 1;  ///< of corners: 1, 2 or 3
};

/// The positions of all vertices before and after a move. The same span twice: they do not move.
struct VertexMotion {
  std::span<const Vec3> before;
  std::span<const Vec3> after;
  PlacesBetween* places = nullptr;  ///< computes both for each cell that a search comes to; none: all are there

  [[nodiscard]] bool at_rest() const { return before.data() == after.data(); }
};

// In large scenes most of the time of a search is that of memory. So what it reads is brought to the caches ahead. A record
// or a corner may lie on two lines. Inlined: the compiler would drop calls that only prefetch.

/// For a cell that a search comes to soon.
[[gnu::always_inline]] inline void prefetch_record(const CellComplex& complex, Cell c) {
  constexpr int line = 15;  // numbers on from the first
  __builtin_prefetch(complex.map().record(c));
  __builtin_prefetch(complex.map().record(c) + line);
}
/// For the next cell, whose record is in the caches: its corners, and its neighbours' records.
[[gnu::always_inline]] inline void prefetch_cell(const CellComplex& complex, Cell c, const VertexMotion& motion) {
  if (motion.places != nullptr) return;
  const CellView cell = complex.map().view(c);
  for (std::uint16_t f = 0; f < cell.shape().face_count(); ++f) {
    if (!cell.is_wall(f)) prefetch_record(complex, cell.neighbour(f));
  }
  for (const std::uint32_t v : cell.vertices()) {
    __builtin_prefetch(&motion.after[v].x);
    __builtin_prefetch(&motion.after[v].z);
    __builtin_prefetch(&motion.before[v].x);
    __builtin_prefetch(&motion.before[v].z);
  }
}

/// A place on the walls that a sphere may touch.
struct WallFeature {
  Vec3 point;
  Vec3 normal;             ///< unit, from the point to the centre; if these are equal, the wall's own
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

  /// Walls that the element may touch on its way, or come as near to as `margin`. `cell` holds the first corner before
  /// the move, and no wall is in the element's way from there to its other corners. Preconditions: all cells that it reaches
  /// are positive during the whole move; margin >= 0. All else is as above. Cost: an edge as long as a cell reaches some 5
  /// cells, a triangle 6.
  std::span<const NearWall> search(const CellComplex& complex, Cell cell, const MovingElement& element,
                                   const VertexMotion& motion, double margin = 0.0);

  /// The same for a point that goes from `from` to `to`: the walls that it may touch. It looks in a frame that moves with
  /// the cell's vertices, so it reaches fewer cells.
  std::span<const NearWall> search_way(const CellComplex& complex, Cell cell, const Vec3& from, const Vec3& to,
                                       const VertexMotion& motion);

  /// Walls that meet a box on their way, for all elements that stay in it: those of search() for each, and more. `starts`:
  /// the cells that hold the elements' first corners before the move. All else is as above.
  std::span<const NearWall> search(const CellComplex& complex, std::span<const Cell> starts, const Box& box,
                                   const VertexMotion& motion);

  /// The nearest point to `centre` of each wall of the last search, as the wall was before the move. Valid until the
  /// next search or call of this.
  std::span<const NearestOnTriangle> nearest(const Vec3& centre);

  /// The places on walls, as these stand now. Each is at most `reach` from `centre`, and nearer to it than all of the
  /// wall around the place. So a vertex or an edge of a wall that is nearer elsewhere does not count. Each is there
  /// once, however many triangles share it. Sorted by distance, equal ones in the order of the search. `displacement`
  /// is that of the last move if `moved` is set, else 0. Valid until the next search. Cost: that of the search, and 0.1
  /// us a triangle.
  std::span<const WallFeature> within(const CellComplex& complex, Cell cell, const Vec3& centre, double reach,
                                      bool moved);

  /// The place of one wall's triangle that is nearest to `centre`. `moved`: as above.
  [[nodiscard]] static WallFeature place_on(const CellComplex& complex, CellFace face, std::uint16_t triangle,
                                            const Vec3& centre, bool moved);

  /// Calls visit(wall) for each triangle of a wall face in the last move, if its corners are in the exact range.
  template <class Visit>
  static void for_each_triangle(const CellComplex& complex, CellFace face, Visit&& visit) {
    const CellView cell = complex.map().view(face.cell);
    for (std::uint16_t t = 0; t < cell.shape().triangle_count(face.face); ++t) {
      const NearWall wall = wall_at(cell, face, t, complex.previous_positions(), complex.positions());
      if (is_in_range(wall)) visit(wall);
    }
  }

  /// Cells that the last search looked at, in the order in which it reached them.
  [[nodiscard]] std::span<const Cell> cells_reached() const { return cells_; }

 private:
  struct Reach;

  static NearWall wall_at(const CellView& cell, CellFace face, std::uint16_t triangle, std::span<const Vec3> before,
                          std::span<const Vec3> after);
  static bool is_in_range(const NearWall& wall);
  [[nodiscard]] std::size_t slot(Cell c) const;
  void grow();
  void add(Cell c);
  std::span<const NearWall> run(const CellComplex& complex, std::span<const Cell> starts, const Reach& reach,
                                const VertexMotion& motion);
  void visit(const CellComplex& complex, const Reach& reach, Cell c, const VertexMotion& motion);
  static void describe(const CellComplex& complex, const NearWall& wall, const NearestOnTriangle& nearest, bool moved,
                       WallFeature& feature);
  void add_walls(const CellComplex& complex, const Reach& reach, CellFace face, const VertexMotion& motion);

  std::vector<Cell> cells_;           // in the order in which they were reached
  std::vector<std::uint32_t> table_;  // of cells reached: one more than the place in cells_, 0 if empty
  std::vector<std::size_t> slots_;    // of cells_, in the table
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
