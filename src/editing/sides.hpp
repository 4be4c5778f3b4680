// On which side of a plane vertices and cells lie. Private to surgery.
#pragma once

#include <cstdint>
#include <unordered_map>

#include "dartcast/cutting.hpp"

namespace dartcast::detail {

/// Throws InvalidArgument where it is out of range.
void check_snap(double snap);

/// The mean of a cell's corners.
Vec3 middle(ComplexEdit& edit, Cell c);

/// Judges vertices, each once.
class Sides {
 public:
  /// `within`: vertices at most so far from the plane count as on it (m).
  Sides(ComplexEdit& edit, const Plane& plane, double within) : edit_(edit), plane_(plane), within_(within) {}

  /// Says that a new vertex lies on the plane.
  void put_on(Vertex v) { height_[v.value] = 0.0; }

  /// -1 below, 1 above, 0 on the plane.
  [[nodiscard]] int operator[](Vertex v);
  /// Where the plane crosses an edge from below to above. Precondition: it does.
  [[nodiscard]] Vec3 crossing(Vertex below, Vertex above);

  struct Reach {
    bool below = false, above = false;
    [[nodiscard]] bool crossed() const { return below && above; }
  };
  /// On which sides the cell has corners.
  [[nodiscard]] Reach reach(Cell c);
  /// Of a cell that is to be on one side: whether that is above.
  [[nodiscard]] bool is_above(Cell c);
  /// Whether the outside of a cell's face is towards below.
  [[nodiscard]] bool looks_down(CellFace f);

 private:
  double height(Vertex v);

  ComplexEdit& edit_;
  Plane plane_;
  double within_;
  std::unordered_map<std::uint32_t, double> height_;
};

}  // namespace dartcast::detail
