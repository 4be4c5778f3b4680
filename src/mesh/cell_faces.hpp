// Cells that are given by their faces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// The faces of a cell, counterclockwise as seen from outside it.
class CellFaces {
 public:
  void clear() {
    corners_.clear();
    begin_.assign(1, 0);
  }
  template <class Corners>
  void add(const Corners& first, const Corners& last) {
    corners_.insert(corners_.end(), first, last);
    begin_.push_back(corners_.size());
  }

  [[nodiscard]] std::size_t size() const { return begin_.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::size_t i) const {
    return {corners_.data() + begin_[i], begin_[i + 1] - begin_[i]};
  }

 private:
  std::vector<std::uint32_t> corners_;
  std::vector<std::size_t> begin_ = {0};
};

/// Adds a tetrahedron, hexahedron, prism or pyramid if the faces are those of one, else a polyhedron.
void add_cell(const CellFaces& faces, MeshData& mesh);

}  // namespace dartcast
