// The ways through a hexahedron, for walks that pass whole cells (tracking/batch/batch_cell_walks.inl). A way goes from
// the face of entry to the triangle of exit.
//
// The entry face has corners a0 to a3, which turn around the direction of travel. Corner b_i is at the other end of
// the edge from a_i. So the lateral face i has the corners a_i, a_(i+1), b_(i+1), b_i, and the far face has b0 to b3.
// A *row* is an entry face and a turn: the place among a0 to a3 of the corner that the face's fan begins at.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dartcast/cell_shape.hpp"

namespace dartcast::detail {

/// The way out by one triangle, for a hexahedron of a standard type.
struct CellWay {
  std::uint8_t word = 0;        ///< of the cell's record: the neighbour
  std::uint8_t face_shift = 0;  ///< in the record's second word: the number that the neighbour gives to the face
  std::uint8_t wall_shift = 0;  ///< the same: whether the face is a wall
  std::uint8_t beyond = 0;      ///< turn of the row beyond, and 32 times the triangle as the neighbour numbers it
  std::uint8_t face = 0;
  std::uint8_t triangle = 0;  ///< of that face's fan
};

/// Where a walk has entered a hexahedron: a row, and which triangle. A row has 5 bits: cells of other kinds may have more
/// than eight faces, and no walk passes them whole.
class CellEntry {
 public:
  CellEntry() = default;
  /// Precondition: `face` is below 6, and `triangle` below 2.
  CellEntry(unsigned face, unsigned triangle) : bits_(4 * face + 32 * triangle) {}
  /// Beyond a way out. `face`: as the cell there numbers it, and below 8. If that cell is no hexahedron, only the
  /// triangle counts.
  CellEntry(unsigned face, const CellWay& way) : bits_(4 * face + way.beyond) {}

  [[nodiscard]] unsigned row() const { return bits_ % 32; }
  [[nodiscard]] unsigned triangle() const { return bits_ / 32; }

 private:
  std::uint32_t bits_ = 0;
};

struct alignas(64) CellRow {
  std::array<std::uint8_t, 4> near{};  ///< local numbers of a0 to a3
  std::array<std::uint8_t, 4> far{};   ///< and of b0 to b3
  /// Bit i < 4: the diagonal of lateral face i ends at a_(i+1) and b_i; else at a_i and b_(i+1). Bit 4: that of the far
  /// face ends at b1 and b3; else at b0 and b2.
  std::uint32_t diagonals = 0;
  /// Number 2 i: the triangle of lateral face i at the edge a_i a_(i+1). 2 i + 1: that at b_i b_(i+1). In the next row
  /// a_i, a_(i+1), b_(i+1), b_i come first to last. 8 and 9: the triangles of the far face at b1 b2 and at b3 b0. In the
  /// next row b0 to b3 do.
  std::array<CellWay, 10> ways{};
};

/// Those of one shape. Empty if it is no hexahedron.
class CellRows {
 public:
  CellRows() = default;
  explicit CellRows(const Shape& shape);

  /// Number 4 * face + turn.
  [[nodiscard]] const CellRow& operator[](unsigned row) const { return rows_[row]; }
  [[nodiscard]] const CellRow* data() const { return rows_.data(); }

 private:
  std::vector<CellRow> rows_;
};

}  // namespace dartcast::detail
