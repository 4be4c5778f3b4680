// The side of a plane on which vertices and cells lie. Private to editing.
#pragma once

#include <cstdint>
#include <unordered_set>

#include "dartcast/cutting.hpp"

namespace dartcast::detail {

/// Throws InvalidArgument if it is out of range.
void check_snap(double snap);

/// The mean of a cell's corners.
Vec3 middle(ComplexEdit& edit, Cell c);

/// The side of a vertex is always the same, because an edit does not move it.
class Sides {
 public:
  /// `within`: vertices at most this far from the plane count as on it (m).
  Sides(ComplexEdit& edit, const Plane& plane, double within) : edit_(edit), plane_(plane), within_(within) {}

  /// Records that a new vertex lies on the plane.
  void put_on(Vertex v) { on_.insert(v.value); }

  /// -1 below, 1 above, 0 on the plane.
  [[nodiscard]] int operator[](Vertex v);
  /// The point where the plane crosses an edge from below to above. Precondition: it does.
  [[nodiscard]] Vec3 crossing(Vertex below, Vertex above);

  struct Reach {
    bool below = false, above = false;
    [[nodiscard]] bool crossed() const { return below && above; }
  };
  /// The sides on which the cell has corners.
  [[nodiscard]] Reach reach(Cell c);
  /// Whether a cell that must be on one side counts as above.
  [[nodiscard]] bool is_above(Cell c);
  /// Whether the cell has a part below: a corner, or all of it.
  [[nodiscard]] bool reaches_below(Cell c);
  /// Whether the outside of a cell's face faces downwards.
  [[nodiscard]] bool looks_down(CellFace f);

 private:
  double height(Vertex v) const;

  ComplexEdit& edit_;
  Plane plane_;
  double within_;
  std::unordered_set<std::uint32_t> on_;
};

}  // namespace dartcast::detail
