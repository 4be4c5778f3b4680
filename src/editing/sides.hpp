// The sides of planes on which vertices lie. Private to editing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/cutting.hpp"
#include "topology/key_table.hpp"

namespace dartcast::detail {

/// Throws InvalidArgument if it is out of range.
void check_snap(double snap);

/// The mean of a cell's corners.
Vec3 middle(ComplexEdit& edit, Cell c);

/// The side of a plane as a mask: 0 for a vertex on the plane, both bits for a cell that the plane crosses.
using Side = std::uint8_t;
constexpr Side below_bit = 1;
constexpr Side above_bit = 2;
constexpr Side both_bits = below_bit | above_bit;

/// The sides of vertices, for each of some planes. They are decided once, because an edit does not move a vertex.
class Sides {
 public:
  /// `within`: vertices at most this far from a plane count as on it (m).
  Sides(ComplexEdit& edit, std::span<const Plane> planes, double within)
      : edit_(edit), planes_(planes.begin(), planes.end()), within_(within) {}

  [[nodiscard]] std::size_t plane_count() const { return planes_.size(); }
  [[nodiscard]] const Plane& plane(std::size_t number) const { return planes_[number]; }
  /// The sides of a vertex, one for each plane. They stay where they are until the sides of another vertex are asked for.
  [[nodiscard]] const Side* of(Vertex v) {
    const std::uint32_t known = number_.find(v.value);
    return &sides_[(known == KeyTable::none ? decide(v) : known) * planes_.size()];
  }
  /// The point where a plane crosses an edge from below to above. Precondition: it does.
  [[nodiscard]] Vec3 crossing(Vertex low, Vertex high, std::size_t plane);
  /// Decides that a new vertex lies on a plane, whatever its rounding.
  void put_on(Vertex v, std::size_t plane) { sides_[decide(v) * planes_.size() + plane] = 0; }

 private:
  std::uint32_t decide(Vertex v);

  ComplexEdit& edit_;
  std::vector<Plane> planes_;
  double within_;
  KeyTable number_;          // by vertex, in the order in which they were decided
  std::vector<Side> sides_;  // by number, then by plane
  std::uint32_t count_ = 0;
};

}  // namespace dartcast::detail
