// The touches of one element of a solid and the walls around it, on a straight way.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/solids.hpp"
#include "dynamics/near_walls.hpp"
#include "predicates/moving_pair.hpp"
#include "solids/elements.hpp"
#include "solids/wall_parts.hpp"

namespace dartcast {

/// The straight way of all vertices of solids, t in [0, 1]. No coordinate is between 0 and 2^-300 (flushed()).
struct SolidMotion {
  std::span<const Vec3> from;
  std::span<const Vec3> to;
  /// Parts that come as near as this touch, too. If the same span is given twice, all that are as near do, at the time 0.
  double margin = 0.0;

  [[nodiscard]] bool at_rest() const { return from.data() == to.data(); }
};

/// The box of an element's way, without the margin.
inline Box way_of(const SolidElement& e, const SolidMotion& motion) {
  Box box = way_of(motion.from[e.vertex[0]], motion.to[e.vertex[0]]);
  for (unsigned i = 1; i < e.count; ++i) box = join(box, way_of(motion.from[e.vertex[i]], motion.to[e.vertex[i]]));
  return box;
}

/// A part of an element and a part of a wall that touch, and when they first do.
struct ElementTouch {
  double time = 0.0;
  SolidContactKind kind = SolidContactKind::vertex_face;
  std::uint8_t count = 0;       ///< of the element's vertices that take part
  std::uint8_t wall_count = 0;  ///< of the wall's corners that take part: 4 - count
  std::array<std::uint32_t, 3> vertices{};
  std::array<std::uint8_t, 3> corners{};  ///< of the wall
  NearWall wall;
  std::optional<MovingTriangle> beside = {};  ///< of an edge-edge touch: the other wall triangle at the edge
  std::uint32_t element = 0;                  ///< its place in the group of find()
  double distance = 0.0;                      ///< if the motion is at rest
};

/// Elements of one solid, and the cell of each one's first vertex at the start.
struct ElementGroup {
  std::span<const SolidElement> elements;
  std::span<const Cell> cells;
};

/// Memory of the search, for one thread at a time. After a few elements it allocates no more.
class TouchFinder {
 public:
  /// Appends the touches to `touches`, in the order of the search, up to the cells that become flat. `cell` holds the
  /// element's first vertex at the start. Preconditions: the element touches no wall at the start; `walls` covers all
  /// vertices of the complex.
  void find_touches(const CellComplex& complex, Cell cell, const SolidElement& element, const SolidMotion& motion,
                    const VertexMotion& walls, std::vector<ElementTouch>& touches);

  /// The touches of many elements. Those that are small and near each other share one search. Returns the last time
  /// known before a cell that an element reaches becomes flat, if one does: touches are complete up to there alone.
  std::optional<double> find(const CellComplex& complex, const ElementGroup& group, const SolidMotion& motion,
                             const VertexMotion& walls, std::vector<ElementTouch>& touches);

  /// Appends the touches with these walls alone. Precondition: no other is in the element's way.
  void find_among(WallParts& walls, const SolidElement& element, const SolidMotion& motion,
                  std::vector<ElementTouch>& touches);

  /// Pairs that find() has looked at so far.
  [[nodiscard]] std::uint64_t pairs() const { return pairs_; }
  /// Those of the last find().
  [[nodiscard]] std::span<const Cell> cells_reached() const { return near_.cells_reached(); }
  [[nodiscard]] std::span<const NearWall> walls() const { return parts_.walls(); }

 private:
  struct Search {
    const CellComplex& complex;
    const ElementGroup& group;
    const SolidMotion& motion;
    const VertexMotion& walls;
    std::vector<ElementTouch>& touches;
  };

  bool ask(detail::PairKind kind, const detail::MovingPair& pair, const SolidMotion& motion, const ElementTouch& touch,
           std::vector<ElementTouch>& touches);
  bool ask_near(detail::PairKind kind, const detail::MovingPair& pair, const SolidMotion& motion,
                const ElementTouch& touch, std::vector<ElementTouch>& touches);
  void ask_corners(const WallParts& walls, const SolidElement& e, const SolidMotion& motion,
                   std::vector<ElementTouch>& touches);
  void ask_sides(WallParts& walls, const SolidElement& e, const SolidMotion& motion,
                 std::vector<ElementTouch>& touches);
  void ask_face(WallParts& walls, const SolidElement& e, const SolidMotion& motion, std::vector<ElementTouch>& touches);
  void widen_boxes(double margin);
  void find_part(const Search& search, std::size_t begin, std::size_t end);
  void find_together(const Search& search, std::size_t begin, std::size_t end);
  void find_each(const Search& search, std::size_t begin, std::size_t end);
  void ask_all(const Search& search, std::size_t element);
  std::optional<double> first_flat_of_reached(const CellComplex& complex, const VertexMotion& walls);
  NearWalls near_;
  WallParts parts_;            // of the last search
  std::vector<Cell> reached_;  // by elements
  std::vector<Box> boxes_;     // of the elements' ways
  std::uint64_t pairs_ = 0;
};

}  // namespace dartcast
