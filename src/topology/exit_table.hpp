// The ways from simplex to simplex of a shape, for walks that must not branch. A facet within the cell and a triangle
// of a face are passed by the same operations (tracking/batch/batch_line_walks.inl).
//
// A *row* is a simplex and one of its facets: 4 * simplex + facet. Its corners have an order. If the simplex is entered
// by the facet, the order is that of facet_corners. If it is left by it, the order is the opposite one, from the same
// corner on. So they turn the same way around the direction of travel. A *turn* is a shift of the corners in that
// order.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dartcast/cell_shape.hpp"
#include "topology/cell_rows.hpp"
#include "topology/facet_corners.hpp"

namespace dartcast::detail {

/// The way out of a simplex by one of its facets.
struct SimplexExit {
  std::uint16_t place = 0;       ///< the row beyond; or the triangle of the face, as the neighbour numbers it
  std::uint16_t word = 0;        ///< of the cell's record: the neighbour. 0 within the cell
  std::uint16_t extra = 0;       ///< the same in the general pool: the number that the neighbour gives, and the wall
  std::uint8_t outer = 0;        ///< 1: a triangle of a face; 0: within the cell
  std::uint8_t face_shift = 0;   ///< standard types, in the record's second word: the number that the neighbour gives
  std::uint8_t wall_shift = 31;  ///< the same: whether the face is a wall; within the cell a bit that is never set
  std::uint8_t turn = 0;         ///< which corner is the first one of the row beyond, or of the face's fan
};

/// The row that a simplex is entered by.
struct SimplexEntry {
  std::uint16_t row_and_turn = 0;  ///< 4 * row + turn
  std::uint16_t apex = 0;          ///< the corner opposite to the row's facet: its local number

  [[nodiscard]] unsigned row() const { return row_and_turn / 4; }
  [[nodiscard]] unsigned turn() const { return row_and_turn % 4; }
};

/// Those of one shape. Empty for polygons, flat shapes, and shapes that have too many simplices for numbers of 16 bits.
class ExitTable {
 public:
  static constexpr std::size_t max_simplices = 4095;
  static_assert(4 * (4 * max_simplices - 1) + 3 <= 0xffffU);       // SimplexEntry::row_and_turn
  static_assert(4 * max_simplices + Shape::max_darts <= 0xffffU);  // numbers of entries

  explicit ExitTable(const Shape& shape);

  [[nodiscard]] bool empty() const { return first_.data() == nullptr; }
  /// Those of a simplex, by facets.
  [[nodiscard]] const SimplexExit* exits_of(unsigned simplex) const { return exits_.data() + 4 * std::size_t{simplex}; }
  /// The row beyond an exit to a place. `face`: 0 within the cell; else 1 + its number.
  [[nodiscard]] const SimplexEntry& entry(unsigned face, unsigned place) const {
    return entries_[first_[face] + place];
  }
  /// Those through the whole cell.
  [[nodiscard]] const CellRows& cell_rows() const { return cell_rows_; }

 private:
  void add_rows(const Shape& shape);
  void add_faces(const Shape& shape);

  std::vector<SimplexExit> exits_;
  std::vector<std::uint16_t> first_;   // entry of each face, after that of the rows themselves
  std::vector<SimplexEntry> entries_;  // all rows; then the triangles of each face
  CellRows cell_rows_;
};

/// The corners by which a row's facet is left.
constexpr std::array<std::uint8_t, 3> exit_corners(unsigned facet) {
  return {facet_corners[facet][0], facet_corners[facet][2], facet_corners[facet][1]};
}

}  // namespace dartcast::detail
