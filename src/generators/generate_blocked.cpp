// Blocks a share of the cells at random.
#include "generators/generate_blocked.hpp"

#include <algorithm>
#include <cmath>

#include "base/random.hpp"

namespace dartcast {

void block_share(std::span<std::uint8_t> blocked, double share, std::uint64_t seed) {
  auto left = static_cast<std::uint32_t>(std::count(blocked.begin(), blocked.end(), std::uint8_t{0}));
  auto wanted = static_cast<std::uint32_t>(std::floor(share * left + 0.5));
  Random random(seed, 2);
  for (auto& mark : blocked) {
    if (mark != 0) continue;
    // Selection sampling: of the entries left, each is as likely as any other to be among those still wanted.
    if (random.below(left--) < wanted) {
      mark = 1;
      --wanted;
    }
  }
}

}  // namespace dartcast
