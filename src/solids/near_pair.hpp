// A moving vertex and a moving triangle, or two moving edges: their distance, and when they come nearer than a margin.
#pragma once

#include <optional>

#include "predicates/moving_pair.hpp"

namespace dartcast {

/// At the time 0. Rounded as nearest_on_triangle() is.
double distance_at_start(const detail::MovingPair& pair, detail::PairKind kind);

/// The first time in [0, 1] at which the two are as near as the margin, or touch. Never late, and at most 2^-20 early. A pair
/// that is nearer at the time 0 has it if it then comes nearer still. Precondition: margin > 0. Cost: that of first_touch()
/// for a pair, and once or twice that for a sphere and a triangle.
std::optional<double> first_within(const detail::MovingPair& pair, detail::PairKind kind, double margin);

}  // namespace dartcast
