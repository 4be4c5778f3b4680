// The cells of a trajectory. Not installed.
#pragma once

#include <span>
#include <vector>

#include "dartcast/trajectory.hpp"

namespace dartcast {

/// Each once, ascending.
std::vector<Cell> cells_passed(std::span<const TrajectoryPoint> points);

}  // namespace dartcast
