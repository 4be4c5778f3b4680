// On which side of a plane vertices and cells lie. Private to surgery.
#pragma once

#include <cstdint>
#include <unordered_map>

#include "dartcast/surgery/section.hpp"

namespace dartcast::detail {

/// Throws InvalidArgument where it is out of range.
void check_snap(double snap);

/// The mean of a cell's corners.
Vec3 middle(ComplexEdit& edit, Cell c);

/// Judges the vertices of some cells, each once.
class Sides {
 public:
  Sides(ComplexEdit& edit, const Plane& plane, const SectionOptions& options)
      : edit_(edit), plane_(plane), options_(options) {}

  /// All cells whose edges are to count are to be taken before sides are asked for.
  void take(Cell c);
  /// Says that a new vertex lies on the plane.
  void put_on(Vertex v) { known_[v.value] = {.x = {}, .height = 0.0, .shortest = 0.0}; }

  /// -1 below, 1 above, 0 on the plane. Precondition: a vertex of a cell taken, or put on the plane.
  [[nodiscard]] int operator[](Vertex v) const;
  /// Where the plane crosses an edge from below to above. Precondition: it does.
  [[nodiscard]] Vec3 crossing(Vertex below, Vertex above) const;

  struct Reach {
    bool below = false, above = false;
    [[nodiscard]] bool crossed() const { return below && above; }
  };
  /// On which sides the cell has corners.
  [[nodiscard]] Reach reach(Cell c) const;
  /// Of a cell that is to be on one side: whether that is above.
  [[nodiscard]] bool is_above(Cell c) const;

 private:
  struct Known {
    Vec3 x;
    double height = 0.0;
    double shortest = std::numeric_limits<double>::infinity();  // of its edges
  };

  Known& know(Vertex v);

  ComplexEdit& edit_;
  Plane plane_;
  SectionOptions options_;
  std::unordered_map<std::uint32_t, Known> known_;
};

}  // namespace dartcast::detail
