// Farther walks: through hexahedra cell by cell (batch_cell_lanes.inl), from the first face that they cross on. If a
// cell is undecided, or the target is near, they go from simplex to simplex (batch_far_walks.inl), and on through cells
// behind the next face. Part of the batch's kernel (tracking/batch/batch_kernel.inl).
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "tracking/batch/batch_cell_lanes.inl"
#include "tracking/batch/batch_far_walks.inl"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

inline constexpr std::uint32_t cell_lanes = 16;

// A walk between the two ways of walking: it has entered a cell by a triangle of a face.
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

  [[nodiscard]] std::uint32_t all_tests() const { return tests + 3 * passed; }
};

// They are read from the front on. Places that have been read are written again.
struct CellWalkQueue : BatchList<CellWalk> {
  std::uint32_t next = 0;     // to be read
  std::uint32_t written = 0;  // since read_again()

  void write(const CellWalk& walk) { at[written++] = walk; }
  void read_again() {
    count = written;
    next = written = 0;
  }
  [[nodiscard]] Double4 reaches(const Index4& k) const {
    return Double4{at[k.at[0]].reach, at[k.at[1]].reach, at[k.at[2]].reach, at[k.at[3]].reach};
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

  // Leaves it, and prefetches the cell beyond. Returns 1 if that is a wall, or no hexahedron.
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

// The walks in the queue, which afterwards has those that must go on from simplex to simplex. It works in turns of
// three passes. The far corners of all cells are found, and prefetched. Eight walks at a time pass their cells, and
// their next cells are prefetched. Walks that end, or leave the cells, are looked at.
class CellLoop {
 public:
  CellLoop(Batch<false>& batch, CellWalkQueue& queue)
      : b(batch), queue_(queue), records_(batch.map.record(Cell(hexahedra, 0))) {
    for (FarCorners8& corners : far_corners_) corners.set_all(b.now);  // lanes without a walk read them, too
    for (CellPlace& place : places_) place.rows_of = CellPlace::no_shape;
  }

  void run() {
    std::uint32_t live = 0;
    for (std::uint32_t l = 0; l < cell_lanes; ++l) live |= (start_next(l) ? 1U : 0U) << l;
    for (std::uint32_t turn = 1; live != 0; ++turn) {
      if (turn % turns_at_once == 0) [[unlikely]]
        live = stop(live);
      for (std::uint32_t l = 0; l < cell_lanes; l += 8) find_rows(l, live >> l);
      std::uint32_t marked = 0;
      for (std::uint32_t l = 0; l < cell_lanes; l += 8) {
        const std::uint32_t here = (live >> l) & 255U;
        if (here != 0) marked |= pass_eight(l, here) << l;
      }
      for (; marked != 0; marked &= marked - 1) {
        const auto l = static_cast<std::uint32_t>(std::countr_zero(marked));
        leave(l);
        if (!start_next(l)) live ^= 1U << l;
      }
    }
  }

 private:
  // As LineLoop::stop().
  [[gnu::cold, gnu::noinline]] std::uint32_t stop(std::uint32_t live) {
    for (std::uint32_t l = 0; l < cell_lanes; ++l) {
      const CellPlace& place = places_[l];
      const std::uint64_t tests = place.walk.all_tests() + std::uint64_t{CellWalks8::sides_asked} * place.cells;
      if (((live >> l) & 1U) == 0 || tests <= max_line_tests(b.simplex_count)) continue;
      b.defer(place.walk.particle);
      if (!start_next(l)) live ^= 1U << l;
    }
    return live;
  }

  // Begins the next walk in lane l. Returns false if there is none.
  bool start_next(std::uint32_t l) {
    if (queue_.next == queue_.count) return false;
    if (queue_.next % 4 == 0) stage();
    walks_[l / 8].begin(l % 8, starts_, queue_.next % 4);
    places_[l].begin(queue_.at[queue_.next++]);
    return true;
  }

  // Prepares four walks.
  void stage() {
    const Index4 k = index4_from(queue_.next, queue_.count);
    const std::uint32_t* near[4][4];
    for (unsigned l = 0; l < 4; ++l) {
      const CellWalk& walk = queue_.at[k.at[l]];
      const CellRows& rows = b.map.view(Cell(walk.cell), walk.record).shape().exits().cell_rows();
      const CellRow& row = rows[CellEntry(walk.face, walk.triangle).row()];
      for (unsigned i = 0; i < 4; ++i) near[i][l] = walk.record + 2U + row.near[i];
    }
    const Index4 particles = queue_.particles(queue_.next);
    starts_.line = Lines4(b.places_of(particles), b.targets_of(particles));
    starts_.line.reach_to(queue_.reaches(k));
    for (unsigned i = 0; i < 4; ++i) {
      const auto& of = near[i];
      starts_.near[i] = starts_.line.project(load_vec3x4(b.now[*of[0]], b.now[*of[1]], b.now[*of[2]], b.now[*of[3]]));
    }
  }

  // Walks from lane l on are in their next cells. Prefetches what these need.
  void find_rows(std::uint32_t l, std::uint32_t live) {
    FarCorners8& corners = far_corners_[l / 8];
    for (unsigned k = 0; k < 8; ++k) {
      if (((live >> k) & 1U) == 0) continue;
      CellPlace& place = places_[l + k];
      place.enter(b.map);
      corners.diagonals[k] = static_cast<int>(place.row->diagonals);
      for (unsigned i = 0; i < 4; ++i) {
        corners.at[i][k] = b.now + place.record[2U + place.row->far[i]];
        __builtin_prefetch(corners.at[i][k]);
        __builtin_prefetch(&corners.at[i][k]->z);
      }
    }
  }

  // Passes a cell of each walk in the lanes from l on that are in the mask `live`. Returns a mask of those to look at.
  std::uint32_t pass_eight(std::uint32_t l, std::uint32_t live) {
    CellWalks8& walks = walks_[l / 8];
    walks.pass(far_corners_[l / 8]);
    std::uint32_t out = 0;
    for (std::uint32_t k = 0; k < 8; ++k) {
      if (((live >> k) & 1U) != 0) out |= places_[l + k].leave(walks.exit[k], records_) << k;
    }
    return (walks.undecided | walks.near_end | out) & live;
  }

  // Ends a walk at a wall, or leaves it to walks from simplex to simplex. It is then in the cell that it has not
  // passed, or in one beyond that is no hexahedron. If its target is near, it passes no more cells.
  void leave(std::uint32_t l) {
    const CellWalks8& walks = walks_[l / 8];
    const CellPlace& place = places_[l];
    const std::uint32_t undecided = (walks.undecided >> (l % 8)) & 1U;
    const bool passed = (undecided | ((walks.near_end >> (l % 8)) & 1U)) == 0;
    CellWalk walk = place.walk;
    walk.record = place.record;
    walk.cell = place.cell(records_).value;
    walk.face = static_cast<std::uint16_t>(place.entry.row() / 4);
    walk.triangle = static_cast<std::uint16_t>(place.entry.triangle());
    walk.tests += CellWalks8::sides_asked * (place.cells - (passed ? 0 : 1));
    walk.to_cells = undecided != 0;
    if (!passed) return queue_.write(walk);
    const CellView cell = b.map.view(Cell(walk.cell), walk.record);
    const CellWay& way = place.row->ways[static_cast<unsigned>(walks.exit[l % 8])];
    if (place.wall != 0) {
      const Across wall = cell.shape().entry(way.face, way.triangle);
      const WalkCursor cursor = {walk.particle,    walk.cell, wall.index, wall.place,
                                 walk.all_tests(), 0,         entered,    walk.record};
      b.end_at_wall(cursor, corners_of(b.map, cursor), wall.place);
      return;
    }
    const Cell beyond = cell.neighbour(way.face);
    walk.record = b.map.record(beyond);
    walk.cell = beyond.value;
    walk.face = cell.neighbour_face(way.face);
    walk.triangle = static_cast<std::uint16_t>(place.next_entry.triangle());
    walk.to_cells = true;
    queue_.write(walk);
  }

  Batch<false>& b;
  CellWalkQueue& queue_;
  const std::uint32_t* records_;  // of hexahedra
  std::array<CellWalks8, cell_lanes / 8> walks_;
  std::array<CellPlace, cell_lanes> places_;
  std::array<FarCorners8, cell_lanes / 8> far_corners_;
  CellStarts4 starts_;
};

// Such walks from simplex to simplex, up to their first hexahedron, and wherever a cell is undecided.
class WalksToCells : public FarWalks<false> {
 public:
  WalksToCells(Batch<false>& batch, const BatchList<WalkStart>& farther, BatchList<WalkCursor>& rounds)
      : FarWalks(batch, farther, rounds) {}

  void run() {
    LineLoop<false, WalksToCells> loop(b, *this);
    loop.run();
    while (queue_.written != 0) {
      queue_.read_again();
      CellLoop(b, queue_).run();
      queue_.read_again();
      loop.run();
    }
  }

  bool start_next(std::uint32_t l) {
    if (FarWalks::start_next(l)) {
      set_to_cells(l, in_range_of_floats(walks[l / 4].line, l % 4));
      return true;
    }
    return resume_next(l);
  }
  [[nodiscard]] std::uint32_t stops(const LinePlace* at, std::uint32_t l) const {
    std::uint32_t crossed = 0;
    for (std::uint32_t k = 0; k < 4; ++k) crossed |= (at[k].face != 0 ? 1U : 0U) << k;
    return crossed & (to_cells_ >> l);
  }
  void pass_target(std::uint32_t l) { set_to_cells(l, false); }
  bool goes_on(std::uint32_t l) {
    const LinePlace& at = places[l];
    if (((to_cells_ >> l) & 1U) == 0 || at.face == 0 || Cell(at.cell).pool() != hexahedra) return true;
    const auto face = static_cast<std::uint16_t>(at.face - 1);
    const auto triangle = static_cast<std::uint16_t>(at.place);
    queue_.write(
        {at.record, walks[l / 4].line.reach[l % 4], at.particle, at.cell, face, triangle, at.passed, at.tests, true});
    return false;
  }

 private:
  // Resumes the next walk that has passed cells. Returns false if there is none.
  bool resume_next(std::uint32_t l) {
    while (queue_.next < queue_.count) {
      if (queue_.next % 4 == 0) stage();
      const auto from = static_cast<unsigned>(queue_.next % 4);
      const CellWalk& walk = queue_.at[queue_.next++];
      if (walk.all_tests() > max_line_tests(b.simplex_count)) [[unlikely]] {
        b.defer(walk.particle);
        continue;
      }
      const unsigned row = row_behind(walk);
      walks[l / 4].begin(l % 4, starts_, from, row % 4);
      places[l].begin(walk.particle, walk.cell, walk.record, row, walk.passed, walk.tests);
      set_to_cells(l, walk.to_cells);
      return true;
    }
    return false;
  }

  // Prepares four walks.
  void stage() {
    const Index4 k = index4_from(queue_.next, queue_.count);
    VertexNumbers v[4];
    for (unsigned l = 0; l < 4; ++l) {
      const CellWalk& walk = queue_.at[k.at[l]];
      v[l] = corners_of_simplex(b.map.view(Cell(walk.cell), walk.record), row_behind(walk) / 4);
    }
    const Index4 particles = queue_.particles(queue_.next);
    starts_ = LineStarts4(Corners4(b.now, v[0], v[1], v[2], v[3]), b.places_of(particles), b.targets_of(particles));
    starts_.line.reach_to(queue_.reaches(k));
  }

  // 4 * simplex + facet, behind the triangle that the walk has entered its cell by.
  [[nodiscard]] unsigned row_behind(const CellWalk& walk) const {
    const Across at = b.map.view(Cell(walk.cell), walk.record).shape().entry(walk.face, walk.triangle);
    return 4U * at.index + at.place;
  }
  void set_to_cells(std::uint32_t l, bool to_cells) {
    to_cells_ = (to_cells_ & ~(1U << l)) | (to_cells ? 1U : 0U) << l;
  }

  CellWalkQueue queue_;
  std::uint32_t to_cells_ = 0;  // a bit for each lane: from the next face on the walk may pass whole hexahedra
};

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
