// When a moving vertex and triangle, or two moving edges, first come as near as a given distance.
#pragma once

#include <optional>

#include "predicates/moving_pair.hpp"

namespace dartcast {

/// The first time in [0, 1] at which the distance is at most `separation`, or nothing. Where there is nothing, it is
/// proved that the elements stay farther apart, but for pairs that begin as near as that and only part. The time is
/// never late. It may be early, by the bound of SphereTouch and by 2^-52 of the largest distance between points of the two
/// elements.
///
/// Preconditions: separation > 0; all coordinates are finite and below 2^299 in magnitude. Cost: 1 us, 100 us at worst.
std::optional<double> first_within(const detail::MovingPair& pair, detail::PairKind kind, double separation);

}  // namespace dartcast
