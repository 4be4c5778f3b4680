// The combinatorial type of a cell: its darts, faces, fans and implicit simplices. All cells of one type share it.
//
// The darts are those of a combinatorial map: T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for
// continuous collision detection in deformable environments", SPM 2009, section 3.1. The simplices are a pulling
// triangulation. Each face is a fan around its lowest-numbered vertex, or around a Steiner point. The cell is coned
// from its lowest-numbered vertex over the fan triangles that do not contain it, or from a Steiner point.
//
// A cell of the plane is a polygon. Its faces are its edges, of two corners and one dart each, in counterclockwise
// direction. Its simplices are triangles, and their fourth corner and facet are not used. The shape does not have phi2,
// which leads to the next polygon (dartcast/combinatorial_map.hpp).
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/ids.hpp"

namespace dartcast {

namespace detail {
class ExitTable;
}

// The simplices of one shape around its corners and edges, and the triangles of faces at which they end. A search uses
// them to go from cell to cell around a vertex or an edge without a look at every simplex.

struct ImplicitSimplex;

/// Simplices that hold the same point or edge are one *star* if facets that hold it connect them. In a cell that is a
/// ball, as all valid cells are, a point or an edge has one star.
///
/// Numbers of stars fit in 16 bits. There are at most 15/4 for each of the simplices and of the other triangles of
/// the fans, of which there are at most Shape::max_darts. Around a Steiner point of the cell these are 3/2 around
/// edges of the triangles and 1 around their points. There are 1 around edges to the Steiner point, and 1/4 around
/// itself: at least three triangles meet in each point. Around a corner they are fewer.
class Stars {
 public:
  /// A facet of a simplex that is a triangle of a face.
  struct Facet {
    std::uint16_t simplex;
    std::uint16_t facet;
    std::uint16_t face;
    std::uint16_t rest;      ///< number of further facets of this face that follow
    std::uint16_t triangle;  ///< of the face's fan, numbered as the neighbour does
    std::uint16_t held;      ///< mask of the triangle's corners at the point or the edge, as the neighbour numbers them
  };

  /// The triangles of the faces' fans, by the points that are their corners.
  struct Fans {
    std::vector<std::array<std::uint16_t, 3>> triangles;
    std::vector<std::uint32_t> first;  ///< first triangle of each face; at the end the number of triangles
  };

  Stars() = default;
  /// `simplices`: connected, none of them flat. `fans`: of all faces that these reach. Cost: linear, except for
  /// sorting.
  Stars(std::span<const ImplicitSimplex> simplices, const Fans& fans);

  /// The star of a simplex around its corners in the mask `corners`. The mask has one or two bits.
  [[nodiscard]] std::uint16_t star(std::uint16_t simplex, unsigned corners) const {
    return star_[simplex * features + feature_of_mask[corners]];
  }
  /// The star of the simplex behind a triangle of a face, around the corners in the mask `held`. The mask has one or
  /// two bits.
  [[nodiscard]] std::uint16_t star_behind(std::uint16_t face, std::uint16_t triangle, unsigned held) const {
    return behind_[(first_triangle_[face] + triangle) * masks + held];
  }
  /// The star's triangles of faces that hold the point or the edge. Those of one face are adjacent in the list.
  [[nodiscard]] std::span<const Facet> outer_facets(std::uint16_t star) const {
    return {facets_.data() + first_[star], facets_.data() + first_[star + 1U]};
  }
  [[nodiscard]] bool empty() const { return star_.empty(); }
  /// Whether no point and no edge has two stars.
  [[nodiscard]] bool one_each() const { return one_each_; }

 private:
  static constexpr std::size_t masks = 8;      // of a triangle's corners
  static constexpr std::size_t features = 10;  // of a simplex: four corners, six edges
  static constexpr std::array<std::uint8_t, 16> feature_of_mask = {0, 0, 1, 4, 2, 5, 6, 0, 3, 7, 8, 0, 9, 0, 0, 0};

  void add_star(std::span<const ImplicitSimplex> simplices, const Fans& fans, std::uint16_t simplex, unsigned corners,
                std::vector<std::uint16_t>& open);
  void add_triangles(std::span<const ImplicitSimplex> simplices, const Fans& fans);

  std::vector<std::uint16_t> star_;            // of each feature of each simplex
  std::vector<std::uint16_t> behind_;          // of each mask of corners of each triangle
  std::vector<std::uint32_t> first_triangle_;  // of each face
  std::vector<std::uint32_t> first_ = {0};
  std::vector<Facet> facets_;
  bool one_each_ = true;
};

/// The key of a shape. Points of the cell have local numbers: corners, then Steiner points of faces, then that of the
/// cell.
struct ShapeKey {
  /// A face by its corners.
  struct Face {
    /// Corners from the lowest-numbered vertex, counterclockwise as seen from the outside. In the plane: the edge's two
    /// corners in its direction.
    std::vector<std::uint16_t> corners;
    bool has_point = false;  ///< fanned from a Steiner point
    bool operator==(const Face&) const = default;
  };
  std::uint16_t corner_count = 0;
  std::uint16_t apex = 0;  ///< local number of the lowest-numbered corner, if the cell has no Steiner point
  bool has_point = false;  ///< coned from a Steiner point
  std::vector<Face> faces;
  bool operator==(const ShapeKey&) const = default;
};

/// The other side of a facet of a simplex: another simplex of the cell, or a triangle of a face's fan.
struct Across {
  static constexpr std::uint16_t outer_bit = 0x8000U;

  std::uint16_t index = 0;  ///< simplex, or outer_bit + face
  std::uint16_t place = 0;  ///< facet of that simplex, or triangle of the fan

  [[nodiscard]] constexpr bool outer() const { return (index & outer_bit) != 0; }
  [[nodiscard]] constexpr std::uint16_t face() const { return index & static_cast<std::uint16_t>(~outer_bit); }
  constexpr bool operator==(const Across&) const = default;
};

/// A tetrahedron with points of the cell as corners. It is positive in a valid cell: det[v1 - v0, v2 - v0, v3 - v0] >
/// 0. In the plane it is a triangle, positive if its corners turn counterclockwise.
struct ImplicitSimplex {
  std::array<std::uint16_t, 4> vertex;  ///< local numbers
  std::array<Across, 4> across;         ///< beyond the facet opposite to vertex i
};

/// Immutable. Darts are numbered face by face, from the face's lowest-numbered vertex.
class Shape {
 public:
  /// A cell has at most so many darts; a polygon has one for each edge. A point has two darts or more, and a face three.
  /// So numbers of darts, faces, points, triangles of fans and simplices fit in 15 bits.
  static constexpr std::size_t max_darts = 0x3fff;
  static_assert(max_darts < Across::outer_bit);

  /// Throws InvalidArgument if the apex is no corner, a corner is in no face, or an edge of a polygon has a Steiner
  /// point. Throws InvalidMesh if there are more than max_darts, or if the faces do not close. Faces close if each edge
  /// is used once in each direction; in the plane, if the edges are one cycle in the given order. Faces that meet in an
  /// edge with a corner on it may have fans with a common triangle. Then the fans bound no solid. The shape has one
  /// simplex that is flat at any positions, so that the cell is invalid until such faces get Steiner points.
  explicit Shape(ShapeKey key);
  Shape(const Shape&) = delete;
  Shape& operator=(const Shape&) = delete;
  Shape(Shape&&) = delete;
  Shape& operator=(Shape&&) = delete;
  ~Shape();

  /// 2: a polygon; 3: a polyhedron.
  [[nodiscard]] unsigned dimension() const { return dimension_; }
  [[nodiscard]] std::uint16_t corner_count() const { return key_.corner_count; }
  /// Number of corners and Steiner points.
  [[nodiscard]] std::uint16_t point_count() const { return point_count_; }
  [[nodiscard]] std::uint16_t face_count() const { return face_count_; }
  [[nodiscard]] std::uint16_t dart_count() const { return static_cast<std::uint16_t>(origin_.size()); }
  [[nodiscard]] const ShapeKey& key() const { return key_; }

  [[nodiscard]] std::uint16_t origin(std::uint16_t dart) const { return origin_[dart]; }
  [[nodiscard]] std::uint16_t face_of(std::uint16_t dart) const { return face_of_[dart]; }
  [[nodiscard]] std::uint16_t first_dart(std::uint16_t face) const { return first_dart_[face]; }
  [[nodiscard]] std::uint16_t degree(std::uint16_t face) const {
    return static_cast<std::uint16_t>(first_dart_[face + 1] - first_dart_[face]);
  }
  [[nodiscard]] std::uint16_t phi1(std::uint16_t dart) const {
    if (dimension_ == 2) return static_cast<std::uint16_t>(dart + 1U == dart_count() ? 0U : dart + 1U);
    const std::uint16_t f = face_of_[dart];
    return dart + 1 == first_dart_[f + 1] ? first_dart_[f] : static_cast<std::uint16_t>(dart + 1);
  }
  [[nodiscard]] std::uint16_t phi_1(std::uint16_t dart) const {
    if (dimension_ == 2) return static_cast<std::uint16_t>((dart == 0 ? dart_count() : dart) - 1);
    const std::uint16_t f = face_of_[dart];
    return static_cast<std::uint16_t>((dart == first_dart_[f] ? first_dart_[f + 1] : dart) - 1);
  }
  /// Precondition: no polygon.
  [[nodiscard]] std::uint16_t phi2(std::uint16_t dart) const { return phi2_[dart]; }
  [[nodiscard]] std::span<const std::uint16_t> corners(std::uint16_t face) const { return key_.faces[face].corners; }
  /// A bit for each point of a face: its corners and its Steiner point. Precondition: point_count() <= 64.
  [[nodiscard]] std::uint64_t points_of_face(std::uint16_t face) const { return points_of_face_[face]; }

  [[nodiscard]] const std::vector<ImplicitSimplex>& simplices() const { return simplices_; }
  /// Empty if the shape is flat, or a polygon. The first call makes them, because most shapes that an edit makes are
  /// released before a walk asks. Any number of threads may call.
  [[nodiscard]] const Stars& stars() const {
    const Stars* made = stars_.load(std::memory_order_acquire);
    return made != nullptr ? *made : make_stars();
  }
  /// For walks: made by the first call, as the stars are.
  [[nodiscard]] const detail::ExitTable& exits() const {
    const detail::ExitTable* made = exits_.load(std::memory_order_acquire);
    return made != nullptr ? *made : make_exits();
  }
  /// Number of triangles in a face's fan: degree - 2, or degree if the face has a Steiner point. In the plane a face
  /// is one facet of a simplex, as a triangle is.
  [[nodiscard]] std::uint16_t triangle_count(std::uint16_t face) const {
    if (dimension_ == 2) return 1;
    return static_cast<std::uint16_t>(degree(face) - (key_.faces[face].has_point ? 0 : 2));
  }
  /// Local numbers of the corners of a fan triangle, counterclockwise as seen from the outside. In the plane: the
  /// edge's corners, the second one twice.
  [[nodiscard]] std::array<std::uint16_t, 3> triangle(std::uint16_t face, std::uint16_t t) const;
  /// The number that the cell on the other side gives to a triangle of this face.
  [[nodiscard]] std::uint16_t triangle_from_other_side(std::uint16_t face, std::uint16_t t) const {
    return static_cast<std::uint16_t>(triangle_count(face) - 1 - t);
  }
  /// The simplex behind a fan triangle, and its facet: `index` and `place`.
  [[nodiscard]] Across entry(std::uint16_t face, std::uint16_t t) const { return entries_[first_entry_[face] + t]; }

  /// The face that has this Steiner point; face_count() if `point` is a corner or the Steiner point of the cell.
  [[nodiscard]] std::uint16_t face_of_point(std::uint16_t point) const;

  /// A volume, face, edge or vertex of the cell.
  struct Feature {
    Kind kind;
    std::uint16_t dart;  ///< of that face, edge or vertex (its origin); not used for a volume
  };
  /// The cell of the map whose interior holds the relative interior of the given points' hull. `points`: local numbers,
  /// 1 to 4 corners of one simplex. Cost: linear in the faces at the first of them.
  [[nodiscard]] Feature feature(std::span<const std::uint16_t> points) const;

  [[nodiscard]] std::size_t bytes() const;

 private:
  void number_darts();
  void number_points_of_faces();
  void sew_darts();
  void make_simplices();
  void make_triangles();
  void connect_simplices();
  void make_flat();
  [[nodiscard]] bool is_flat() const;
  [[nodiscard]] Stars::Fans fans() const;
  [[nodiscard]] const Stars& make_stars() const;
  [[nodiscard]] const detail::ExitTable& make_exits() const;
  [[nodiscard]] bool is_on_face(std::uint16_t point, std::uint16_t face) const;
  [[nodiscard]] std::span<const std::uint16_t> darts_at(std::uint16_t corner) const {
    return {darts_at_.data() + first_dart_at_[corner], darts_at_.data() + first_dart_at_[corner + 1U]};
  }

  ShapeKey key_;
  unsigned dimension_ = 3;
  std::uint16_t face_count_ = 0;
  std::uint16_t point_count_ = 0;
  std::vector<std::uint16_t> origin_, face_of_, first_dart_, phi2_;
  std::vector<std::uint16_t> darts_at_, first_dart_at_;  // by corner: those with this origin
  std::vector<std::uint64_t> points_of_face_;            // none if there are too many points
  std::vector<ImplicitSimplex> simplices_;
  // Owned; null until they are needed.
  mutable std::atomic<const Stars*> stars_ = nullptr;
  mutable std::atomic<const detail::ExitTable*> exits_ = nullptr;
  std::vector<std::uint16_t> first_entry_;
  std::vector<Across> entries_;
};

}  // namespace dartcast
