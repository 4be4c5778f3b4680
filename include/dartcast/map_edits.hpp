// Edits of the topology: split, merge, sew, unsew, remove. Each leaves a valid map, or is refused and changes nothing.
//
// After "Sewing, simplifying or cutting cells": T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism
// for continuous collision detection in deformable environments", SPM 2009, section 6.2.
//
// Each edit replaces the touched cells by Transaction::replace(). These get new numbers, and their darts are stale (see
// find_dart()). A cell made from another keeps its free mark and its source. A face keeps its patch; if it is split,
// both parts do. If two faces are merged, the result has the patch of the first, or of the second if the first has
// none. Costs are linear in the darts of the cells touched, times a logarithm.
//
// In the plane cells are polygons and their faces are edges. There split_face() makes two polygons of one.
// merge_faces() and merge_cells() make one polygon of two. sew() and unsew() act on edges. split_cell() is refused.
//
// There are no coordinates here. The transaction's report lists the new vertices. The caller may have to do two things
// before the commit. ComplexEdit (dartcast/complex_edit.hpp) does them.
//
//  - Steiner points. A touched cell loses its Steiner point, and so does a face whose corners changed. Other faces keep
//    theirs, on both sides. Edits make corners in which a face is straight (DraftCorner::straight). Such a corner is a
//    vertex that was put on an edge, or an end of an edge that was merged away. Edits also make neighbours in one plane
//    (DraftCorner::coplanar): the parts of a split face, or the faces around a merged one. These marks stay with the
//    cells until the marked place is gone. They are on the safe side, because a vertex may have moved since. A face
//    that may be straight somewhere needs a Steiner point. So does a cell with such a face, or with two faces in one
//    plane. Replace the cell by its own draft with points in it. Signs of rounded midpoints cannot decide this.
//  - Validity. The map does not know whether cells are convex, and whether merged cells lie in one plane or on one
//    line.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "dartcast/combinatorial_map.hpp"

namespace dartcast {

// Drafts: the cells that an edit puts in the place of others.
//
// In the plane the faces of a draft are its edges, each from its first corner to its second, one after another
// counterclockwise. Marks are at the first corner.

/// A corner of a face, and the edge from it to the next.
struct DraftCorner {
  Vertex vertex;
  bool straight = false;  ///< the face may be straight here: a vertex on an edge, or a split that was merged away
  bool coplanar = false;  ///< the cell's face beyond the edge may lie in the same plane
};

/// The other side of a draft's face. It is nothing, a face of a cell of the map, or a face of another draft of the same
/// call. If the named cell is one of the replaced cells, the draft's face that continues its face is meant.
struct DraftLink {
  static constexpr std::uint32_t no_draft = 0xffffffffU;

  CellFace face;
  std::uint32_t draft = no_draft;
  std::uint16_t draft_face = 0;
};

/// A face of a cell that is to be made.
struct DraftFace {
  std::vector<DraftCorner> corners;  ///< counterclockwise seen from the outside
  DraftLink across;
  CellFace from;  ///< the face of a replaced cell that this one continues; invalid if it is new
  Patch patch;
  Vertex point;  ///< its Steiner point, the same from both sides; invalid: it has none
};

/// A cell that is to be made, by its faces.
struct CellDraft {
  std::vector<DraftFace> faces;
  Vertex point;  ///< its Steiner point; invalid: it has none
  bool free = true;
  std::uint32_t source = 0;  ///< the number in the mesh, for errors and output
};

/// A draft of the current cell. Corner k of face f belongs to dart first_dart(f) + k. Faces keep their Steiner points.
/// The cell's own Steiner point is left out, because a new cone needs a new one. Precondition: contains(c).
CellDraft draft_of(const CombinatorialMap& map, Cell c);

/// The form in which a draft is written into a record.
struct DraftForm {
  std::uint32_t pool = CombinatorialMap::general_pool;
  std::vector<std::uint32_t> corners;  ///< in the record's order
  std::vector<std::uint16_t> local;    ///< general pool: place of each face's corners in these, one face after another
  std::vector<std::uint16_t> face;     ///< the record's number of each of the draft's faces
  std::string defect;                  ///< why it is not a cell; empty: it is one
};

/// Checks a draft by itself. It needs at least four faces of at least three distinct corners, and every edge once in
/// each direction. It must be the surface of a sphere, with points distinct from corners and at most 16383 darts. In
/// the plane it needs at least three edges that are one cycle of distinct corners. A draft without Steiner points
/// that is combinatorially a tetrahedron, hexahedron, prism, pyramid, triangle or quadrilateral takes that form.
/// Cost: linear in its darts, on average.
DraftForm form_of(const CellDraft& draft, unsigned dimension = 3);
/// The forms of several drafts, in order. Throws as form_of().
std::vector<DraftForm> forms_of(std::span<const CellDraft> drafts, unsigned dimension);

// Edits of a map: all or nothing.
//
// Everything that changes the cells of a map is one primitive, replace(): some cells are removed, others take their
// place. It checks everything before it changes anything, and records its changes, so that a transaction can undo every
// step. The functions below are the edits that users think in.

/// A new vertex: on the edge between two others, or a copy of one (then `from` and `other` are that one). The caller
/// gives its coordinates.
struct CreatedVertex {
  Vertex vertex;
  Vertex from, other;
};

/// A vertex that was merged into another. Cells that touch the merged cells only in the vertex keep it, so EditReport
/// lists deleted vertices separately.
struct MergedVertex {
  Vertex gone, merged_into;
};

/// All changes of a transaction.
struct EditReport {
  std::vector<CellHandle> removed;     ///< the handles that they had; stale now
  std::vector<Cell> added;             ///< in the place of those
  std::vector<Cell> marked;            ///< freed or blocked, otherwise unchanged
  std::vector<CreatedVertex> created;  ///< in order: `from` and `other` are older
  std::vector<MergedVertex> merged;    ///< in order: `merged_into` may itself be merged later
  std::vector<Vertex> deleted;         ///< in no cell any more (Steiner points, too): their numbers are used again
};

struct Replacement;

/// A sequence of edits. If it ends without a commit, everything is undone: the map is as before, to the last record,
/// number and version. While it is open, no other code may edit or copy the map, and no other transaction may be open
/// on it. Readers see the edits made so far. Numbers of removed cells and vertices are not used again before the
/// commit.
///
/// The first transaction on a map counts the cells of each vertex and lists the cells' sources. This cost is linear in
/// the map and occurs once. From then on the map needs four more bytes for each vertex and cell. After that the cost of
/// each function is that of the cells that it names and their neighbours, whatever the size of the map. Arrays grow by
/// doubling.
class Transaction {
 public:
  explicit Transaction(CombinatorialMap& map);
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  Transaction(Transaction&&) = delete;
  Transaction& operator=(Transaction&&) = delete;
  ~Transaction();

  [[nodiscard]] const CombinatorialMap& map() const { return map_; }

  /// Makes a vertex for drafts. A vertex that no cell uses at the commit is released.
  Vertex add_vertex(Vertex from, Vertex other);

  /// Removes cells and puts others in their place. Returns the new cells in the order of the drafts. Either list may be
  /// empty. New cells have new numbers. The cells around keep theirs, with their neighbours changed. Throws as
  /// plan_replacement() does; then this call has changed nothing.
  std::vector<Cell> replace(std::span<const Cell> removed, std::span<const CellDraft> drafts);

  /// As CombinatorialMap::set_free(), but undone with the transaction. Throws InvalidArgument if there is no such
  /// cell.
  void set_free(Cell c, bool free);

  /// Reports that one vertex is merged into another.
  void note_merged(Vertex gone, Vertex merged_into) { merged_.push_back({gone, merged_into}); }

  // The changes since the last commit.
  [[nodiscard]] std::size_t created_count() const { return created_.size(); }
  /// In order, including vertices that no cell uses.
  [[nodiscard]] const CreatedVertex& created(std::size_t i) const { return created_[i].vertex; }
  /// Cells that replaced others and still exist.
  [[nodiscard]] std::vector<Cell> added() const;
  /// Removed cells, of those that existed at the last commit. Until the next commit, map().view() shows them as they
  /// were when they were removed.
  [[nodiscard]] std::vector<Cell> removed() const;
  /// Cells that were freed or blocked and are otherwise unchanged; sorted.
  [[nodiscard]] std::vector<Cell> marked() const;
  [[nodiscard]] std::span<const MergedVertex> merged() const { return merged_; }

  /// A point in the sequence to which roll_back() can return.
  struct Savepoint {
    std::size_t words = 0, added = 0, removed = 0, created = 0, merged = 0, marked = 0;
  };
  [[nodiscard]] Savepoint savepoint() const;
  /// Undoes everything after the savepoint.
  void roll_back(const Savepoint& to);
  /// Undoes everything since the last commit.
  void roll_back() { roll_back(Savepoint{}); }

  /// Makes all edits final and reports them. The transaction can then continue with others.
  EditReport commit();

 private:
  struct OldWord {
    std::uint32_t pool;
    std::size_t at;
    std::uint32_t value;
  };
  struct AddedCell {
    Cell cell;
    bool appended;  // in a new place
    ShapeTable::Interned shape;
  };
  struct Created {
    CreatedVertex vertex;
    bool appended;
  };

  void prepare();
  void set_key(const CellDraft& draft, const DraftForm& form, std::vector<std::uint32_t>& vertices);
  void keep(Cell c, std::size_t offset);
  void keep_face(CellFace f);
  void count_vertices(Cell c, bool more);
  void take_away(Cell c);
  Cell put(const CellDraft& draft, const DraftForm& form);
  Cell open_place(std::uint32_t pool, std::uint32_t words);
  void take_back(const AddedCell& added);
  void link(const Replacement& plan, std::span<const Cell> cells);
  [[nodiscard]] std::uint32_t length_of(Cell c) const;
  void drop_last(std::uint32_t pool, std::uint32_t words);
  void vacate(Cell c);
  void write_sides(Cell c, const CellDraft& draft, const DraftForm& form);
  void clear_sides(Cell c);
  [[nodiscard]] std::vector<Cell> all_added() const;
  [[nodiscard]] EditReport report_cells() const;
  void release_vertices(EditReport& report);

  CombinatorialMap& map_;
  std::vector<OldWord> words_;
  std::vector<AddedCell> added_;
  std::vector<Cell> removed_;
  std::vector<Created> created_;
  std::vector<MergedVertex> merged_;
  std::vector<Cell> marked_;
  ShapeKey key_;  // of the last cell that was put; kept for its memory
};

// All edits below throw InvalidArgument if a dart, face or cell does not exist (an earlier edit replaced it). They
// throw EditRefused, with the cell's source, the reason and a remedy, if the result would not be a map. They return
// the new cells.

/// The vertex that split_edge() made, and the cells that have it.
struct SplitEdge {
  Vertex vertex;
  std::vector<Cell> cells;
};

/// Puts a vertex on the edge of d, in all cells around the edge.
SplitEdge split_edge(Transaction& t, Dart d);

/// Splits a face, on both its sides, with an edge between the origins of two of its darts. Refused if they are
/// neighbours in the face, or if an edge of the cell joins them already. Returns the cell of a, then the cell beyond
/// the face. In the plane: the part with a, then the part with b.
std::vector<Cell> split_face(Transaction& t, Dart a, Dart b);

/// Splits a cell along a closed path of darts. Each dart starts where the one before ends, the first where the last
/// ends, and no vertex comes twice. Returns the cell with the faces of the path's darts, then the cell with the faces
/// beyond its edges. The new face between them has no patch. Refused if the path runs around a single face, and in
/// the plane: use split_face() there.
std::array<Cell, 2> split_cell(Transaction& t, std::span<const Dart> path);

/// Merges the two cells at a face. The source is that of f.cell. Refused on the boundary, between a free and a blocked
/// cell, and if the cells touch beyond that face. In the plane, as merge_faces().
Cell merge_cells(Transaction& t, CellFace f);

/// Merges the two faces at an edge, on both sides. Refused if there are more than two faces around the edge, or
/// if these have more than the edge in common. In the plane, as merge_cells(): one polygon.
std::vector<Cell> merge_faces(Transaction& t, Dart d);

/// Merges the two edges at the origin of d. Refused if there are more than two edges, and if a face is a triangle
/// there.
std::vector<Cell> merge_edges(Transaction& t, Dart d);

/// Sews a's face to b's, dart a to dart b: a's origin and b's end become one vertex, and so on around the faces. Each
/// pair of vertices keeps the lower number. Refused if a face is not open, if the faces have different numbers of
/// corners, or if a cell would have one vertex twice.
std::vector<Cell> sew(Transaction& t, Dart a, Dart b);

/// Opens a face. If this separates the darts of a vertex, the side of f.cell keeps the vertex and the other side
/// gets a copy. Refused on the boundary.
std::vector<Cell> unsew(Transaction& t, CellFace f);

/// Makes walls of faces between two cells, with this patch on both sides. Both sides keep their vertices, so they stay
/// together while these move. Refused on the boundary.
std::vector<Cell> set_walls(Transaction& t, std::span<const CellFace> faces, Patch patch);

/// Sews walls that have a cell on both sides. `faces`: both sides of each, such as inner_walls() finds. They keep their
/// patches. Refused if a face is not open, or if no other one has its corners.
std::vector<Cell> remove_walls(Transaction& t, std::span<const CellFace> faces);

/// The walls of set_walls(), and those of a mesh (MeshData::baffle_tags): open faces with the corners of another one. Two
/// in a row are the sides of one wall. In the order of the cells. Cost: n log n in the open faces.
std::vector<CellFace> inner_walls(const CombinatorialMap& map);

/// Removes a cell. The faces of its neighbours become open. Parts that still touch in a vertex or an edge keep it in
/// common.
void remove(Transaction& t, Cell c);

/// The dart of the cell from one vertex to another; invalid if there is none. Cost: the cell's darts.
Dart find_dart(const CombinatorialMap& map, Cell c, Vertex from, Vertex to);

// Orbits of a combinatorial map: the darts of a vertex, an edge, a face, a cell.

// Each function returns every dart of the orbit once, d first. If the map has a boundary, an orbit holds the darts
// that are connected to d across faces. So a vertex at which two parts touch without a common face has one orbit for
// each part. Cost: its size, times its logarithm.

/// All darts that start at the vertex of d.
std::vector<Dart> vertex_orbit(const CombinatorialMap& map, Dart d);
/// All darts along the edge of d, in either direction.
std::vector<Dart> edge_orbit(const CombinatorialMap& map, Dart d);
/// All darts of the face of d, from both its sides.
std::vector<Dart> face_orbit(const CombinatorialMap& map, Dart d);
/// All darts of the cell of d.
std::vector<Dart> cell_orbit(const CombinatorialMap& map, Dart d);

// Integrity: whether a map keeps the constraints of a combinatorial map and of its records. Each broken one is named.

/// A constraint of the map that does not hold.
struct Violation {
  std::string constraint;  ///< such as "phi3 is an involution"
  Dart dart;               ///< where it was found
  std::string message;     ///< cell by its number in the mesh, and the values seen
};

/// Checks every dart of the given cells:
///
///  - phi1 is a permutation with inverse phi_1;
///  - phi2 is an involution without fixed points that turns the edge around;
///  - phi3 and phi1 o phi3 are involutions (if defined), and sewn darts have the same vertices;
///  - both sides of a face are fanned from the same point, or from no Steiner point;
///  - a face starts at its lowest-numbered vertex;
///  - vertices are in range, and distinct in a cell;
///  - a face and its vertices are marked as a wall's if exactly one side is free, or there is no other side.
///
/// Returns at most `max_count` violations. Cost: linear in the darts.
std::vector<Violation> check_integrity(const CombinatorialMap& map, std::span<const Cell> cells,
                                       std::size_t max_count = 100);
std::vector<Violation> check_integrity(const CombinatorialMap& map, std::size_t max_count = 100);

}  // namespace dartcast
