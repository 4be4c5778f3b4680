// Many particles on a surface at once.
#pragma once

#include <span>
#include <vector>

#include "base/parallel.hpp"
#include "surface/surface_step.hpp"

namespace dartcast {

struct SurfaceReport {
  std::vector<SurfaceStep> steps;        ///< one per particle
  std::vector<SurfaceContact> contacts;  ///< by particle, then by time
};

/// Steps every place by its displacement, as step() does. Results are the same bits for any number of threads. Throws
/// as step(), naming the particle, and what a response throws: no place is changed then.
SurfaceReport advance(const Surface& surface, std::span<SurfacePlace> places, std::span<const Vec3> displacements,
                      const SurfaceContactCallback& respond = {}, const SurfaceOptions& options = {},
                      Threads threads = {});

}  // namespace dartcast
