// Whether a map keeps the constraints of a combinatorial map and of its records; each broken one is named.
#pragma once

#include <string>
#include <vector>

#include "dartcast/combinatorial_map.hpp"

namespace dartcast {

struct Violation {
  std::string constraint;  ///< such as "phi3 is an involution"
  Dart dart;               ///< where it was found
  std::string message;     ///< cell by its number in the mesh, and the values seen
};

/// Checks every dart of the cells given: phi1 is a permutation with inverse phi_1; phi2 is an involution without fixed
/// points that turns the edge around; phi3 and phi1 o phi3 are involutions (where defined); sewn darts have the same
/// vertices; both sides of a face are fanned from the same point, or from none of its own; a face starts at its
/// lowest-numbered vertex; vertices are in range, and distinct in a cell; a face is marked as a wall where exactly one
/// side is free, or there is no other side, and its vertices as those of a wall. Returns at most `max_count`
/// violations. Cost: linear in the darts.
std::vector<Violation> check_integrity(const CombinatorialMap& map, std::span<const Cell> cells,
                                       std::size_t max_count = 100);
std::vector<Violation> check_integrity(const CombinatorialMap& map, std::size_t max_count = 100);

}  // namespace dartcast
