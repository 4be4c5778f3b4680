// Refinement: a cell into one part for each corner, and back again.
//
// "Subdivisions": T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision
// detection in deformable environments", SPM 2009, section 7.3.
#pragma once

#include <span>
#include <vector>

#include "dartcast/complex_edit.hpp"

namespace dartcast {

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

}  // namespace dartcast
