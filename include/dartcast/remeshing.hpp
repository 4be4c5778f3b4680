// Where cells are not valid any more: local remeshing until they are, or the place is named and left.
//
// "Convexity": T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision detection
// in deformable environments", SPM 2009, section 6.3.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "dartcast/complex_edit.hpp"

namespace dartcast {

// Refinement: a cell into one part for each corner, and back again.
//
// "Subdivisions": T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision
// detection in deformable environments", SPM 2009, section 7.3.

/// A cell that was subdivided: what is needed to make it again. It names vertices, which stay while others edit.
struct Subdivision {
  Vertex middle;                     ///< of the cell: a corner of every part
  CellHandle part;                   ///< one of the parts: see update_after_edit()
  std::vector<Vertex> corners;       ///< of the cell, one part for each
  std::vector<Vertex> edge_middles;  ///< also those that were there before
  std::vector<Vertex> face_middles;
};

struct Subdivided {
  Subdivision subdivision;
  std::vector<Cell> cells;  ///< all that are new: the parts, in the order of the corners, then those around them
};

/// Cuts a cell into one part for each corner, around a vertex in its middle, one in the middle of each face and one in
/// that of each edge (means of corners): a hexahedron into 8 hexahedra, a tetrahedron into 4; a corner with k edges
/// gives a part with 2 k faces. The cells around an edge take its middle as a corner in which their faces are straight,
/// the neighbour across a face has it split into the same quadrilaterals. Parts keep the free mark and the source,
/// faces their patch.
///
/// What neighbours have left of this kind is used, so that neighbours that are subdivided one after the other, any
/// number of times, conform: where faces may lie in one plane (CombinatorialMap::flat()) and have a vertex among them
/// that is joined to one on each edge, they are one face with its middle; of several vertices those next to the middle
/// are taken. Other faces that may lie in one plane are subdivided each by itself.
///
/// Throws InvalidArgument where there is no such cell; EditRefused, nothing changed, where a face would have fewer than
/// three corners, or the result would be no map. Cost: that of the cells around the cell's edges.
Subdivided subdivide(ComplexEdit& edit, Cell c);

/// Makes the cell again; returns it, then the cells around that are new. Middles of faces and edges go where no other
/// cell needs them: a face or edge that is needed by a neighbour goes when that is made again. Right after subdivide()
/// it leaves what was before, to the last face and mark, but for the numbers of the cells.
///
/// Throws InvalidArgument where the part named is not there any more (update_after_edit() was not called); EditRefused,
/// nothing changed, where the parts are not all there (they were subdivided themselves, merged or removed) or not all
/// free or all blocked. Cost: that of the cells around the cell's edges.
std::vector<Cell> coarsen(ComplexEdit& edit, const Subdivision& subdivision);

/// To be called for a subdivision after later edits next to it, and after the commit, which replace its parts. `added`:
/// cells that the edit made (EditReport::added). Cost: their corners, where the part named is gone.
void update_after_edit(const CombinatorialMap& map, std::span<const Cell> added, Subdivision& subdivision);

struct RepairOptions {
  std::size_t max_cells = 64;  ///< the largest region that is merged
};

enum class Mending : std::uint8_t {
  point,  ///< the cell is coned from a point of its own
  moved,  ///< a vertex around which there are only cells of the region lies elsewhere (it is a new vertex)
  cut     ///< the region was merged, and cut into pyramids, in the plane triangles, around a new vertex
};

struct MendedRegion {
  Mending how = Mending::point;
  std::vector<std::uint32_t> sources;  ///< of its cells, sorted
  std::vector<Cell> cells;             ///< in their place
};

struct LeftCell {
  Cell cell;
  std::uint32_t source = 0;
  std::string reason;
};

struct RepairReport {
  std::vector<MendedRegion> mended;
  std::vector<LeftCell> left;  ///< as they were: no part of the edit
};

/// Mends cells that have a simplex that is not positive; others among those given are passed over. For each in turn the
/// first of these that makes all simplices positive, by exact signs:
///  - a point of its own in the mean of its corners;
///  - moving one of its corners, around which there are only cells of the same kind (free or blocked);
///  - merging and cutting again: the cell alone, then the cells around one of its corners, around several of them, then
///    all neighbours, and so on; only cells of the same kind, at most so many as the options say. The region's surface
///    must have a kernel (a point from which all of it is seen from the inside).
/// No vertex on the surface of a region moves, vertices inside it go. The outer faces keep their patches; a new cell
/// takes the source of the cell that had its outer face. Corners are tried in the order of how many such cells
/// they have around them, then of their numbers. Cells that are left are tried again after others were mended.
///
/// Where there are no such cells, or none can be mended, the map is as it was, to the last record. After edits in
/// the same ComplexEdit that have not been committed, cells are judged without the points that the commit gives them.
/// Throws InvalidArgument where there is no such cell. Cost: that of the largest regions tried, whatever the size of
/// the scene; where regions hang together, so often as this mends one.
RepairReport repair(ComplexEdit& edit, std::span<const Cell> cells, const RepairOptions& options = {});

}  // namespace dartcast
