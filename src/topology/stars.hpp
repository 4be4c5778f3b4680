// The simplices of one shape around its corners and edges, and where they reach the faces: to go from cell to cell
// around a vertex or an edge without looking at every simplex.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dartcast {

struct ImplicitSimplex;

/// Simplices that hold the same point or edge are one *star* where they hang together by facets that hold it. In a cell
/// that is a ball, as all valid ones are, a point or an edge has one star.
class Stars {
 public:
  /// A facet of a simplex that is a triangle of a face.
  struct Facet {
    std::uint16_t simplex;
    std::uint16_t facet;
    std::uint16_t face;
    std::uint16_t rest;      ///< so many more of this face follow
    std::uint16_t triangle;  ///< of the face's fan, by the number that the neighbour gives to it
    std::uint16_t
        held;  ///< bits of the triangle's corners that are the point's or the edge's, as the neighbour has them
  };

  /// The triangles of the faces' fans, by the points that are their corners.
  struct Fans {
    std::vector<std::array<std::uint16_t, 3>> triangles;
    std::vector<std::uint32_t> first;  ///< of each face; and how many there are
  };

  Stars() = default;
  /// `simplices`: connected, none of them flat. `fans`: of all faces that these reach. Cost: linear but for sorting.
  Stars(std::span<const ImplicitSimplex> simplices, const Fans& fans);

  /// The star of a simplex around its corners in the mask `corners`, one or two of them.
  [[nodiscard]] std::uint16_t star(std::uint16_t simplex, unsigned corners) const {
    return star_[simplex * features + feature_of_mask[corners]];
  }
  /// The star around corners of a triangle of a face, in the mask `held`, one or two of them: of the simplex behind it.
  [[nodiscard]] std::uint16_t star_behind(std::uint16_t face, std::uint16_t triangle, unsigned held) const {
    return behind_[(first_triangle_[face] + triangle) * masks + held];
  }
  /// Stars are numbered from 0 on.
  [[nodiscard]] std::size_t size() const { return first_.size() - 1; }
  /// The star's triangles of faces that hold the point or the edge; those of one face come one after another.
  [[nodiscard]] std::span<const Facet> outer_facets(std::uint16_t star) const {
    return {facets_.data() + first_[star], facets_.data() + first_[star + 1U]};
  }
  [[nodiscard]] bool empty() const { return star_.empty(); }
  /// Whether no point and no edge has two stars.
  [[nodiscard]] bool one_each() const { return one_each_; }

  [[nodiscard]] std::size_t bytes() const;

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

}  // namespace dartcast
