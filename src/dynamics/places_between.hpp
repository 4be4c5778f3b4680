// Positions of vertices between two times of the last move, for the cells that a search comes to.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/cell_complex.hpp"

namespace dartcast {

/// Memory for one thread at a time: two positions for each vertex of the complex.
class PlacesBetween {
 public:
  /// Forgets all. 0 <= begin <= end <= 1: shares of the last move of the complex.
  void start(const CellComplex& complex, double begin, double end);

  /// Computes the positions of these vertices, unless they are known. They are the same doubles as for each other caller
  /// (Between in tracking/space.hpp). In the plane z is 0.
  void reach(std::span<const std::uint32_t> vertices);

  /// Valid for vertices that were reached.
  [[nodiscard]] std::span<const Vec3> before() const { return before_; }
  [[nodiscard]] std::span<const Vec3> after() const { return after_; }

 private:
  const CellComplex* complex_ = nullptr;
  double begin_ = 0.0;
  double end_ = 1.0;
  std::uint32_t round_ = 0;
  std::vector<std::uint32_t> known_;  // the round in which a vertex was reached last
  std::vector<Vec3> before_;
  std::vector<Vec3> after_;
};

}  // namespace dartcast
