// Obstacles at random, for the generators.
#pragma once

#include <cstdint>
#include <span>

namespace dartcast {

/// Sets `share` of the entries that are 0 (rounded to a whole number of them) to 1, every choice equally likely.
/// Precondition: share in [0, 1], fewer than 2^32 entries. The same seed gives the same choice everywhere.
void block_share(std::span<std::uint8_t> blocked, double share, std::uint64_t seed);

}  // namespace dartcast
