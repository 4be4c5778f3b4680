// Edits of the topology: split, merge, sew, part, remove. Each leaves a valid map or refuses and changes nothing.
//
// "Sewing, simplifying or cutting cells": T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for
// continuous collision detection in deformable environments", SPM 2009, section 6.2.
//
// Each edit replaces the cells that it touches, by Transaction::replace(): these are given new numbers, and darts of
// them are stale (see find_dart()). A cell made from another keeps its free mark and its source; a face keeps its
// patch, and so do both parts of one that is split. Of two faces merged the patch of the first is kept, or that of the
// second where the first has none. Costs are linear in the darts of the cells touched, times a logarithm.
//
// In the plane cells are polygons and their faces edges. split_face() makes two polygons of one there, merge_faces()
// and merge_cells() one of two; sew() and unsew() are about edges; split_cell() is refused.
//
// There are no coordinates here. The report of the transaction tells which vertices are new. What the caller may have
// to do before it commits:
//  - Interior points. A touched cell has none of its own any more, nor has a face whose corners changed; other faces
//    keep theirs, from both sides. An edit makes corners in which a face is straight (may_be_straight(): a vertex put
//    on an edge; the ends of an edge that was merged away) and neighbours in one plane (the parts of
//    a split face; faces around a merged one). These marks follow the cells until what they mark is gone, and are on
//    the safe side: a vertex may have moved since. A face that may be straight somewhere should be fanned from a point
//    of its own, and a cell with such a face, or with two faces in one plane, be coned from one: replace it by its own
//    draft with points in it. Signs of rounded midpoints do not tell.
//  - Validity. That cells are convex, and that what is merged lies in one plane or on one line, is not known here.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "dartcast/transaction.hpp"

namespace dartcast {

// All of these throw InvalidArgument where a dart, face or cell is not there (an earlier edit replaced it), and
// EditRefused, with the cell's source, the reason and what to do, where the result would be no map. Cells that they
// return are those that are new.

struct SplitEdge {
  Vertex vertex;
  std::vector<Cell> cells;
};

/// Puts a vertex on the edge of d, in all cells around it.
SplitEdge split_edge(Transaction& t, Dart d);

/// Joins the origins of two darts of a face by an edge; from both sides of the face. Refused where they are neighbours
/// in the face, or an edge of the cell joins them already. Returns the cell of a, then the one beyond the face; in the
/// plane the part with a, then the part with b.
std::vector<Cell> split_face(Transaction& t, Dart a, Dart b);

/// Cuts a cell in two along a closed path: each dart starts where the one before ends, the first where the last ends;
/// no vertex comes twice. Returns the cell with the faces of the path's darts, then that with the faces beyond its
/// edges. The new face between them has no patch. Refused where the path runs around a single face, and in the plane:
/// split_face() does it there.
std::array<Cell, 2> split_cell(Transaction& t, std::span<const Dart> path);

/// Makes one cell of the two at a face. Refused on the boundary, between a free and a blocked cell, and where the cells
/// touch beyond that face. The source is that of f.cell. In the plane, as merge_faces().
Cell merge_cells(Transaction& t, CellFace f);

/// Makes one face of the two at an edge; from both sides. Refused where there are more than two faces around the edge,
/// or where these have more than the edge in common. In the plane, as merge_cells(): one polygon.
std::vector<Cell> merge_faces(Transaction& t, Dart d);

/// Makes one edge of the two at the origin of d. Refused where there are more than two edges, and where a face is a
/// triangle there.
std::vector<Cell> merge_edges(Transaction& t, Dart d);

/// Sews a's face to b's, dart a to dart b: a's origin and b's end become one vertex, and so on around the faces. Of two
/// vertices the lower-numbered survives. Refused where a face is not open, or the faces have not as many corners, or a
/// cell would have one vertex twice.
std::vector<Cell> sew(Transaction& t, Dart a, Dart b);

/// Opens a face. A vertex whose darts fall apart by that is parted: the side of f.cell keeps it, the other side has a
/// new one. Refused on the boundary.
std::vector<Cell> unsew(Transaction& t, CellFace f);

/// Removes a cell; its neighbours' faces are open. Parts that still touch in a vertex or an edge keep it in common.
void remove(Transaction& t, Cell c);

/// The dart of the cell from one vertex to another; invalid where there is none. Cost: the cell's darts.
Dart find_dart(const CombinatorialMap& map, Cell c, Vertex from, Vertex to);

}  // namespace dartcast
