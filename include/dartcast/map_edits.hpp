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
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "dartcast/combinatorial_map.hpp"

namespace dartcast {

// Cells yet to be made: what an edit puts in the place of others.
//
// In the plane the faces of a draft are its edges, each from its first corner to its second, one behind another
// counterclockwise; marks count at the first corner.

/// A corner of a face, and the edge from it to the next.
struct DraftCorner {
  Vertex vertex;
  bool straight = false;  ///< the face may be straight here: a vertex put on an edge, a split that was merged away
  bool coplanar = false;  ///< the cell's face beyond the edge may lie in the same plane
};

/// What a face is sewn to: nothing, a face of a cell of the map, or a face of another draft of the same call. Where the
/// cell named is one of those to be replaced, the draft's face that continues its face is meant.
struct DraftLink {
  static constexpr std::uint32_t no_draft = 0xffffffffU;

  CellFace face;
  std::uint32_t draft = no_draft;
  std::uint16_t draft_face = 0;
};

struct DraftFace {
  std::vector<DraftCorner> corners;  ///< counterclockwise seen from the outside
  DraftLink across;
  CellFace from;  ///< the face of a replaced cell that this one continues; invalid where it is new
  Patch patch;
  Vertex point;  ///< fanned from a point of its own, the same from both sides; invalid: it has none
};

struct CellDraft {
  std::vector<DraftFace> faces;
  Vertex point;  ///< coned from a point of its own; invalid: it has none
  bool free = true;
  std::uint32_t source = 0;  ///< the number in the mesh that errors and output name
};

/// A draft of the cell as it is, corner k of face f for dart first_dart(f) + k, but without a point of its own: what is
/// to be coned anew has to find a new one. Faces keep their points. Precondition: contains(c).
CellDraft draft_of(const CombinatorialMap& map, Cell c);

/// How a draft goes into a record.
struct DraftForm {
  std::uint32_t pool = CombinatorialMap::general_pool;
  std::vector<std::uint32_t> corners;  ///< in the record's order
  std::vector<std::uint16_t> local;    ///< general pool: place of each face's corners in these, one face after another
  std::vector<std::uint16_t> face;     ///< the record's number of each of the draft's faces
  std::string defect;                  ///< why it is no cell; empty: it is one
};

/// Judges a draft by itself: at least four faces of at least three distinct corners; every edge once in each direction;
/// the surface a sphere; points distinct from corners; at most 16383 darts. In the plane: at least three edges, one
/// cycle of distinct corners. What is combinatorially a tetrahedron, hexahedron, prism, pyramid, triangle or
/// quadrilateral, without points, takes that form. Cost: linear in its darts, on average.
DraftForm form_of(const CellDraft& draft, unsigned dimension = 3);
std::vector<DraftForm> forms_of(std::span<const CellDraft> drafts, unsigned dimension);

// Edits of a map: all or nothing.
//
// Everything that changes the cells of a map is one primitive, replace(): some cells go, others take their place. It
// judges all before it changes anything, and notes what it changes, so that a transaction can take back every step.
// dartcast/map_edits.hpp has the edits that people think in.

/// A vertex that came to be: on the edge between two others, or parted from one (then both are that one). Its
/// coordinates are for the caller to give.
struct CreatedVertex {
  Vertex vertex;
  Vertex from, other;
};

/// A vertex in place of which cells have a survivor now. (Cells that touched these in the vertex alone keep it: whether
/// it died is told apart.)
struct MergedVertex {
  Vertex gone, merged_into;
};

/// What a transaction did, all in all.
struct EditReport {
  std::vector<CellHandle> removed;     ///< as they were before; their handles are stale now
  std::vector<Cell> added;             ///< in the place of those
  std::vector<Cell> marked;            ///< freed or blocked, otherwise as they were
  std::vector<CreatedVertex> created;  ///< in order: `from` and `other` are older
  std::vector<MergedVertex> merged;    ///< in order: a survivor may be gone later
  std::vector<Vertex> deleted;         ///< in no cell any more (interior points, too): their numbers are used again
};

struct Replacement;

/// A sequence of edits. What is not committed when it ends is taken back: the map is then as it was, to the last
/// record, number and version. While it is open, nobody else edits or copies the map, and no other transaction is open
/// on it; whoever reads it sees the edits made so far. Numbers of cells and vertices that are gone are not used again
/// before the commit.
///
/// The first transaction on a map counts the cells of each vertex and lists the cells' sources: linear in the map,
/// once, and four bytes for each vertex and cell from then on. After that the cost of each function is that of the
/// cells that it names and their neighbours, whatever the size of the map; arrays grow by doubling.
class Transaction {
 public:
  explicit Transaction(CombinatorialMap& map);
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  Transaction(Transaction&&) = delete;
  Transaction& operator=(Transaction&&) = delete;
  ~Transaction();

  [[nodiscard]] const CombinatorialMap& map() const { return map_; }

  /// A vertex for drafts to use. One that no cell uses at the commit is given up.
  Vertex add_vertex(Vertex from, Vertex other);

  /// Removes cells and puts others in their place; returns these in the order of the drafts. Either list may be empty.
  /// New cells have new numbers; the cells around keep theirs, with their neighbours changed. Throws as
  /// plan_replacement() does; then this call has changed nothing.
  std::vector<Cell> replace(std::span<const Cell> removed, std::span<const CellDraft> drafts);

  /// As CombinatorialMap::set_free(), but taken back with the transaction. Throws InvalidArgument where there is no
  /// such cell.
  void set_free(Cell c, bool free);

  /// Says in the report that one vertex stands for another.
  void note_merged(Vertex gone, Vertex merged_into) { merged_.push_back({gone, merged_into}); }

  // What has been done since the last commit, so far.
  [[nodiscard]] std::size_t created_count() const { return created_.size(); }
  /// In order, those that no cell uses included.
  [[nodiscard]] const CreatedVertex& created(std::size_t i) const { return created_[i].vertex; }
  /// Cells put in the place of others and still there.
  [[nodiscard]] std::vector<Cell> added() const;
  /// Cells taken away, of those that there were at the last commit. Until the next one, map().view() shows them as they
  /// were when they were taken away.
  [[nodiscard]] std::vector<Cell> removed() const;
  /// Cells freed or blocked, otherwise as they were; sorted.
  [[nodiscard]] std::vector<Cell> marked() const;
  [[nodiscard]] std::span<const MergedVertex> merged() const { return merged_; }

  /// A place in the sequence, to go back to.
  struct Savepoint {
    std::size_t words = 0, added = 0, removed = 0, created = 0, merged = 0, marked = 0;
  };
  [[nodiscard]] Savepoint savepoint() const;
  /// Takes back everything after the mark.
  void roll_back(const Savepoint& to);
  /// Takes back everything since the last commit.
  void roll_back() { roll_back(Savepoint{}); }

  /// Makes all edits final and says what they did. The transaction can then go on with others.
  EditReport commit();

 private:
  struct OldWord {
    std::uint32_t pool;
    std::size_t at;
    std::uint32_t value;
  };
  struct AddedCell {
    Cell cell;
    bool appended;  // in a place that there was not before
    ShapeTable::Interned shape;
  };
  struct Created {
    CreatedVertex vertex;
    bool appended;
  };

  void prepare();
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
};

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

// Orbits of a combinatorial map: the darts of a vertex, an edge, a face, a cell.

// Each returns every dart of the orbit once, d first. Where the map has a boundary an orbit holds what is connected to
// d across faces: a vertex at which two parts touch without a common face has an orbit for each. Cost: its size, times
// its log.

/// All darts that start at the vertex of d.
std::vector<Dart> vertex_orbit(const CombinatorialMap& map, Dart d);
/// All darts along the edge of d, in either direction.
std::vector<Dart> edge_orbit(const CombinatorialMap& map, Dart d);
/// All darts of the face of d, from both its sides.
std::vector<Dart> face_orbit(const CombinatorialMap& map, Dart d);
/// All darts of the cell of d.
std::vector<Dart> cell_orbit(const CombinatorialMap& map, Dart d);

// Whether a map keeps the constraints of a combinatorial map and of its records; each broken one is named.

struct Violation {
  std::string constraint;  ///< such as "phi3 is an involution"
  Dart dart;               ///< where it was found
  std::string message;     ///< cell by its number in the mesh, and the values seen
};

/// Checks every dart of the cells given: phi1 is a permutation with inverse phi_1; phi2 is an involution without fixed
/// points that turns the edge around; phi3 and phi1 o phi3 are involutions (where defined); sewn darts have the same
/// vertices; both sides of a face are fanned from the same point, or from none of its own; a face starts at its
/// lowest-numbered vertex; vertices are in range, and distinct in a cell; a face is marked as a wall where exactly one
/// side is free, or there is no other side, and its vertices as those of a wall. Returns at most `max_count`
/// violations. Cost: linear in the darts.
std::vector<Violation> check_integrity(const CombinatorialMap& map, std::span<const Cell> cells,
                                       std::size_t max_count = 100);
std::vector<Violation> check_integrity(const CombinatorialMap& map, std::size_t max_count = 100);

}  // namespace dartcast
