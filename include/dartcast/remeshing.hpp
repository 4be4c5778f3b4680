// Local remeshing where cells are not valid any more. Each place becomes valid, or is reported and left as it is.
//
// After "Convexity": T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision
// detection in deformable environments", SPM 2009, section 6.3.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "dartcast/complex_edit.hpp"

namespace dartcast {

// Subdivision of a cell into one part for each corner, and the way back.
//
// After "Subdivisions": T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision
// detection in deformable environments", SPM 2009, section 7.3.

/// A subdivided cell: the data from which coarsen() makes it again. It names vertices, which other edits do not change.
struct Subdivision {
  Vertex middle;                     ///< of the cell: a corner of every part
  CellHandle part;                   ///< one of the parts: see update_after_edit()
  std::vector<Vertex> corners;       ///< of the cell, one part for each
  std::vector<Vertex> edge_middles;  ///< also those that existed before
  std::vector<Vertex> face_middles;
};

/// The effects of subdivide().
struct Subdivided {
  Subdivision subdivision;
  std::vector<Cell> cells;  ///< all new cells: the parts, in the order of the corners, then the cells around them
};

/// Cuts a cell into one part for each corner. The new vertices are the middles of the cell, of each face and of each
/// edge (means of corners). A hexahedron becomes 8 hexahedra, a tetrahedron 4. A corner with k edges gives a part with
/// 2 k faces. The cells around an edge get its middle as a corner in which their faces are straight. The neighbour
/// across a face has it split into the same quadrilaterals. Parts keep the free mark and the source, faces their
/// patch.
///
/// Middles that neighbours already have are used. So neighbours that are subdivided one after the other, any number
/// of times, conform. Faces that may lie in one plane (CombinatorialMap::flat()) count as one face with its middle.
/// For that, one vertex among them must be joined to a vertex on each edge. If there are several such vertices, those
/// next to the middle are taken. Other faces that may lie in one plane are subdivided separately.
///
/// Throws InvalidArgument if there is no such cell. Throws EditRefused, nothing changed, if a face would have
/// fewer than three corners, or the result would not be a map. Cost: that of the cells around the cell's edges.
Subdivided subdivide(ComplexEdit& edit, Cell c);

/// Makes the cell again. Returns it, then the new cells around it. Middles of faces and edges are removed if no
/// other cell needs them. A middle that a neighbour needs is removed when that neighbour is made again. Right after
/// subdivide() the map is as before, to the last face and mark, except for the numbers of the cells.
///
/// Throws InvalidArgument if the named part does not exist any more (update_after_edit() was not called). Throws
/// EditRefused, nothing changed, if parts are missing (they were subdivided themselves, merged or removed) or are
/// not all free or all blocked. Cost: that of the cells around the cell's edges.
std::vector<Cell> coarsen(ComplexEdit& edit, const Subdivision& subdivision);

/// Updates a subdivision. Call it after later edits next to the cell, and after the commit, which replaces its parts.
/// `added`: cells that the edit made (EditReport::added). Cost: the corners of these cells, if the named part is gone.
void update_after_edit(const CombinatorialMap& map, std::span<const Cell> added, Subdivision& subdivision);

/// Divides cells into their simplices, in which particles already are. So these stay where they are, and no wall moves.
/// Faces are split along their fans, on both sides. A Steiner point becomes a vertex at its place. Parts keep the free
/// mark and the source, faces their patch. Cells with one simplex stay as they are. A neighbour that would not be valid
/// with its split faces, or only with others that move, is divided, too. Returns the cells in the place of the given
/// ones. They are convex, so any plane can cut them.
///
/// Throws InvalidArgument if there is no such cell, or in the plane. Throws EditRefused, nothing changed, if a
/// cell has a simplex that is not positive, or needs a Steiner point after earlier edits, before commit(). Cost: that
/// of the cells and their neighbours.
std::vector<Cell> divide_into_simplices(ComplexEdit& edit, std::span<const Cell> cells);

/// How far a repair may reach.
struct RepairOptions {
  std::size_t max_cells = 64;  ///< the largest region that is merged
};

/// How a repair made the simplices positive.
enum class Mending : std::uint8_t {
  point,  ///< the cell is coned from a Steiner point
  moved,  ///< a vertex that only cells of the region have was moved (it is a new vertex)
  cut     ///< the region was merged, and cut into pyramids, in the plane triangles, around a new vertex
};

/// Cells that were repaired together.
struct MendedRegion {
  Mending how = Mending::point;
  std::vector<std::uint32_t> sources;  ///< of its cells, sorted
  std::vector<Cell> cells;             ///< the cells in their place
};

/// A cell that no method repaired, and why.
struct LeftCell {
  Cell cell;
  std::uint32_t source = 0;
  std::string reason;
};

/// The effects of a repair.
struct RepairReport {
  std::vector<MendedRegion> mended;
  std::vector<LeftCell> left;  ///< unchanged cells
};

/// Repairs cells that have a simplex that is not positive. Other given cells are ignored. For each cell in turn it
/// takes the first of these methods that makes all simplices positive, by exact signs:
///
///  - a Steiner point in the mean of its corners;
///  - a move of one of its corners, if only cells of the same kind (free or blocked) are around that corner;
///  - merging and cutting again. It tries the cell alone, then the cells around one of its corners, around several of
///    them, then all neighbours, and so on. It takes only cells of the same kind, at most as many as the options say.
///    The region's surface must have a kernel (a point from which all of it is seen from the inside).
///
/// Vertices on the surface of a region do not move, and vertices inside it are removed. The outer faces keep their
/// patches. A new cell has the source of the cell that had its outer face. Corners are tried by the number of such
/// cells around them, then by their numbers. Cells that fail are tried again after others were repaired.
///
/// If there are no such cells, or none can be repaired, the map stays as it is, to the last record. After edits in the
/// same ComplexEdit that have not been committed, cells are checked without the Steiner points that the commit gives
/// them. Throws InvalidArgument if there is no such cell. Cost: that of the largest regions tried, whatever the size
/// of the scene. If regions are connected, it is paid once for each repair.
RepairReport repair(ComplexEdit& edit, std::span<const Cell> cells, const RepairOptions& options = {});

}  // namespace dartcast
