// The cost of rays: cast through cells, and in a hierarchy of boxes.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace dartcast::bench {

/// Rays in all directions from random free places of a box at rest, without a greatest distance, on one thread.
/// Nanoseconds for a ray, medians over the rounds.
struct RayBenchRow {
  std::size_t cells = 0;
  double blocked_share = 0.0;
  std::size_t rays = 0;
  double locate_ns = 0.0;      ///< the part of cast_ns in which origins are located
  double cast_ns = 0.0;        ///< Environment::cast_rays()
  double embree_single = 0.0;  ///< 0 where Embree is not there, as below
  double embree_packet = 0.0;
  std::size_t unlike = 0;  ///< rays for which Embree's packets name another wall
};

RayBenchRow time_rays(std::size_t across, double blocked_share);

std::string rays_text(std::span<const RayBenchRow> rows);
std::string rays_json(std::span<const RayBenchRow> rows);

}  // namespace dartcast::bench
