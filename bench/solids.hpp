// The cost of edges that move among walls: in cells, and in a hierarchy of boxes.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "dynamics/near_walls.hpp"

namespace dartcast::bench {

/// One scene of unit cubes, a tenth of them blocked, and edges as long as a cell that move by a tenth of one. Times are
/// microseconds for an edge and step on one thread, medians over the steps.
struct SolidRow {
  std::size_t cells = 0;
  bool moving = false;  ///< the walls, too
  std::size_t edges = 0;
  double search_us = 0.0;  ///< all touches on the way, through cells
  double step_us = 0.0;    ///< a whole step of SolidSet; 0: not taken
  double walls = 0.0;      ///< reached by an edge
  double pairs = 0.0;      ///< looked at, by an edge
  double tree_us = 0.0;    ///< the same touches by Bullet's dynamic tree of boxes, refitted; 0: it is not there
  double refit_us = 0.0;   ///< the part for the refit
  std::size_t unlike = 0;  ///< edges with another first touch
};

/// Nanoseconds for a pair.
struct PairTimes {
  double filter_ns = 0.0;  ///< pairs that the filter decides
  double exact_ns = 0.0;   ///< pairs decided in integers
  double undecided = 0.0;  ///< share of pairs that the filter leaves
};

PairTimes time_pairs();
/// `across`: cubes along each axis.
SolidRow time_edges(std::size_t across, bool moving);

/// Boxes of walls as they sweep in a step.
class SweptTree {
 public:
  virtual ~SweptTree() = default;
  /// Boxes around the walls before and after; the first call builds the tree.
  virtual void fit(std::span<const MovingTriangle> walls) = 0;
  /// The numbers of walls whose boxes meet this one; valid until the next call.
  virtual std::span<const std::size_t> query(const Vec3& low, const Vec3& high) = 0;
};
/// Bullet's dynamic tree; none where the benchmark is built without Bullet.
std::unique_ptr<SweptTree> make_swept_tree();

std::string solids_text(const PairTimes& pairs, std::span<const SolidRow> rows);
std::string solids_json(const PairTimes& pairs, std::span<const SolidRow> rows);

}  // namespace dartcast::bench
