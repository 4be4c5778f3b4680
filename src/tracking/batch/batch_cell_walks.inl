// Far walks through hexahedra, cell by cell (batch_cell_lanes.inl), from the first face that they cross on. Where a cell
// is undecided, or the target is near, simplices are asked again (batch_far_walks.inl). Part of the batch's kernel
// (tracking/batch/batch_kernel.inl).
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "tracking/batch/batch_cell_lanes.inl"
#include "tracking/batch/batch_cell_records.inl"
#include "tracking/batch/batch_steps.inl"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// The walks in by_cells_, which afterwards has those that must go on from simplex to simplex. In turns, each of three
// passes: the far corners of all cells are found, and prefetched; eight walks at a time pass their cells, and their next
// cells are prefetched; walks that end, or leave the cells, are looked at.
template <CacheKind kind>
void Batch<kind>::walk_cells() {
  staged_ = 0;
  for (FarCorners8& corners : far_corners_) corners.set_all(now_);  // lanes without a walk read them, too
  for (CellPlace& place : cell_places_) place.rows_of = CellPlace::no_shape;
  std::uint32_t live = 0;
  for (std::uint32_t l = 0; l < cell_lanes; ++l) live |= (start_next_cell(l) ? 1U : 0U) << l;
  while (live != 0) {
    if (++turns_ % turns_at_once == 0) [[unlikely]]
      live = stop_cells(live);
    for (std::uint32_t l = 0; l < cell_lanes; l += 8) find_rows(l, live >> l);
    std::uint32_t marked = 0;
    for (std::uint32_t l = 0; l < cell_lanes; l += 8) {
      const std::uint32_t here = (live >> l) & 255U;
      if (here != 0) marked |= pass_eight(l, here) << l;
    }
    for (; marked != 0; marked &= marked - 1) {
      const auto l = static_cast<std::uint32_t>(std::countr_zero(marked));
      leave_cells(l);
      if (!start_next_cell(l)) live ^= 1U << l;
    }
  }
}

// As stop_lines().
template <CacheKind kind>
std::uint32_t Batch<kind>::stop_cells(std::uint32_t live) {
  for (std::uint32_t l = 0; l < cell_lanes; ++l) {
    const CellPlace& place = cell_places_[l];
    const CellWalk& walk = place.walk;
    const std::uint64_t tests = walk.tests + 3ULL * walk.passed + std::uint64_t{CellWalks8::sides_asked} * place.cells;
    if (((live >> l) & 1U) == 0 || tests <= most_line_tests_) continue;
    defer(walk.particle);
    if (!start_next_cell(l)) live ^= 1U << l;
  }
  return live;
}

// Begins the next walk in lane l. Returns false where there is none.
template <CacheKind kind>
inline bool Batch<kind>::start_next_cell(std::uint32_t l) {
  if (by_cells_.next == by_cells_.count) return false;
  if (by_cells_.next == staged_) stage_cell_walks();
  const auto from = static_cast<unsigned>(by_cells_.next + 4 - staged_);
  cell_walks_[l / 8].begin(l % 8, cell_starts_, from);
  cell_places_[l].begin(by_cells_.take());
  return true;
}

// Prepares four walks.
template <CacheKind kind>
inline void Batch<kind>::stage_cell_walks() {
  const Index4 k = by_cells_.next_four();
  const std::uint32_t* near[4][4];
  for (unsigned l = 0; l < 4; ++l) {
    const CellWalk& walk = by_cells_.walks[k.at[l]];
    const CellRow& row =
        map_.view(Cell(walk.cell), walk.record).shape().exits().cell_rows()[CellEntry(walk.face, walk.triangle).row()];
    for (unsigned i = 0; i < 4; ++i) near[i][l] = walk.record + 2U + row.near[i];
  }
  const Index4 particles = by_cells_.particles(k);
  cell_starts_.line = Lines4(places_of(particles), targets_of(particles));
  cell_starts_.line.reach_to(by_cells_.reaches(k));
  for (unsigned i = 0; i < 4; ++i) {
    const auto& of = near[i];
    cell_starts_.near[i] =
        cell_starts_.line.project(load_vec3x4(now_[*of[0]], now_[*of[1]], now_[*of[2]], now_[*of[3]]));
  }
  staged_ = by_cells_.next + 4;
}

// Walks from lane l on are in their next cells. Prefetches what these need.
template <CacheKind kind>
inline void Batch<kind>::find_rows(std::uint32_t l, std::uint32_t live) {
  FarCorners8& corners = far_corners_[l / 8];
  for (unsigned k = 0; k < 8; ++k) {
    if (((live >> k) & 1U) == 0) continue;
    CellPlace& place = cell_places_[l + k];
    place.enter(map_);
    corners.diagonals[k] = static_cast<int>(place.row->diagonals);
    for (unsigned i = 0; i < 4; ++i) {
      corners.at[i][k] = now_ + place.record[2U + place.row->far[i]];
      __builtin_prefetch(corners.at[i][k]);
      __builtin_prefetch(&corners.at[i][k]->z);
    }
  }
}

// Passes a cell of each walk in the lanes from l on that are in the mask `live`. Returns a mask of those to look at.
template <CacheKind kind>
inline std::uint32_t Batch<kind>::pass_eight(std::uint32_t l, std::uint32_t live) {
  CellWalks8& walks = cell_walks_[l / 8];
  walks.pass(far_corners_[l / 8]);
  const std::uint32_t* const records = record_pools_[hexahedra].words;
  std::uint32_t out = 0;
  for (std::uint32_t k = 0; k < 8; ++k) {
    if (((live >> k) & 1U) == 0) continue;
    out |= cell_places_[l + k].leave(walks.exit[k], records) << k;
  }
  return (walks.undecided | walks.near_end | out) & live;
}

// Ends a walk at a wall, or leaves it to walks from simplex to simplex: in the cell that it has not passed, or in one
// beyond that is no hexahedron. Where its target is near, it passes no more cells.
template <CacheKind kind>
inline void Batch<kind>::leave_cells(std::uint32_t l) {
  const CellWalks8& walks = cell_walks_[l / 8];
  const CellPlace& place = cell_places_[l];
  const std::uint32_t undecided = (walks.undecided >> (l % 8)) & 1U;
  const bool passed = (undecided | ((walks.near_end >> (l % 8)) & 1U)) == 0;
  CellWalk walk = place.walk;
  walk.record = place.record;
  walk.cell = place.cell(record_pools_[hexahedra].words).value;
  walk.face = static_cast<std::uint16_t>(place.entry.row() / 4);
  walk.triangle = static_cast<std::uint16_t>(place.entry.triangle());
  walk.tests += CellWalks8::sides_asked * (place.cells - (passed ? 0 : 1));
  walk.to_cells = undecided != 0;
  if (!passed) return by_cells_.add(walk);
  const CellView cell = map_.view(Cell(walk.cell), walk.record);
  const CellWay& way = place.row->ways[static_cast<unsigned>(walks.exit[l % 8])];
  if (place.wall != 0) {
    const Across wall = cell.shape().entry(way.face, way.triangle);
    const std::uint32_t tests = walk.tests + 3 * walk.passed;
    const WalkCursor cursor = {walk.particle, walk.cell, wall.index, wall.place, tests, 0, entered, walk.record};
    end_at_wall(cursor, corners_of_walk(cursor), wall.place);
    return;
  }
  const Cell beyond = cell.neighbour(way.face);
  walk.record = map_.record(beyond);
  walk.cell = beyond.value;
  walk.face = cell.neighbour_face(way.face);
  walk.triangle = static_cast<std::uint16_t>(place.next_entry.triangle());
  walk.to_cells = true;
  by_cells_.add(walk);
}

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
