// Cuts parts out of a mesh, or out of a part of one. Not installed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "dartcast/mesh_part.hpp"
#include "mesh/faces.hpp"

namespace dartcast {

/// Lists of numbers, one for each item.
class NumberLists {
 public:
  NumberLists() = default;
  /// Adds(add): calls add(item, number) for all entries, in the same order each time it is called.
  template <class Adds>
  NumberLists(std::size_t items, Adds&& adds) : ends_(items + 1) {
    adds([&](std::size_t item, std::uint32_t) { ++ends_[item + 1]; });
    for (std::size_t i = 1; i < ends_.size(); ++i) ends_[i] += ends_[i - 1];
    numbers_.resize(ends_.back());
    std::vector<std::size_t> next(ends_.begin(), ends_.end() - 1);
    adds([&](std::size_t item, std::uint32_t number) { numbers_[next[item]++] = number; });
  }
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::size_t item) const {
    return std::span(numbers_).subspan(ends_[item], ends_[item + 1] - ends_[item]);
  }

 private:
  std::vector<std::size_t> ends_ = {0};
  std::vector<std::uint32_t> numbers_;
};

/// Calls visit(point) for each entry of a cell's connectivity that is a point, and other(number) for the counts of a
/// polyhedron, in their order.
template <class Visit, class Other>
void for_each_entry(const MeshData& mesh, std::size_t c, Visit&& visit, Other&& other) {
  const auto corners = mesh.cell(c);
  if (mesh.types[c] != CellType::polyhedron) {
    for (const std::uint32_t p : corners) visit(p);
    return;
  }
  other(corners[0]);
  std::size_t at = 1;
  for (std::uint32_t f = 0; f < corners[0]; ++f) {
    const std::uint32_t count = corners[at++];
    other(count);
    for (std::uint32_t k = 0; k < count; ++k) visit(corners[at++]);
  }
}
template <class Visit>
void for_each_point(const MeshData& mesh, std::size_t c, Visit&& visit) {
  for_each_entry(mesh, c, visit, [](std::uint32_t) {});
}

/// The corners of a face by number, to compare faces.
std::vector<std::uint32_t> sorted_corners(std::span<const std::uint32_t> face);

/// The values of some items.
std::vector<DataArray> taken(const std::vector<DataArray>& arrays, std::span<const std::uint32_t> which);

/// The handle of each cell in the map of a whole mesh.
std::vector<Cell> handles_of(const MeshData& whole);

/// The tag of the unknown patch: a mesh that has one keeps it, and another gets one that is new to it.
std::int32_t unknown_tag_of(const MeshData& mesh);

class PartCutter {
 public:
  /// `owners`: the part of each cell. Both outlive it.
  PartCutter(const MeshData& whole, std::span<const std::uint32_t> owners, std::uint32_t parts);
  /// `owners`: of the part's cells, from now on. It cuts cells whose neighbours are all in the part.
  PartCutter(const MeshPart& from, std::span<const std::uint32_t> owners);

  /// The part's cells and its ghosts, as far as they are here, in their order.
  [[nodiscard]] std::vector<std::uint32_t> cells_of(std::uint32_t part) const;
  /// These cells of the mesh, in their order, as a part. Faces that lose the cell behind them are unknown. Cost: linear
  /// in them.
  [[nodiscard]] MeshPart cut(std::span<const std::uint32_t> cells, std::uint32_t part);

 private:
  PartCutter(const MeshData& mesh, const MeshPart* from, std::span<const std::uint32_t> owners, std::uint32_t parts);
  void copy_points(std::span<const std::uint32_t> cells, MeshPart& out);
  void copy_cells(std::span<const std::uint32_t> cells, MeshPart& out) const;
  void copy_patches(MeshPart& out) const;
  void name_unknown_faces(MeshPart& out) const;
  [[nodiscard]] bool is_outer(std::uint32_t cell, std::span<const std::uint32_t> sorted_face) const;

  const MeshData& mesh_;
  const MeshPart* from_;  // none: the mesh is the whole
  std::span<const std::uint32_t> owners_;
  std::uint32_t parts_;
  std::vector<Cell> handles_;
  NumberLists cells_of_part_;
  NumberLists cells_at_point_;
  NumberLists patch_faces_;  // by the first corner
  BoundaryFaces boundary_;
  NumberLists boundary_of_cell_;
  std::vector<std::int32_t> patch_order_;
  std::int32_t unknown_tag_;
  std::vector<std::uint32_t> number_;  // of a point of the mesh in the part being cut
};

}  // namespace dartcast
