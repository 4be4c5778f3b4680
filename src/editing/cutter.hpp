// Cells that are split by one plane after another. Private to editing.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "editing/division.hpp"
#include "editing/sides.hpp"
#include "topology/workpiece.hpp"

namespace dartcast::detail {

/// Cells, and parts of cells, by private numbers. The map keeps the whole cells until put().
class Cutter {
 public:
  /// Numbers the cells from 0. Throws InvalidArgument if there is no such cell, or it is named twice.
  Cutter(ComplexEdit& edit, std::span<const Cell> cells);

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(pieces_.size()); }
  /// The vertices at the corners of a piece. They stay where they are until the corners of another are asked for.
  [[nodiscard]] std::span<const std::uint32_t> corners(std::uint32_t number);
  /// The mean of the corners.
  [[nodiscard]] Vec3 middle(std::uint32_t number);
  /// The distance from a plane within which vertices of these pieces count as on it.
  [[nodiscard]] double snap_distance(std::span<const std::uint32_t> numbers, const SectionOptions& options);

  /// Takes the planes for the next splits. Vertices at most `within` metres from a plane count as on it.
  void take(std::span<const Plane> planes, double within);
  /// Whether a piece has a part below all of the planes from one on.
  [[nodiscard]] bool reaches_below(std::uint32_t number, std::size_t first_plane);
  struct Parts {
    std::vector<std::uint32_t> below, above, whole;
  };
  /// As split_by_plane(). The part below keeps the number of the piece. The part above gets the next number.
  Parts split(std::span<const std::uint32_t> numbers, std::size_t plane);

  /// Puts the parts into the map. Nothing can be split afterwards. Returns all cells that this changed, each with the
  /// one that it is a part of.
  Succession put();
  /// The cells of the map. After put().
  [[nodiscard]] std::vector<Cell> cells(std::span<const std::uint32_t> numbers) const;

 private:
  struct Piece {
    Cell cell;                                  // the one that it is a part of; after put() its own
    std::uint32_t draft = DraftLink::no_draft;  // none: it is the whole cell
    std::uint32_t sides = KeyTable::none;       // number of its row in sides_of_; none: not known
  };

  [[nodiscard]] const Side* sides(std::uint32_t number);
  [[nodiscard]] bool is_above(std::uint32_t number, std::size_t plane);
  template <class Visit>
  void for_each_edge(std::uint32_t number, Visit&& visit);
  void find_draft(std::uint32_t number);

  ComplexEdit& edit_;
  Workpiece work_;
  std::vector<Piece> pieces_;
  std::optional<Sides> planes_;
  std::vector<Side> sides_of_;  // by row, then by plane: all sides on which a piece has corners
  std::vector<std::uint32_t> corners_;
};

}  // namespace dartcast::detail
