// Scratch records of walks that pass whole cells. Part of the batch's kernel.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "tracking/batch/batch.hpp"
#include "tracking/batch/batch_cell_lanes.inl"
#include "tracking/batch/batch_line_walks.inl"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// A walk between two ways of walking: it has entered a cell by a triangle of a face.
struct CellWalk {
  const std::uint32_t* record;  // of the cell
  double reach;                 // as in Lines4
  std::uint32_t particle;
  std::uint32_t cell;
  std::uint16_t face;  // as the cell numbers it, of whatever kind it is
  std::uint16_t triangle;
  std::uint32_t passed;  // simplices
  std::uint32_t tests;   // besides the three of each of these
  bool to_cells;         // from the next face on it may pass whole hexahedra again
};

// They are read from the front on. Places that have been read are written again.
struct CellWalkQueue {
  std::array<CellWalk, max_batch> walks;
  std::size_t count = 0;
  std::size_t next = 0;     // to be read
  std::size_t written = 0;  // since read_again()

  void add(const CellWalk& walk) { walks[written++] = walk; }
  const CellWalk& take() { return walks[next++]; }
  void read_again() {
    count = written;
    next = written = 0;
  }
  // Four to be read; at the end the last one again in the remaining lanes.
  [[nodiscard]] Index4 next_four() const {
    return index4_from(static_cast<std::uint32_t>(next), static_cast<std::uint32_t>(count));
  }
  [[nodiscard]] Index4 particles(const Index4& k) const {
    return {{walks[k.at[0]].particle, walks[k.at[1]].particle, walks[k.at[2]].particle, walks[k.at[3]].particle}};
  }
  [[nodiscard]] Double4 reaches(const Index4& k) const {
    return Double4{walks[k.at[0]].reach, walks[k.at[1]].reach, walks[k.at[2]].reach, walks[k.at[3]].reach};
  }
};

// Where a walk is that passes cells. Its cells are hexahedra of the standard type: their records follow one another.
struct CellPlace {
  static constexpr std::uint32_t no_shape = 0xffffffffU;

  const std::uint32_t* record;  // of the cell to pass
  CellEntry entry;
  std::uint32_t cells;  // passed, or tried to
  const CellRow* row;
  const std::uint32_t* next_record;  // beyond it
  CellEntry next_entry;
  std::uint32_t wall;     // 1: the way out
  const CellRow* rows;    // of the last shape
  std::uint32_t rows_of;  // its number
  CellWalk walk;          // at its start

  void begin(const CellWalk& w) {
    walk = w;
    next_record = w.record;
    next_entry = CellEntry(w.face, w.triangle);
    cells = 0;
  }

  // Goes on into the next cell.
  [[gnu::always_inline]] void enter(const CombinatorialMap& map) {
    record = next_record;
    entry = next_entry;
    ++cells;
    const std::uint32_t shape = record[0] & 0xffffU;
    if (shape != rows_of) find_rows(map, shape);
    row = rows + entry.row();
  }
  [[gnu::noinline]] void find_rows(const CombinatorialMap& map, std::uint32_t shape) {
    rows_of = shape;
    rows = map.view(Cell(hexahedra, 0), record).shape().exits().cell_rows().data();
  }

  // Leaves it, and prefetches the cell beyond. Returns 1 where that is a wall, or no hexahedron.
  [[gnu::always_inline]] std::uint32_t leave(int exit, const std::uint32_t* records) {
    const CellWay& way = row->ways[static_cast<unsigned>(exit)];
    const std::uint32_t bits = record[1];
    const Cell beyond(record[way.word]);
    wall = (bits >> (way.wall_shift & 31U)) & 1U;
    next_entry = CellEntry((bits >> (way.face_shift & 31U)) & 7U, way);
    next_record = records + std::size_t{words_of_hexahedron} * beyond.index();
    __builtin_prefetch(next_record);
    return wall | (beyond.pool() != hexahedra ? 1U : 0U);
  }

  [[nodiscard]] Cell cell(const std::uint32_t* records) const {
    return {hexahedra, static_cast<std::uint32_t>((record - records) / words_of_hexahedron)};
  }
};

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
