// Positions of the vertices that a transaction makes, while it is open.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>

#include "dartcast/error.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/predicates.hpp"

namespace dartcast::detail {

/// `Positions`: a vector of Vec3, one per vertex, which grows with the map.
template <class Positions>
class CreatedPositions {
 public:
  CreatedPositions(const Transaction& transaction, Positions& positions)
      : transaction_(transaction), positions_(positions), before_(positions.size()) {}

  /// Gives new vertices their first positions. Numbers that are used again lie among the others.
  void take() {
    count_ = std::min(count_, transaction_.created_count());
    positions_.resize(transaction_.map().vertex_count());
    for (; count_ < transaction_.created_count(); ++count_) {
      const CreatedVertex& v = transaction_.created(count_);
      const Vec3 a = positions_[v.from.value];
      positions_[v.vertex.value] = v.from == v.other ? a : (a + positions_[v.other.value]) * 0.5;
    }
  }

  /// Throws InvalidArgument if there is no such vertex.
  [[nodiscard]] Vec3 at(Vertex v) {
    if (count_ != transaction_.created_count() || positions_.size() != transaction_.map().vertex_count()) take();
    if (!transaction_.map().is_vertex(v))
      throw InvalidArgument("there is no vertex " + std::to_string(v.value) + ": an edit gave it up");
    return positions_[v.value];
  }

  /// Returns the number of the vertex among the new ones. Throws InvalidArgument if it is none of these, or x is not
  /// finite or outside the exact range.
  std::size_t place(Vertex v, const Vec3& x) {
    take();
    std::size_t i = count_;
    while (i > 0 && transaction_.created(i - 1).vertex != v) --i;
    if (i == 0)
      throw InvalidArgument("place: vertex " + std::to_string(v.value) +
                            " was not made by this edit; move the others by a move");
    if (!in_exact_range(x))
      throw InvalidArgument("place: vertex " + std::to_string(v.value) + " would be at (" + std::to_string(x.x) + ", " +
                            std::to_string(x.y) + ", " + std::to_string(x.z) +
                            "): coordinates must be finite, and at most 2^300 in magnitude");
    positions_[v.value] = x;
    return i - 1;
  }

  /// The number of new vertices with positions.
  [[nodiscard]] std::size_t count() const { return count_; }
  /// Makes the new positions permanent, after a commit.
  void keep() {
    before_ = positions_.size();
    count_ = 0;
  }
  /// Removes the new positions, if there is no commit.
  void give_up() { positions_.resize(before_); }

 private:
  const Transaction& transaction_;
  Positions& positions_;
  std::size_t before_;
  std::size_t count_ = 0;
};

}  // namespace dartcast::detail
