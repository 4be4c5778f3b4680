// Touches of absorbing walls between the ends of a random way. Not installed.
#pragma once

#include <cstdint>

#include "dartcast/cell_complex.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/response.hpp"
#include "dynamics/near_walls.hpp"

namespace dartcast {

/// A random way of a particle in a segment, with or without a drift.
struct RandomWay {
  const ParticleState& from;
  double radius;         ///< of the particle
  Vec3 target;           ///< among the walls as they stand now
  double variance;       ///< along each axis, > 0
  std::uint32_t chance;  ///< random bits
  bool moving;           ///< `from` is from before the last move, in which the cells carry it
};

/// The way's end if it has touched no wall that ends particles (absorb, stick, escape), and otherwise that end mirrored
/// in the wall: the straight way there meets it. The wall is the plane at the nearest place of all such walls. With the
/// distances d0 and d1 of both ends from it, a way has touched it with the probability exp(-2 d0 d1 / variance). Below
/// 2^-25 it counts as 0. Cost: a search of the walls within the way's length and 3 standard deviations.
Vec3 bridged(const CellComplex& complex, const WallResponses& responses, NearWalls& scratch, const RandomWay& way);

}  // namespace dartcast
