// Cells that are split by one plane after another. Private to editing.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "editing/sides.hpp"

namespace dartcast::detail {

/// Undoes the work of an action on an edit if the action throws.
template <class Action>
auto all_or_nothing(ComplexEdit& edit, Action&& action) {
  const Transaction::Savepoint before = edit.savepoint();
  try {
    return action();
  } catch (...) {
    edit.roll_back(before);
    throw;
  }
}

/// Cells by private numbers, which stay the same while edits replace the cells.
class Cutter {
 public:
  /// Numbers the cells from 0. Throws InvalidArgument where there is no such cell, or it is named twice.
  Cutter(ComplexEdit& edit, std::span<const Cell> cells);

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(cells_.size()); }
  [[nodiscard]] Cell cell(std::uint32_t number) const { return cells_[number]; }
  [[nodiscard]] std::vector<Cell> cells(std::span<const std::uint32_t> numbers) const;

  struct Parts {
    std::vector<std::uint32_t> below, above, whole;
  };
  /// As split_by_plane(). Vertices at most `within` metres from the plane count as on it. The part below keeps the
  /// number of the cell. The part above gets the next number.
  Parts split(std::span<const std::uint32_t> numbers, const Plane& plane, double within);
  /// Answers of reaching_below() for one plane, by number of the cell. They hold until the cell is replaced.
  struct Reaching {
    struct Answer {
      Cell cell;
      bool below = false;
    };
    std::vector<Answer> of;
  };
  /// The cells with a part below the plane. `known`: of the same plane and distance, empty at first.
  [[nodiscard]] std::vector<std::uint32_t> reaching_below(std::span<const std::uint32_t> numbers, const Plane& plane,
                                                          double within, Reaching& known);
  /// The distance from a plane within which vertices of these cells count as on it.
  [[nodiscard]] double snap_distance(std::span<const std::uint32_t> numbers, const SectionOptions& options);

 private:
  void split_edges(std::span<const std::uint32_t> numbers, Sides& sides);
  void split_faces(std::uint32_t number, Sides& sides);
  bool split_face_of(Cell c, std::uint16_t face, Sides& sides);
  [[nodiscard]] std::optional<std::array<Dart, 2>> chord_of(Cell c, std::uint16_t face, Sides& sides) const;
  [[nodiscard]] std::vector<bool> faces_above(Cell c, Sides& sides);
  [[nodiscard]] std::vector<Dart> path_around(Cell c, Sides& sides);
  void replace(Cell old, Cell now);

  ComplexEdit& edit_;
  std::vector<Cell> cells_;
  std::unordered_map<std::uint32_t, std::uint32_t> number_;
};

}  // namespace dartcast::detail
