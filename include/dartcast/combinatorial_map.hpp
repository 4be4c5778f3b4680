// The combinatorial map: darts with phi1, phi2, phi3 over convex cells, free or blocked. It has no coordinates.
//
// After T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision detection in
// deformable environments", SPM 2009, section 3.1. No dart is stored. A dart is a cell and a number in the cell's
// shape. The shape gives phi1 and phi2. The record of the cell gives phi3.
//
// A walk reads one record for each cell that it enters. The record of a hexahedron fills one cache line. Records
// consist of 32-bit words:
//
// word     standard types (pools 0 to 3)           any other cell (pool 4)
// -------  --------------------------------------  -----------------------------------------------
// 0        shape 16, version 16                    shape 32
// 1        numbers of the neighbours' faces 3      version 16, free 1, not used 12, patch 1,
//          each (18), wall mask 6, free 1, wide 1, flat 1, vacant 1
//          not used 3, patch 1, flat 1, vacant 1
// 2 ...    vertices                                vertices
// then     neighbours                              neighbours
// then                                             per face: number of the neighbour's face 16, wall 16
//
//  - version: how often another cell took this place. A stale handle has another version.
//  - wide: the number of a neighbour's face does not fit in 3 bits. If the bits are 7, the neighbour is searched.
//  - patch: a face of the cell is in a patch. The patches are in a side table.
//  - flat: darts of the cell have marks. The marks are in a side table.
//  - vacant: the cell was removed (dartcast/map_edits.hpp), and its place waits for another.
//
// In the plane the cells are polygons, the faces are their edges, and phi2 leads to the neighbour. Records are the
// same.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/ids.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/storage.hpp"

namespace dartcast {

class CombinatorialMap;

/// The part of the map that a walk reads of a cell. Valid until the map is edited.
class CellView {
 public:
  CellView() = default;
  CellView(const CombinatorialMap& map, const std::uint32_t* word, const Shape& shape, bool general)
      : map_(&map), word_(word), shape_(&shape), general_(general) {}

  [[nodiscard]] const Shape& shape() const { return *shape_; }
  /// The record itself.
  [[nodiscard]] const std::uint32_t* words() const { return word_; }
  [[nodiscard]] Vertex vertex(std::uint16_t local) const { return Vertex{word_[2U + local]}; }
  [[nodiscard]] std::span<const std::uint32_t> vertices() const { return {word_ + 2, shape_->point_count()}; }
  [[nodiscard]] bool is_free() const { return ((word_[1] >> (general_ ? 16U : 24U)) & 1U) != 0; }
  [[nodiscard]] std::uint16_t version() const {
    return static_cast<std::uint16_t>(general_ ? word_[1] & 0xffffU : word_[0] >> 16U);
  }
  /// The cell on the other side of a face; invalid on the boundary.
  [[nodiscard]] Cell neighbour(std::uint16_t face) const { return Cell{word_[2U + shape_->point_count() + face]}; }
  /// The number that the neighbour gives to the face. Precondition: there is a neighbour.
  [[nodiscard]] std::uint16_t neighbour_face(std::uint16_t face) const {
    if (general_) return static_cast<std::uint16_t>(extra(face) & 0xffffU);
    const auto number = static_cast<std::uint16_t>((word_[1] >> (3U * face)) & 7U);
    return number == 7 ? neighbour_face_from_7(face) : number;
  }
  /// Whether the face is on the boundary, or between a free and a blocked cell.
  [[nodiscard]] bool is_wall(std::uint16_t face) const {
    if (general_) return (extra(face) >> 16U) != 0;
    return ((word_[1] >> (18U + face)) & 1U) != 0;
  }

 private:
  [[nodiscard]] std::uint32_t extra(std::uint16_t face) const {
    return word_[2U + shape_->point_count() + shape_->face_count() + face];
  }
  [[nodiscard]] std::uint16_t neighbour_face_from_7(std::uint16_t face) const;

  const CombinatorialMap* map_ = nullptr;
  const std::uint32_t* word_ = nullptr;
  const Shape* shape_ = nullptr;
  bool general_ = false;
};

/// A cell at this moment. An edit that replaces the cell makes the handle stale, even if another cell takes its place.
struct CellHandle {
  Cell cell;
  std::uint16_t version = 0;

  constexpr auto operator<=>(const CellHandle&) const = default;
};

/// Steiner points of cells and faces without a positive pulling triangulation (see dartcast/cell_complex.hpp). Their
/// numbers are vertices beyond the mesh's own points.
struct SteinerPoints {
  std::vector<std::pair<std::uint32_t, Vertex>> of_cells;  ///< mesh cell, its point; sorted
  /// A Steiner point of a face, as one of its two cells has it.
  struct FacePoint {
    std::uint32_t cell;  ///< mesh cell
    std::uint16_t face;  ///< in the mesh's order of faces
    Vertex point;        ///< the same from both sides
  };
  std::vector<FacePoint> of_faces;  ///< sorted by cell and face
};

/// Convex cells, free or blocked, and how they are joined: darts with phi1, phi2 and phi3. No positions.
class CombinatorialMap {
 public:
  /// Pools 0 to 3: tetrahedra, hexahedra, prisms, pyramids; in the plane 0 and 1: triangles, quadrilaterals.
  static constexpr std::uint32_t general_pool = 4;
  static_assert(general_pool < Cell::invalid_value >> Cell::index_bits);  // no cell is the invalid one
  /// The pool of the cells of a type. Cells with Steiner points are in the general pool instead.
  static constexpr std::uint32_t pool_of(CellType type) {
    if (dartcast::dimension(type) == 3) return static_cast<std::uint32_t>(type);
    return type == CellType::polygon ? general_pool : type == CellType::quadrilateral ? 1 : 0;
  }

  CombinatorialMap() = default;
  /// Builds cells, sews faces by their vertices, and takes over free marks and patches. Precondition:
  /// check_and_repair() found no defect. Throws InvalidMesh if a face has three cells or two on the same side, or a
  /// cell is not closed. It names the cell by its number in the mesh. Cost: linear, except for sorting.
  explicit CombinatorialMap(const MeshData& mesh, const SteinerPoints& steiner = {});

  /// 2 in the plane, where cells are polygons and faces are their edges; else 3.
  [[nodiscard]] unsigned dimension() const { return dimension_; }

  // Darts. Preconditions: dart and cell of this map.
  [[nodiscard]] Dart phi1(Dart d) const { return {d.cell, shape(d.cell).phi1(d.number)}; }
  [[nodiscard]] Dart phi_1(Dart d) const { return {d.cell, shape(d.cell).phi_1(d.number)}; }
  /// The same edge of the other face of the cell at that edge. In the plane: of the next polygon, invalid on the
  /// boundary.
  [[nodiscard]] Dart phi2(Dart d) const {
    return dimension_ == 2 ? across(d) : Dart{d.cell, shape(d.cell).phi2(d.number)};
  }
  /// The same edge of the same face from the other side; invalid on the boundary, and in the plane.
  [[nodiscard]] Dart phi3(Dart d) const { return dimension_ == 2 ? Dart{} : across(d); }
  /// The next dart around the vertex of d: phi1(phi2(d)). Invalid if phi2(d) is.
  [[nodiscard]] Dart alpha1(Dart d) const {
    const Dart other = phi2(d);
    return other.valid() ? phi1(other) : other;
  }
  [[nodiscard]] Vertex origin(Dart d) const {
    const CellView c = view(d.cell);
    return c.vertex(c.shape().origin(d.number));
  }
  [[nodiscard]] CellFace face(Dart d) const { return {d.cell, shape(d.cell).face_of(d.number)}; }
  /// The same face from the other side; invalid on the boundary.
  [[nodiscard]] CellFace opposite(CellFace f) const;
  /// The Steiner point that a face is fanned from; invalid if the face has none.
  [[nodiscard]] Vertex point(CellFace f) const;

  // Cells.
  /// The start of a cell's record, so that a caller can prefetch it.
  [[nodiscard]] const std::uint32_t* record(Cell c) const {
    const Pool& pool = pools_[c.pool()];
    return pool.words.data() +
           (c.pool() == general_pool ? pool.offsets[c.index()] : std::size_t{c.index()} * pool.stride);
  }
  /// Words from one record of a pool to the next; 0 in the general pool, whose records have different lengths.
  [[nodiscard]] std::uint32_t record_stride(std::uint32_t pool) const { return pools_[pool].stride; }
  // Inlined: every walk calls it for each cell that it enters, and a call costs as much as the work.
  [[nodiscard]] [[gnu::always_inline]] CellView view(Cell c) const { return view(c, record(c)); }
  /// The same for a caller that has the record.
  [[nodiscard]] [[gnu::always_inline]] CellView view(Cell c, const std::uint32_t* record) const {
    const bool general = c.pool() == general_pool;
    return {*this, record, shapes_[general ? record[0] : record[0] & 0xffffU], general};
  }
  [[nodiscard]] const Shape& shape(Cell c) const { return view(c).shape(); }
  [[nodiscard]] bool contains(Cell c) const {
    return c.valid() && c.pool() < pools_.size() && c.index() < pools_[c.pool()].count &&
           (record(c)[1] & vacant_bit) == 0;
  }
  [[nodiscard]] bool contains(CellHandle h) const { return contains(h.cell) && view(h.cell).version() == h.version; }
  /// Precondition: contains(c).
  [[nodiscard]] CellHandle handle(Cell c) const { return {c, view(c).version()}; }
  [[nodiscard]] CellType type(Cell c) const { return type_of(c.pool()); }
  /// The type of the cells in a pool.
  [[nodiscard]] CellType type_of(std::uint32_t pool) const;
  [[nodiscard]] std::size_t cell_count() const;
  [[nodiscard]] std::size_t cell_count(std::uint32_t pool) const { return pools_[pool].count - pools_[pool].gone; }
  /// Number of places in a pool, vacant ones included. Indices of cells are below it. Until the map is edited it equals
  /// the number of cells.
  [[nodiscard]] std::size_t slot_count(std::uint32_t pool) const { return pools_[pool].count; }
  /// An upper bound on the numbers of vertices. After edits some numbers below it may be in no cell.
  [[nodiscard]] std::size_t vertex_count() const { return vertex_count_; }
  /// Whether the number names a vertex: edits give numbers up and use them again.
  [[nodiscard]] bool is_vertex(Vertex v) const {
    return v.value < vertex_count_ && (cells_at_.empty() || cells_at_[v.value] != vacant_vertex);
  }
  [[nodiscard]] const ShapeTable& shapes() const { return shapes_; }
  /// The cell's index in the mesh, or in the file that the mesh was read from. A cell that an edit made has the index
  /// of the cell which it was made from.
  [[nodiscard]] std::uint32_t source(Cell c) const;
  /// All cells, pool by pool.
  [[nodiscard]] std::vector<Cell> cells() const;
  /// Calls visit(cell, view) for the cells of a pool in the places [begin, end).
  template <class Visit>
  void for_each_cell(std::uint32_t pool, std::size_t begin, std::size_t end, Visit&& visit) const {
    const bool general = pool == general_pool;
    for (std::size_t i = begin; i < end; ++i) {
      const Pool& p = pools_[pool];
      const std::uint32_t* word = p.words.data() + (general ? p.offsets[i] : i * p.stride);
      if ((word[1] & vacant_bit) != 0) continue;
      const std::uint32_t shape = general ? word[0] : word[0] & 0xffffU;
      visit(Cell(pool, static_cast<std::uint32_t>(i)), CellView(*this, word, shapes_[shape], general));
    }
  }

  // Marks.
  [[nodiscard]] bool is_free(Cell c) const { return view(c).is_free(); }
  /// Marks a cell free or blocked. Its faces, seen from both sides, become walls or cease to be walls. Cost: its faces.
  void set_free(Cell c, bool free);
  /// False only if no wall has the vertex. True if a wall has it or once had it.
  [[nodiscard]] bool may_touch_wall(Vertex v) const {
    return ((wall_vertices_.words[v.value / 64U] >> (v.value % 64U)) & 1U) != 0;
  }

  // Marks that edits leave for the code that gives cells Steiner points (see dartcast/map_edits.hpp).
  /// Parts of the cell that an edit found to be flat at a dart.
  struct Flat {
    bool straight = false;  ///< the face of the dart may be straight in its origin
    bool coplanar = false;  ///< the two faces of the cell that meet in its edge may lie in one plane
  };
  [[nodiscard]] Flat flat(Dart d) const {
    if ((record(d.cell)[1] & flat_bit) == 0) return {};
    const std::uint16_t bits = flats_.find(d.cell, d.number);
    return {(bits & straight_bit) != 0, (bits & coplanar_bit) != 0};
  }
  /// Whether a dart of the cell has such a mark.
  [[nodiscard]] bool has_flat(Cell c) const { return (record(c)[1] & flat_bit) != 0; }

  // Patches: named groups of faces.
  [[nodiscard]] Patch patch(CellFace f) const {
    return has_patch(f.cell) ? Patch{patches_.find(f.cell, f.face)} : Patch{};
  }
  /// Index 0 is "" (the unnamed rest).
  [[nodiscard]] const std::vector<std::string>& patch_names() const { return patch_names_; }
  /// The patch of a name. Throws InvalidArgument, which lists the names that exist.
  [[nodiscard]] Patch patch(std::string_view name) const;
  /// Number of wall faces seen from free cells.
  [[nodiscard]] std::size_t wall_face_count() const;

  [[nodiscard]] std::size_t bytes() const;
  /// Whether records, numbers, vacant places, shapes, vertices and patches are the same. Cost: linear.
  bool operator==(const CombinatorialMap&) const = default;

 private:
  friend class MapBuilder;
  friend class Transaction;

  static constexpr std::uint32_t vacant_bit = 1U << 31U;
  static constexpr std::uint32_t flat_bit = 1U << 30U;
  static constexpr std::uint32_t patch_bit = 1U << 29U;
  static constexpr std::uint32_t vacant_vertex = 0xffffffffU;  // instead of a number of cells
  static constexpr std::uint16_t straight_bit = 1;
  static constexpr std::uint16_t coplanar_bit = 2;

  struct Pool {
    std::uint32_t stride = 0;  // words of a record; general pool: 0
    std::size_t count = 0;     // places
    std::size_t gone = 0;      // places without a cell
    AlignedVector<std::uint32_t> words = {};
    std::vector<std::size_t> offsets = {};   // general pool only: start of each record
    std::vector<std::uint32_t> source = {};  // empty: the index in the pool is the index in the mesh
    // Vacant places by the length of their records. At most as many of each length as were once in use together.
    std::map<std::uint32_t, std::vector<std::uint32_t>> vacant = {};

    bool operator==(const Pool&) const = default;
  };

  // A bit for each vertex of a wall. Bits of walls that no longer exist may stay set, so they are not compared.
  struct WallVertices {
    std::vector<std::uint64_t> words;

    void resize(std::size_t vertices) { words.resize(vertices / 64 + 1); }
    void add(Vertex v) { words[v.value / 64U] |= std::uint64_t{1} << (v.value % 64U); }
    bool operator==(const WallVertices&) const { return true; }
  };

  [[nodiscard]] Dart across(Dart d) const;
  [[nodiscard]] std::uint32_t* record(Cell c) { return const_cast<std::uint32_t*>(std::as_const(*this).record(c)); }
  // Whether a face of the cell is in a patch. Few are; the table is cold memory.
  [[nodiscard]] bool has_patch(Cell c) const { return (record(c)[1] & patch_bit) != 0; }
  void set_patch(CellFace f, Patch patch) {
    patches_.set(f.cell, f.face, patch.value);
    record(f.cell)[1] |= patch_bit;
  }
  void open_record(std::uint32_t pool, std::size_t words);
  void write_cell(Cell c, std::uint32_t shape, std::span<const std::uint32_t> vertices, bool free);
  void set_neighbour(CellFace f, CellFace other);
  void set_wall(CellFace f, bool wall);
  void mark_walls(Cell c);

  unsigned dimension_ = 3;
  std::array<Pool, 5> pools_ = {Pool{10}, Pool{16}, Pool{13}, Pool{12}, Pool{}};
  ShapeTable shapes_;
  std::size_t vertex_count_ = 0;
  WallVertices wall_vertices_;
  std::vector<std::uint32_t> cells_at_;  // number of cells of each vertex; empty until the first transaction
  std::vector<Vertex> vacant_vertices_;  // numbers to use again
  std::vector<std::string> patch_names_ = {""};
  SideTable patches_;  // by face
  SideTable flats_;    // by dart
};

}  // namespace dartcast
