// A camera's path along a catheter, or any chain of points in the lumen: an endoscopy.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/environment.hpp"

namespace dartcast {

struct CameraOptions {
  double spacing = 1e-3;           ///< of the cameras along the spline, > 0
  Vec3 up = {0.0, 1.0, 0.0};       ///< at the first camera, made perpendicular to its direction
  std::size_t max_count = 100000;  ///< cameras at most
};

struct Camera {
  Vec3 position;     ///< in the lumen, exactly
  Vec3 direction;    ///< unit: along the spline
  Vec3 up;           ///< unit, perpendicular to it; carried along without twist
  double arc = 0.0;  ///< from the first camera, along the line through all, m
};

struct CameraPath {
  std::vector<Camera> cameras;
  std::size_t at_walls = 0;  ///< cameras that a wall kept from the spline
};

/// Cameras along the centripetal spline through `points` (E. Catmull, R. Rom, "A class of local interpolating splines",
/// 1974; C. Yuksel, S. Schaefer, J. Keyser, "Parameterization and applications of Catmull-Rom curves", 2011), evenly
/// spaced along it (but where a wall keeps one off), the last at its end. A camera is a particle that walks from the
/// point before it to the spline, so that no wall is between. Points that repeat count once. Throws InvalidArgument
/// where there are not two points, one (named) is in no free cell, or there would be more than `max_count` cameras; the
/// environment must be of space. Cost: 4 us per camera, and once after a move a grid over the cells
/// (Environment::locate()).
CameraPath camera_path(Environment& environment, std::span<const Vec3> points, const CameraOptions& options = {});

}  // namespace dartcast
