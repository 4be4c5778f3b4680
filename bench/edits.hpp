// How fast the topology is edited while there are particles, and how fast the scene is checked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace dartcast::bench {

struct EditRow {
  std::size_t cells = 0;
  std::size_t particles = 0;
  std::size_t edits = 0;
  double edits_per_second = 0.0;  ///< each committed by itself and followed by all particles
  std::size_t splits = 0;         ///< those that put a vertex on an edge
  double split_seconds = 0.0;     ///< all of them, without the particles
  double splits_per_second = 0.0;
  double cells_touched = 0.0;         ///< on average: removed, added, marked
  double particles_touched = 0.0;     ///< on average
  double validity_ns_per_cell = 0.0;  ///< one pass over the scene, one thread
};

/// A box of `edge`^3 unit cubes, a tenth blocked. Edits, each at a random cell and each undone by the next one: a
/// vertex is put on an edge, a face is split, two cells are merged, a cell is blocked. The first ones are not timed:
/// they count the map's cells and list the particles by cell, once.
EditRow edit_box(std::uint32_t edge, std::size_t particles, std::size_t edits);

std::string edits_text(std::span<const EditRow> rows);
std::string edits_json(std::span<const EditRow> rows);

}  // namespace dartcast::bench
