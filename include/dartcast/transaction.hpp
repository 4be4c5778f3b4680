// Edits of a map: all or nothing.
//
// Everything that changes the cells of a map is one primitive, replace(): some cells go, others take their place. It
// judges all before it changes anything, and notes what it changes, so that a transaction can take back every step.
// dartcast/map_edits.hpp has the edits that people think in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/combinatorial_map.hpp"
#include "topology/draft.hpp"
#include "topology/replacement.hpp"

namespace dartcast {

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

}  // namespace dartcast
