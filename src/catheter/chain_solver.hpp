// One implicit step of a chain of points: bending, lengths, walls and friction in one banded system.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/catheter.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

/// Weights are relative to the resistance to a point's motion.
struct ChainWeights {
  double spacing = 1.0;
  double bending = 0.0;   ///< of squared second differences
  double friction = 0.0;  ///< Coulomb's coefficient
  double reach = 0.0;     ///< largest displacement of a point in one solve
};

/// The place on the chain that a wall is for.
inline Vec3 place_on(const ChainWall& wall, std::span<const Vec3> points) {
  if (wall.weight == 0.0) return points[wall.index];
  return points[wall.index] * (1.0 - wall.weight) + points[wall.index + 1] * wall.weight;
}

/// Minimizes an energy. With x the points and r = x[i - 1] - 2 x[i] + x[i + 1] - bends[i] it is
///
///   1/2 sum |x - wanted|^2 + 1/2 bending sum |r|^2,
///
/// plus stiff springs for lengths and walls, plus friction against the motion from `start`. One Newton step leaves out
/// second derivatives of lengths. Up to four solves find the walls that press.
class ChainSolver {
 public:
  /// The chain: `free` points that can move, then those that cannot: at least 2 of these, if any is free.
  struct Chain {
    std::span<Vec3> points;  ///< in: where they are. Out: the targets of the free ones.
    std::size_t free = 0;
    std::span<const Vec3> wanted;  ///< per free point
    std::span<const Vec3> start;   ///< per free point, and per point that a wall is for
    std::span<const Vec3> bends;   ///< second difference at rest, per point
  };

  /// Moves the free points, and sets the walls' pressures. Walls are of free points, or of segments that begin at one. Cost: linear.
  void solve(const Chain& chain, const ChainWeights& weights, std::span<ChainWall> walls);

 private:
  static constexpr std::size_t band = 9;  // width of the system's band: a point depends on two before it and two after

  void add_block(std::size_t i, std::size_t j, const std::array<Vec3, 3>& rows);
  void add_right(std::size_t i, const Vec3& force);
  void add_spring(std::size_t first, std::span<const double> factors, std::size_t free, double stiffness,
                  const Vec3& offset, const Vec3& direction);
  void add_springs(const Chain& chain, const ChainWeights& weights);
  void add_friction(const ChainWall& wall, const Chain& chain, const ChainWeights& weights);
  void add_wall(const ChainWall& wall, const Chain& chain, const ChainWeights& weights);
  [[nodiscard]] Vec3 displacement(std::size_t i) const;
  [[nodiscard]] Vec3 displacement_at(const ChainWall& wall, std::size_t free) const;
  bool change_walls(const Chain& chain, const ChainWeights& weights, std::span<ChainWall> walls);
  void factor_and_solve();

  std::vector<std::array<double, band>> matrix_;  // row r: entries (r, r - band + 1) to (r, r)
  std::vector<double> right_;
  std::vector<std::array<double, band>> springs_;  // the part of the system without walls
  std::vector<double> springs_right_;
  std::vector<std::uint8_t> pressing_;
};

}  // namespace dartcast
