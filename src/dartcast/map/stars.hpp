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
    std::uint16_t triangle;  ///< of the face's fan
  };

  Stars() = default;
  /// `simplices`: connected; none of them flat. Cost: linear but for sorting.
  explicit Stars(std::span<const ImplicitSimplex> simplices);

  /// The star of a simplex around its corners in the mask `corners`, one or two of them.
  [[nodiscard]] std::uint16_t star(std::uint16_t simplex, unsigned corners) const {
    return star_[simplex * features + feature_of_mask[corners]];
  }
  /// The star's triangles of faces that hold the point or the edge; those of one face come one after another.
  [[nodiscard]] std::span<const Facet> outer_facets(std::uint16_t star) const {
    return {facets_.data() + first_[star], facets_.data() + first_[star + 1U]};
  }
  [[nodiscard]] bool empty() const { return star_.empty(); }
  /// Whether no point and no edge has two stars.
  [[nodiscard]] bool one_each() const { return one_each_; }

  [[nodiscard]] std::size_t bytes() const;

 private:
  static constexpr std::size_t features = 10;  // of a simplex: four corners, six edges
  static constexpr std::array<std::uint8_t, 16> feature_of_mask = {0, 0, 1, 4, 2, 5, 6, 0, 3, 7, 8, 0, 9, 0, 0, 0};

  void add_star(std::span<const ImplicitSimplex> simplices, std::uint16_t simplex, unsigned corners);

  std::vector<std::uint16_t> star_;  // of each feature of each simplex
  std::vector<std::uint32_t> first_;
  std::vector<Facet> facets_;
  bool one_each_ = true;
};

}  // namespace dartcast
